"""Optional packages: found, missing, and broken."""

from __future__ import annotations

import math

import pytest

from hoblock.errors import MissingExtraError
from hoblock.extras import import_extra


def test_an_installed_module_is_returned():
    assert import_extra("math", "anything") is math
    assert import_extra("os.path", "anything").join("a", "b").startswith("a")


@pytest.mark.parametrize("module", ["no_such_module_here", "no_such_module_here.part", "os.no_such_part"])
def test_a_missing_module_names_the_command(module):
    with pytest.raises(MissingExtraError, match=r"pip install 'hoblock\[plot\]'") as caught:
        import_extra(module, "plot")
    assert (caught.value.module, caught.value.extra) == (module, "plot")


def test_another_package_may_offer_the_extra():
    with pytest.raises(MissingExtraError, match=r"'no_such_module_here' is not installed.*hofsi-coupler\[amg\]"):
        import_extra("no_such_module_here", "amg", "hofsi-coupler")


def test_a_broken_module_is_not_called_missing(tmp_path, monkeypatch):
    (tmp_path / "broken_module_here.py").write_text("import no_such_module_here\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ModuleNotFoundError, match="no_such_module_here"):
        import_extra("broken_module_here", "plot")
