"""The benchmarks run, on the smallest settings, and say what they measured on what."""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
TINY = {
    "curve_accuracy": ["--orders", "1", "3", "--elements", "8", "16", "--kinds", "arc", "nurbs, degree 3", "spline"],
    "fluid_work_precision": ["--orders", "2", "4", "--k", "1"],
    "mesh_generation": ["--nodes", "2000", "--orders", "2", "--blocks", "1", "4", "--repeats", "2"],
    "mesh_scaling": ["--nodes", "2000", "9000", "--order", "2", "--repeats", "2"],
    "movers": ["--steps", "6", "--order", "2", "--elements", "1", "--repeats", "2"],
}


@pytest.fixture
def measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Iterator[Callable]:
    monkeypatch.syspath_prepend(str(FOLDER))
    before = set(sys.modules)

    def run(name: str) -> tuple[Any, dict[str, Any], str]:
        file = tmp_path / f"{name}.json"
        result = importlib.import_module(name).main([*TINY[name], "--json", str(file)])
        return result, json.loads(file.read_text(encoding="utf-8")), capsys.readouterr().out

    yield run
    for name in {"_result", *TINY} - before:
        sys.modules.pop(name, None)


def test_every_script_has_a_test():
    assert {script.stem for script in FOLDER.glob("[!_]*.py")} == set(TINY)


@pytest.mark.parametrize("name", TINY)
def test_results_are_printed_and_written(name, measured):
    result, written, printed = measured(name)
    assert written["benchmark"] == name
    assert {"settings", "rows", "machine", "versions", "date"} <= written.keys()
    assert written["rows"] == [dict(row) for row in result.rows]
    assert written["versions"]["numpy"]
    for column in result.rows[0]:
        assert column in printed


def test_generation_is_counted_in_copies(measured):
    result, _, _ = measured("mesh_generation")
    assert [(row["blocks"], row["gradings"]) for row in result.rows] == [
        (1, "equal"), (1, "different"), (4, "equal"), (4, "different"),
    ]  # fmt: skip
    for row in result.rows:
        assert 1500 < row["nodes"] < 2500
        assert row["regenerate/copy"] > 1.0


def test_stiff_small_blocks_reach_further(measured):
    result, _, _ = measured("movers")
    rows = {row["mover"]: row for row in result.rows}
    title = "T3a translation (of 0.99)"
    assert len(rows) == 4
    assert rows["pseudo-solid, exponent -1"][title] > rows["pseudo-solid, exponent +1"][title] > 0.0
    assert rows["angles, robust"][title] > rows["angles, published"][title] > 0.0


def test_errors_of_the_cylinder_fall_with_the_order(measured):
    result, _, _ = measured("fluid_work_precision")
    second, fourth = result.rows
    for name in ("c_D", "c_L", "dp"):
        assert fourth[f"error of {name}"] < 0.1 * second[f"error of {name}"]
    assert fourth["error of c_D"] < 1e-3


def test_curves_are_met_at_the_order_of_the_elements(measured):
    result, _, _ = measured("curve_accuracy")
    rows = {(row["curve"], row["order"]): row for row in result.rows}
    assert len(rows) == 6
    for name in ("area", "perimeter"):
        assert rows["arc", 1][f"{name} order"] == pytest.approx(2.0, abs=0.05)
        assert rows["arc", 3][f"{name} order"] == pytest.approx(6.0, abs=0.2)
        assert rows["spline", 3][f"{name} order"] == "round-off"
        assert rows["nurbs, degree 3", 3][name] < 0.1 * rows["nurbs, degree 3", 1][name]
