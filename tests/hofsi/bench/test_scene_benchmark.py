"""Scenes as benchmarks."""

from __future__ import annotations

from pathlib import Path

import pytest

from hofsi.bench.checks import Check, Limit
from hofsi.bench.flags import FLAGS
from hofsi.bench.flows import FLOWS
from hofsi.bench.scene_benchmark import SCENES, Quick, SceneBenchmark
from hofsi.bench.solids import SOLIDS
from hofsi.io.scene import load_case

EXAMPLES = Path(__file__).parents[3] / "examples"
ALL = (*FLOWS, *SOLIDS, *FLAGS)
FLAG = SceneBenchmark(
    "flag",
    "a flag",
    "csm1",
    (Check("u_y last", -6.61032e-2, 1e-5, 1e-5, "a table"), Limit("iterations a step", "none", at_most=0.0)),
    ("mesh.order=3",),
    Quick(("mesh.order=2",), {"u_y last": 0.05}),
)


@pytest.mark.parametrize("scene", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_scenes_are_those_of_the_examples(scene: Path) -> None:
    """The package has its own, for a user's machine has no folder of examples."""
    assert scene.read_text(encoding="utf-8") == (EXAMPLES / scene.name).read_text(encoding="utf-8")


@pytest.mark.parametrize("benchmark_case", ALL, ids=lambda case: case.name)
def test_the_quantities_that_are_judged_are_those_of_the_scene(benchmark_case: SceneBenchmark) -> None:
    quick = () if benchmark_case.quick is None else benchmark_case.quick.changes
    for changes in (benchmark_case.changes, (*benchmark_case.changes, *quick)):
        case = load_case(SCENES / f"{benchmark_case.scene}.toml", changes)
        names = {quantity.name for quantity in case.quantities}
        asked = {check.quantity.rpartition(" ") for check in benchmark_case.checks if isinstance(check, Check)}
        assert {name for name, _, _ in asked} <= names
        parts = {part for _, _, part in asked}
        assert parts <= {"last", "mean", "amplitude", "frequency"}
        assert parts == {"last"} or case.output.period_of is not None
    if benchmark_case.quick is not None:
        assert set(benchmark_case.quick.allowed) <= {check.quantity for check in benchmark_case.checks}


def test_a_coarse_run_misses_what_is_allowed(tmp_path: Path) -> None:
    measured = FLAG.measure(tmp_path, quick=False)
    tip, iterations = measured.findings
    assert 1e-5 < abs(tip.error or 0.0) < 1e-2
    assert not tip.passed
    assert iterations.passed
    assert not measured.passed
    assert measured.failure == ""
    assert measured.settings == {"scene": "csm1", "changes": ["mesh.order=3"]}
    assert measured.size == "solid: 32 elements, 650 unknowns; 1 step"
    assert measured.seconds["total"] >= measured.seconds["solid"] > 0.0


def test_the_quick_problem_is_smaller_and_held_to_wider_limits(tmp_path: Path) -> None:
    measured = FLAG.measure(tmp_path, quick=True)
    assert measured.settings["changes"] == ["mesh.order=3", "mesh.order=2"]
    assert measured.counts["solid"]["unknowns"] == 306
    assert measured.passed


def test_a_run_that_fails_is_not_passed(tmp_path: Path) -> None:
    soft = SceneBenchmark("soft", "", "csm1", FLAG.checks, ("mesh.order=2", "solid[0].youngs_modulus=1"))
    measured = soft.measure(tmp_path, quick=False)
    assert not measured.passed
    assert measured.failure
