"""The stress suite judges what happens by what was expected, whatever happens."""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
PACKAGES = ("_result", "exact_fsi", "full_mesh_movers", "manufactured_flows", "motion_cases", "stress", "stress_suite")


@pytest.fixture(scope="module")
def suite() -> Iterator[SimpleNamespace]:
    """The script, its package and some of its modules."""
    before = set(sys.modules)
    sys.path.insert(0, str(FOLDER))
    names = ("stress_suite", "stress", "stress.sampling", "stress.runs")
    yield SimpleNamespace(**{name.rpartition(".")[2]: importlib.import_module(name) for name in names})
    sys.path.remove(str(FOLDER))
    for name in set(sys.modules) - before:
        if name.partition(".")[0] in PACKAGES:
            sys.modules.pop(name)


@pytest.fixture
def row(suite):
    """A function that carries out a case with an outcome that is expected and one that happens."""

    def carried_out(expected, outcome):
        def measure(quick):
            if isinstance(outcome, Exception):
                raise outcome
            return outcome

        case = suite.stress.StressCase("case", "Nothing.", expected, measure)
        return suite.stress.carried_out("group", case, quick=True)

    return carried_out


def test_the_groups_have_cases_with_names_of_their_own(suite):
    for cases in suite.stress.GROUPS.values():
        names = [case.name for case in cases]
        assert len(set(names)) == len(names) > 0
        assert all(case.stresses.endswith(".") and case.expected for case in cases)
        assert any(case.quick for case in cases)


@pytest.mark.parametrize(
    ("found", "met"),
    [
        ({"error": 1e-9, "steps": 3.0}, True),
        ({"error": 1e-7, "steps": 3.0}, False),
        ({"error": 1e-9, "steps": 5.0}, False),
        ({"error": np.nan, "steps": 3.0}, False),
        ({"error": 1e-9}, False),
        ({"error": 1e-9, "steps": 2.0, "told": 7.0}, True),
    ],
)
def test_numbers_are_judged_by_their_bounds(suite, row, found, met):
    expected = (suite.stress.Within({"error": 1e-8, "steps": (2.0, 4.0)}),)
    assert row(expected, found)["verdict"] == ("as expected" if met else "NOT as expected")


@pytest.mark.parametrize(
    ("raised", "met"),
    [
        (FileNotFoundError("no place"), True),
        (OSError("no place at all"), True),
        (OSError("no time"), False),
        (ValueError("no place"), False),
        ({"error": 0.0}, False),
    ],
)
def test_errors_are_judged_by_class_and_message(suite, row, raised, met):
    assert row((suite.stress.Stops("OSError", "no pl.ce"),), raised)["verdict"] == (
        "as expected" if met else "NOT as expected"
    )


def test_what_nobody_expected_is_a_row(suite, row):
    found = row((suite.stress.Within({"error": 1.0}),), ZeroDivisionError("by nothing"))
    assert found["verdict"] == suite.stress.NOT_AS_EXPECTED
    assert found["found"] == "ZeroDivisionError: by nothing"


def test_open_cases_are_there_and_others_are_news(suite):
    for group, cases in suite.stress.OPEN.items():
        assert cases <= {case.name for case in suite.stress.GROUPS[group]}
    group, known = next((group, min(cases)) for group, cases in suite.stress.OPEN.items())

    def news(case, verdict, *, quick=False):
        return suite.stress.surprises([{"group": group, "case": case, "verdict": verdict, "found": "x"}], quick=quick)

    good, bad = suite.stress.AS_EXPECTED, suite.stress.NOT_AS_EXPECTED
    assert news(known, bad) == news("another", good) == []
    assert news("another", bad) == [f"{group}: another: x"]
    assert "take it off" in news(known, good)[0]
    assert news(known, good, quick=True) == []


def test_det_J_is_sampled_as_it_is(suite):
    from hoblock import BlockStructure, generate

    corners = {"a": (0.0, 0.0), "b": (2.0, 0.0), "c": (2.0, 3.0), "d": (0.0, 1.0)}
    mesh = generate(BlockStructure.build(corners, [("a", "b", "c", "d")], counts=2), 3)
    det_J = suite.sampling.sampled_det_J(mesh)
    assert det_J.shape == (4, 33, 33)
    assert det_J.min() == pytest.approx(1.0 / 16.0 * 2.0, rel=1e-12)
    assert det_J.max() == pytest.approx(3.0 / 16.0 * 2.0, rel=1e-12)
    folded = mesh.with_points(mesh.points * [1.0, -1.0])
    assert suite.sampling.sampled_det_J(folded).max() < 0.0


def test_teeth_are_what_changes_its_sign(suite):
    t = np.arange(40.0)
    early, late = suite.runs.teeth(1.0 + 0.01 * t + 0.3 * (-1.0) ** t * np.where(t < 20.0, 1.0, 0.5))
    assert early == pytest.approx(0.3, rel=0.01)
    assert late == pytest.approx(0.15, rel=0.3)


def test_a_group_is_carried_out_and_written(suite, tmp_path, capsys):
    file = tmp_path / "stress.json"
    result = suite.stress_suite.main(["gradings", "--quick", "--cases", "certificate", "--json", str(file)])
    written = json.loads(file.read_text(encoding="utf-8"))
    assert [row["verdict"] for row in result.rows] == ["as expected"] * 3
    assert written["rows"] == [dict(row) for row in result.rows]
    assert "3 of 3 cases as expected" in capsys.readouterr().out


def test_groups_that_are_not_there_are_refused(suite, capsys):
    with pytest.raises(SystemExit):
        suite.stress_suite.main(["nothing"])
    assert "there is no group 'nothing'; expected one of mesh_motion, " in capsys.readouterr().err
