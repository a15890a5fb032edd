"""One command makes all studies and puts their tables on the pages of the documentation."""

from __future__ import annotations

import importlib
import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = "# Page\n\nBefore.\n\n<!-- measured: {name} -->\n{table}\n<!-- end of measured -->\n\nAfter.\n"
PLACE = re.compile(r"<!-- measured: (?P<name>[\w.]+) -->\n(?P<table>.*?)<!-- end of measured -->", re.DOTALL)


@pytest.fixture
def scripts() -> Iterator[SimpleNamespace]:
    """The suite and its pages."""
    before = set(sys.modules)
    sys.path.insert(0, str(ROOT / "benchmarks"))
    yield SimpleNamespace(suite=importlib.import_module("suite"), pages=importlib.import_module("_pages"))
    sys.path.remove(str(ROOT / "benchmarks"))
    for name in set(sys.modules) - before:
        if name in ("suite", "_pages", "_precision", "_result", "coupling_regime", "flag_oscillations"):
            sys.modules.pop(name)


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """A folder with a result."""
    found = {
        "rows": [{"need": "a | b", "ratio": 1.23456, "none": None}, {"need": "c", "ratio": 2.0, "none": 3}],
        "machine": {"processor": "fast", "processors": 2},
        "versions": {"python": "3.11.7"},
        "date": "2026-11-26T12:00:00+00:00",
    }
    (tmp_path / "skipping.json").write_text(json.dumps(found), encoding="utf-8")
    return tmp_path


def test_a_table_takes_the_place_of_the_old_one(scripts, results):
    page, missing = scripts.pages.filled(PAGE.format(name="skipping", table="| old |"), results)
    assert missing == []
    table = "| need | ratio | none |\n| --- | --- | --- |\n| a \\| b | 1.23 |  |\n| c | 2 | 3 |\n"
    where = "\n*2026-11-26, fast, 2 processors, Python 3.11.7*"
    assert page == PAGE.format(name="skipping", table=table + where)
    assert scripts.pages.filled(page, results)[0] == page


def test_a_study_that_is_missing_keeps_its_table(scripts, results):
    text = PAGE.format(name="bench", table="| old |")
    assert scripts.pages.filled(text, results) == (text, ["bench"])


def test_every_place_on_the_pages_has_a_study_and_a_table(scripts):
    named = [
        match["name"]
        for page in scripts.suite.PAGES
        for match in PLACE.finditer((ROOT / "docs" / page).read_text(encoding="utf-8"))
    ]
    studies = [study.name for study in scripts.suite.STUDIES]
    assert sorted(named) == sorted(studies) == sorted(scripts.pages.TABLES)
    for study in scripts.suite.STUDIES:
        assert not study.script or (ROOT / "benchmarks" / study.script).is_file()


def test_studies_run_side_by_side_and_one_may_fail(scripts, tmp_path, monkeypatch, capsys):
    class Fake(scripts.suite.Study):
        def command(self, folder: Path, images: Path, *, quick: bool) -> list[str]:
            return [sys.executable, "-c", f"import sys; print('{self.name}', {quick}); sys.exit({self.script})"]

    studies = [Fake("good", "0"), Fake("bad", "3"), Fake("other", "0")]
    failed = scripts.suite.carry_out(studies, tmp_path, tmp_path, quick=True, jobs=2)
    assert failed == ["bad"]
    printed = capsys.readouterr().out
    assert printed.count("done") == 2
    assert "bad: 0.0 min, exit code 3, see " in printed
    assert (tmp_path / "bad.log").read_text(encoding="utf-8") == "bad True\n"


def test_what_needs_a_peer_that_is_not_here_is_left_out(scripts, tmp_path, capsys):
    study = scripts.suite.Study("peer", "peers/gmsh_transfinite.py", needs="a_peer_that_nobody_has")
    assert scripts.suite.carry_out([study], tmp_path, tmp_path, quick=True, jobs=1) == []
    assert capsys.readouterr().out == "peer: not made, for a_peer_that_nobody_has is not installed\n"


def test_commands_name_their_files(scripts, tmp_path):
    by_name = {study.name: study for study in scripts.suite.STUDIES}
    command = by_name["coupling_regime"].command(tmp_path, tmp_path / "images", quick=True)
    assert command[1:] == [
        str(ROOT / "benchmarks" / "coupling_regime.py"),
        "--quick",
        "--json",
        str(tmp_path / "coupling_regime.json"),
        "--picture",
        str(tmp_path / "images" / "coupling_regime.png"),
    ]
    assert by_name["bench"].command(tmp_path, tmp_path, quick=False)[1:5] == ["-m", "hofsi", "bench", "--json"]


def test_an_unknown_study_is_told(scripts, capsys):
    with pytest.raises(SystemExit):
        scripts.suite.main(["benchmark"])
    assert "there is no study 'benchmark'; expected one of flag_precision, bench" in capsys.readouterr().err
