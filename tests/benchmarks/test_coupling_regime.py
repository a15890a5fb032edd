"""The map of the coupling's regime: every run has a row, failures have a word, and what differs is listed."""

from __future__ import annotations

import importlib
import io
import json
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
TINY = ["--quick", "--steps", "2", "--scenes", "block", "--densities", "10"]


@dataclass(frozen=True)
class Measured:
    """The module, what it returned, wrote and printed, and the folder of its files."""

    module: ModuleType
    result: Any
    written: dict[str, Any]
    printed: str
    folder: Path


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Measured]:
    """The study on its smallest settings."""
    folder = tmp_path_factory.mktemp("coupling_regime")
    sys.path.insert(0, str(FOLDER))
    module = importlib.import_module("coupling_regime")
    file = folder / "coupling_regime.json"
    with redirect_stdout(io.StringIO()) as printed:
        result = module.main([*TINY, "--json", str(file)])
    written = json.loads(file.read_text(encoding="utf-8"), parse_constant=lambda word: pytest.fail(word))
    yield Measured(module, result, written, printed.getvalue(), folder)
    sys.path.remove(str(FOLDER))
    for name in ("coupling_regime", "_result"):
        sys.modules.pop(name, None)


def test_every_run_has_a_row(measured):
    rows = measured.result.rows
    assert measured.written["rows"] == [dict(row) for row in rows]
    assert [(row["mode"], row["geometry"]) for row in rows] == list(measured.module.VARIANTS)
    assert {(row["scene"], row["density"], row["stiffness"], row["dt"]) for row in rows} == {("block", 10.0, 1.0, 1.0)}
    assert all(column in measured.printed for column in rows[0])


def test_a_heavy_block_is_no_trouble_for_any_mode(measured):
    for row in measured.result.rows:
        assert (row["outcome"], row["steps"], row["message"]) == ("completed", 2, "")
        assert row["difference"] < 1e-6
        assert (row["geometry difference"] > 1e-3) == (row["geometry"] == "implicit")
        assert row["displacement"] == pytest.approx(0.056, abs=0.003)
    assert "All completed runs agree." in measured.printed


def test_the_condensed_coupling_takes_the_fewest_iterations(measured):
    for geometry in ("extrapolated", "implicit"):
        rows = [row for row in measured.result.rows if row["geometry"] == geometry]
        assert min(rows, key=lambda row: row["iterations"])["mode"] == "condensed"


def test_the_map_is_drawn_and_tabulated(measured):
    assert (measured.folder / "coupling_regime.png").stat().st_size > 10_000
    lines = [line for line in measured.module.tables(measured.result.rows).splitlines() if line.startswith("|")]
    assert len(lines) == 3
    assert all(line.count("|") == 12 for line in lines)
    assert all(line in measured.printed for line in lines)


def test_a_run_that_fails_has_a_word_and_its_message(measured):
    module = measured.module
    scene, point = module.SCENES["block"], module.Point(10.0, 1.0, 1.0)
    few = [*module.changes_of(scene, point, "aitken", "extrapolated", 2), "coupling.max_iterations=2"]
    row, fields = module.measure(scene, few)
    assert (row["outcome"], row["error"], row["steps"]) == ("limit", "CouplingError", 0)
    assert row["iterations"] is None
    assert fields is None
    assert "not converged after 2 iterations" in row["message"]
    assert module._cell(row) == "limit (0)"


def test_not_even_a_crash_ends_the_study(measured, monkeypatch):
    module = measured.module

    def crash(_: object) -> object:
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(module, "build", crash)
    rows = module.measure_point("block", module.Point(1.0, 1.0, 1.0), 2)
    assert {row["outcome"] for row in rows} == {"ZeroDivisionError"}
    assert {row["difference"] for row in rows} == {None}


def test_what_differs_is_listed(measured):
    module = measured.module
    a = (np.array([[1.0, 0.0]]), np.array([[2.0, 4.0]]))
    b = (np.array([[1.0, 0.1]]), np.array([[2.0, 5.0]]))
    assert module.difference(a, b) == pytest.approx(0.2)
    assert module.difference(a, None) is None
    row = dict(measured.result.rows[0])
    assert module.suspicious([row | {"difference": 9e-6}, row | {"difference": None}]) == []
    (line,) = module.suspicious([row | {"difference": 0.2}])
    assert line.endswith("aitken, extrapolated: differs by 2.0e-01")
