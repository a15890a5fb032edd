"""Orders of convergence of exact flows: in space and in time on moving blocks, and on curved ones at rest."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import pytest

pytestmark = pytest.mark.verification

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
ORDERS = (2, 3, 4, 5, 6)
FULL_MESH = ("pseudo-solid", "pseudo-solid, area", "pseudo-solid, area, incremental")


@pytest.fixture(scope="module")
def study() -> Iterator[SimpleNamespace]:
    """Studies of benchmarks/manufactured_flows; those in space are made once."""
    sys.path.insert(0, str(FOLDER))
    from manufactured_flows.study import as_scene, at_rest, in_space, in_time

    yield SimpleNamespace(in_space=cache(in_space), in_time=in_time, at_rest=at_rest, as_scene=as_scene)
    sys.path.remove(str(FOLDER))
    for name in list(sys.modules):
        if name.partition(".")[0] in ("manufactured_flows", "full_mesh_movers"):
            sys.modules.pop(name)


# In space -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("case", ["vortex", "imposed"])
def test_blocks_made_anew_keep_the_order_in_space(study, case, order):
    found = study.in_space(case, order)
    assert found.velocity_order > order + 1 - 0.3
    assert found.pressure_order > order - 0.2


@pytest.mark.parametrize("mover", ["pseudo-solid", "angle-optimisation"])
def test_the_order_in_space_does_not_depend_on_the_mover_of_the_vertices(study, mover):
    found, barrier = study.in_space("imposed", 4, mover=mover), study.in_space("imposed", 4)
    assert found.velocity_order > 4.8
    assert found.pressure_order > 3.8
    assert found.velocity[1] < 2.0 * barrier.velocity[1]


@pytest.mark.parametrize("order", ORDERS)
def test_kovasznay_flow_on_curved_blocks_converges_at_the_full_order(study, order):
    found = study.at_rest(order)
    assert found.velocity_order > order + 1 - 0.15
    assert found.pressure_order > order - 0.15


# Beside it: all nodes moved -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mesh", FULL_MESH)
def test_around_corners_a_mesh_that_is_a_solid_is_not_better_than_order_three(study, mesh):
    # The displacement of a solid is singular at the corners of the hole; blocks are smooth there.
    for order in (4, 6):
        solid, blocks = study.in_space("imposed", order, mesh), study.in_space("imposed", order)
        assert solid.velocity_order < 3.5
        assert solid.pressure_order < 3.0
        assert solid.velocity[1] > 10.0 * blocks.velocity[1]
        assert solid.pressure[1] > 20.0 * blocks.pressure[1]


# In time --------------------------------------------------------------------------------------------------------------

IN_TIME = {
    "vortex": {"order": 6, "elements": 2, "interval": (0.2, 1.0), "steps": (10, 20)},
    "imposed": {"order": 6, "elements": 2, "interval": (0.1, 0.5), "steps": (20, 40)},
    "linear": {"order": 2, "elements": 1, "interval": (0.0, 0.5), "steps": (40, 80)},
}


@pytest.mark.parametrize("convection", ["newton", "linearised", "extrapolated"])
@pytest.mark.parametrize("pattern", ["equal", "varying"])
@pytest.mark.parametrize("case", IN_TIME)
def test_second_order_in_time_on_moving_blocks(study, case, pattern, convection):
    found = study.in_time(case, pattern, convection, **IN_TIME[case])
    assert found.velocity_order > 1.9
    assert found.pressure_order > 1.9
    if case != "imposed":  # whose pressure falls faster at these steps
        assert found.velocity_order < 2.1
        assert found.pressure_order < 2.1


@pytest.mark.parametrize(("case", "end"), [("vortex", 0.8), ("imposed", 0.4)])
def test_second_order_in_time_of_a_scene_as_it_is_run(study, case, end):
    # The first step is of first order; its error is of second.
    found = study.as_scene(case, order=6, elements=2, end=end, steps=(20, 40))
    assert found.velocity_order == pytest.approx(2.0, abs=0.1)
    assert found.pressure_order == pytest.approx(2.0, abs=0.1)
