"""How far the movers carry meshes, on the mesh-motion tests of docs/meshing/mesh_motion_tests.md."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.motion import MeshMotion
from hoblock.movers import BarrierEnergy
from hoblock.quality import scaled_jacobian

pytestmark = pytest.mark.verification

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
ORDERS = (2, 3, 4, 5, 6)
Journey = Callable[..., dict[float, float]]


@pytest.fixture(scope="module")
def journey() -> Iterator[Journey]:
    """(test, layout, order, …) → smallest scaled Jacobian of every certified position on the way, by the position."""
    sys.path.insert(0, str(FOLDER))
    from motion_cases import motion_case
    from motion_contest.contestants import CONTESTANTS
    from motion_contest.journey import travel

    known: dict[tuple[Any, ...], dict[float, float]] = {}
    makers = {one.name: one for one in CONTESTANTS}

    def run(test: str, layout: str, order: int, mover: str) -> dict[float, float]:
        key = (test, layout, order, mover)
        if key not in known:
            case, found = motion_case(test, layout), dict[float, float]()
            travel(case, order, makers[mover], 60, seen=lambda s, mesh: found.update({s: scaled_jacobian(mesh).min()}))
            known[key] = found
        return known[key]

    yield run
    sys.path.remove(str(FOLDER))
    for name in list(sys.modules):
        if name.partition(".")[0] in ("motion_cases", "motion_contest", "full_mesh_movers"):
            sys.modules.pop(name)


def reach(found: dict[float, float], least: float = 0.0) -> float:
    """Last position up to which the scaled Jacobian is at least a value."""
    last = 0.0
    for s, value in found.items():
        if value < least:
            break
        last = s
    return last


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(
    ("test", "layout", "mover", "position", "least"),
    [
        ("T3a", "cross4x", "barrier, bar", 0.95, 0.0),
        ("T3b", "cross4x", "barrier, bar", 90.0, 0.2),
        ("T3b", "cross4x", "barrier, bar", 150.0, 0.0),
        ("T3b", "cross4x", "barrier, bar, sliding", 180.0, 0.0),
        ("T3c", "cross4x", "barrier, bar", 180.0, 0.3),
        ("T3c", "O10r3", "barrier, ang", 180.0, 0.3),
        ("T4a", "cross24", "barrier, bar, sliding", 1.0, 0.0),
        ("T4a", "O10r3", "barrier, bar", 1.0, 0.0),
        ("T4b", "cross24", "barrier, bar", 120.0, 0.2),
        ("T4b", "O10r3", "barrier, ang", 90.0, 0.3),
        ("WR", "f4", "barrier, bar", 0.16, 0.7),
        ("WR", "f4", "barrier, ang, sliding", 0.16, 0.9),
        ("TH", "b3", "barrier, bar", 0.18, 0.4),
    ],
)
def test_the_barrier_reaches(journey, order, test, layout, mover, position, least):
    assert reach(journey(test, layout, order, mover), least) >= position * (1.0 - 1e-12)


@pytest.mark.parametrize("order", ORDERS)
def test_the_falling_flag(journey, order):
    """129 mm, the benchmark's, at a scaled Jacobian of 0.4, and valid to 185 mm; steps of about 10 mm are refined."""
    sys_case = journey("TH", "b3", order, "barrier, bar")
    from motion_cases import motion_case

    case = motion_case("TH", "b3")
    motion = MeshMotion(case.structure, order, case.edges, BarrierEnergy(case.structure, case.driven, edges=case.edges))
    state, x = motion.reference, motion.reference.positions
    worst_to_129 = 1.0
    for s in np.linspace(0.0, 0.2862, 121)[1:]:
        state = motion.move(state, case.motion(x, s))
        if case.tip(s) <= 129.0:
            worst_to_129 = min(worst_to_129, float(scaled_jacobian(state.mesh).min()))
    assert case.tip(0.2862) >= 185.0
    assert worst_to_129 >= 0.4
    assert len(sys_case) > 15


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("energy", "sliding", "least"), [("bar", False, 0.7), ("ang", True, 0.9)])
def test_the_flap_at_its_benchmark_deflection(journey, order, energy, sliding, least):
    journey("WR", "f4", order, "pseudo-solid, m = -1")
    from motion_cases import motion_case

    case = motion_case("WR", "f4")
    mover = BarrierEnergy(
        case.structure, case.driven, edges=case.edges, energy=energy, sliding=case.sliding if sliding else None
    )
    motion = MeshMotion(case.structure, order, case.edges, mover)
    for sign in (1.0, -1.0):
        state = motion.move(motion.start(), case.motion(motion.reference.positions, sign * 0.16688))
        assert abs(case.tip(0.16688)) == pytest.approx(1.3, abs=1e-4)
        assert scaled_jacobian(state.mesh).min() >= least


@pytest.mark.parametrize("order", [2, 3, 5, 6])
@pytest.mark.parametrize(("test", "layout"), [("T3b", "cross4x"), ("T3c", "O10r3"), ("T4b", "cross24"), ("WR", "f4")])
def test_orders_reach_the_same(journey, order, test, layout):
    """Within one of 60 steps: validity is decided by the blocks, not by the order of their elements."""
    mine, fourth = (journey(test, layout, p, "barrier, bar") for p in (order, 4))
    step = min(fourth)
    assert abs(reach(mine) - reach(fourth)) <= 1.01 * step


@pytest.mark.parametrize(
    ("test", "layout"), [("T3a", "cross4x"), ("T3b", "cross4x"), ("T3c", "cross4x"), ("T4b", "cross24"), ("WR", "f4")]
)
def test_the_barrier_reaches_further_than_the_papers_movers(journey, test, layout):
    best = reach(journey(test, layout, 4, "barrier, bar"))
    for other in (
        "pseudo-solid, m = -1",
        "pseudo-solid, m = 1 (published)",
        "pseudo-solid, m = 3 (published)",
        "pseudo-solid, m = -1, incremental",
        "angles, published",
        "angles, best setting",
    ):
        assert best >= reach(journey(test, layout, 4, other))


def test_cold_starts_find_the_mesh_of_continuation():
    sys.path.insert(0, str(FOLDER))
    try:
        from motion_cases import motion_case
    finally:
        sys.path.remove(str(FOLDER))
    for test, layout, to in (("T3b", "cross4x", 120.0), ("T4b", "cross24", 120.0), ("T3c", "cross4x", 200.0)):
        case = motion_case(test, layout, 2)
        motion = MeshMotion(case.structure, 4, case.edges, BarrierEnergy(case.structure, case.driven, edges=case.edges))
        state, x = motion.reference, motion.reference.positions
        for s in np.linspace(0.0, to, 41)[1:]:
            state = motion.move(state, case.motion(x, s))
        cold = motion.move(motion.reference, case.motion(x, to))
        np.testing.assert_allclose(cold.vertices, state.vertices, atol=1e-8)
        np.testing.assert_allclose(generate(state.structure, 4).points, state.mesh.points, atol=1e-12)
