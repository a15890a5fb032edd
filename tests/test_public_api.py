"""What the packages promise: their ``__all__`` and tests/public_api.txt say the same.

After a deliberate change, rewrite the list, look at its diff, and say in CHANGELOG.md what users have to do::

    pytest tests/test_public_api.py --update-public-api
"""

from __future__ import annotations

import difflib
import importlib
from pathlib import Path

import pytest

MODULES = ("hoblock", "hoblock.movers", "hofsi")
LIST = Path(__file__).with_name("public_api.txt")
HEADER = "# Public names, `module: name`. Rewritten by: pytest tests/test_public_api.py --update-public-api\n"


def _public_names(module: str) -> list[str]:
    return list(importlib.import_module(module).__all__)


def _listed_now() -> list[str]:
    return [f"{module}: {name}" for module in MODULES for name in sorted(_public_names(module))]


def _committed(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


def test_public_names_are_those_committed(request: pytest.FixtureRequest) -> None:
    now = _listed_now()
    if request.config.getoption("--update-public-api"):
        LIST.write_text(HEADER + "".join(f"{line}\n" for line in now), encoding="utf-8")
        return
    committed = _committed(LIST.read_text(encoding="utf-8"))
    difference = list(difflib.unified_diff(committed, now, "tests/public_api.txt", "__all__", n=0, lineterm=""))
    if difference:
        pytest.fail(
            "\n".join(difference)
            + "\n\nThe public names changed (- committed, + now). If that is meant, run"
            + "\n    pytest tests/test_public_api.py --update-public-api"
            + "\nand tell users about it in CHANGELOG.md.",
            pytrace=False,
        )


@pytest.mark.parametrize("module", MODULES)
def test_all_is_sorted_without_repetition(module: str) -> None:
    names = _public_names(module)
    assert names == sorted(set(names))


@pytest.mark.parametrize("module", MODULES)
def test_every_public_name_exists_and_none_is_private(module: str) -> None:
    loaded = importlib.import_module(module)
    missing = [name for name in _public_names(module) if not hasattr(loaded, name)]
    private = [name for name in _public_names(module) if name.startswith("_") and not name.endswith("__")]
    assert (missing, private) == ([], [])
