"""Steady flows of a lower order as a start."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi.solvers.lower_order import start_of_lower_order

AROUND = ("left", "right", "bottom", "top")
VORTEX = ("sin(3*x)*cos(3*y)", "-cos(3*x)*sin(3*y)")


def vortices(flows, order, **fluid):
    """Flow through all four sides of curved elements."""
    mesh = flows.rectangle(order, 3, 3, bend=0.03)
    settings = {"viscosity": 0.05} | fluid
    return flows.solver(mesh, [flows.velocity(AROUND, *VORTEX)], **settings)


def solved(solver, state):
    step = solver.begin_steady(state, solver.mesh.points)
    step.solve(np.zeros((0, 2)))
    return step.accept()


@pytest.mark.parametrize("order", [6, 8, 12])
def test_the_flow_is_the_same_and_found_with_fewer_matrices(flows, order):
    direct, raised = vortices(flows, order), vortices(flows, order)
    expected = solved(direct, direct.initial_state())
    found = solved(raised, start_of_lower_order(raised, raised.initial_state()))
    np.testing.assert_allclose(found.velocity, expected.velocity, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(found.pressure, expected.pressure, rtol=0.0, atol=1e-9)
    assert raised.counts.iterations_below > 0
    assert raised.counts.assemblies < direct.counts.assemblies


def test_what_the_lower_order_has_is_carried_over_exactly(flows):
    mesh = flows.grid(7, 3, 2, turn=0.4)
    solver = flows.solver(mesh, [flows.velocity(AROUND, "2*x + y", "x - 2*y")], viscosity=0.3)
    start = start_of_lower_order(solver, solver.initial_state())
    x, y = mesh.points.T
    np.testing.assert_allclose(start.velocity, np.stack([2 * x + y, x - 2 * y], axis=-1), rtol=0.0, atol=1e-5)


def test_a_lower_order_that_fails_changes_nothing(flows):
    solver = vortices(flows, 6, max_iterations=0)
    state = solver.initial_state()
    assert start_of_lower_order(solver, state) is state


@pytest.mark.parametrize(
    ("order", "fluid"), [(5, {}), (6, {"model": "stokes"}), (6, {"initial_velocity": ("0.1", "0")})]
)
def test_only_what_pays_is_started_from_below(flows, order, fluid):
    solver = vortices(flows, order, **fluid)
    state = solver.initial_state()
    assert start_of_lower_order(solver, state) is state
    assert solver.counts.iterations_below == 0


def test_the_mesh_may_have_moved(flows):
    solver = vortices(flows, 6)
    moved = solver.mesh.points * [1.5, 1.0]
    start = start_of_lower_order(solver, solver.initial_state(points=moved))
    wall = solver.mesh.edge_nodes("right")
    expected = flows.field(moved[wall], *VORTEX)
    assert np.abs(start.velocity[wall] - expected).max() < 2e-2
    assert start.points[0] is moved
