"""Series of files."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import pytest

from hofsi.io.pvd import write_pvd


def _entries(path: Path) -> list[tuple[float, str]]:
    sets = ElementTree.parse(path).getroot().findall("./Collection/DataSet")
    return [(float(one.attrib["timestep"]), one.attrib["file"]) for one in sets]


def test_times_and_files(tmp_path: Path) -> None:
    entries = [(0.1, "fields/a.vtu"), (0.1 + 0.2, 'fields/<b> & "c".vtu')]
    write_pvd(tmp_path / "a.pvd", entries)
    assert _entries(tmp_path / "a.pvd") == entries
    root = ElementTree.parse(tmp_path / "a.pvd").getroot()
    assert (root.tag, root.attrib["type"]) == ("VTKFile", "Collection")


def test_an_interruption_leaves_the_series_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_pvd(tmp_path / "a.pvd", [(1.0, "a.vtu")])

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_pvd(tmp_path / "a.pvd", [(1.0, "a.vtu"), (2.0, "b.vtu")])
    assert _entries(tmp_path / "a.pvd") == [(1.0, "a.vtu")]
