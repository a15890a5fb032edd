"""Which fluids have no pressure level, and what keeps them solvable."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hofsi import case
from hofsi.errors import CaseError
from hofsi.fem.geometry import physical_gradients

THREE = ("left", "right", "bottom")
CLOSED = {
    "walls": lambda flows: [case.NoSlip(flows.around)],
    "given velocities": lambda flows: [flows.velocity(flows.around, "y", "x")],
    "slip": lambda flows: [case.NoSlip(("bottom",)), case.Slip(("left", "right", "top"))],
    "component along the normal": lambda flows: [case.NoSlip(THREE), flows.velocity("top", None, 0)],
}
OPEN = {
    "do-nothing": lambda flows: [case.NoSlip(THREE), case.DoNothing(("top",))],
    "traction": lambda flows: [case.NoSlip(THREE), flows.traction("top", 0, 0)],
    "pressure": lambda flows: [case.Slip(THREE), flows.pressure("top", 0)],
    "component along the tangent": lambda flows: [case.NoSlip(THREE), flows.velocity("top", 0, None)],
}


def regions(flows, conditions):
    solver = flows.solver(flows.grid(3), conditions)
    return solver.enclosed(solver.mesh.points)


@pytest.mark.parametrize("kind", CLOSED)
def test_fluids_without_a_pressure_level(flows, kind):
    assert len(regions(flows, CLOSED[kind](flows)).pinned) == 1


@pytest.mark.parametrize("kind", OPEN)
def test_fluids_with_a_pressure_level(flows, kind):
    assert not regions(flows, OPEN[kind](flows))


@pytest.mark.parametrize("turn", [0.0, 0.5])
def test_curved_and_turned_slip_walls_enclose(flows, turn):
    mesh = flows.annulus(3)
    assert regions(flows, [case.Slip(flows.around)])
    solver = flows.solver(mesh, [case.NoSlip(("inner",)), case.Slip(("outer",))])
    assert solver.enclosed(mesh.points)
    turned = flows.solver(flows.grid(3, turn=turn), [case.Slip(flows.around)])
    assert turned.enclosed(turned.mesh.points)


def test_flow_under_a_line_of_symmetry_is_exact(flows):
    # Only the normal component is given on top, so the pressure is free up to a constant. μ ∂u/∂y = 0.6 drives.
    conditions = [
        flows.velocity(("left", "right"), "2*y", 0),
        case.NoSlip(("bottom",)),
        flows.velocity("top", None, 0, traction_x=0.6),
    ]
    solver = flows.solver(flows.grid(2), conditions, viscosity=0.3)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, flows.field(solver.mesh.points, "2*y", 0), rtol=0.0, atol=1e-12)
    assert np.abs(state.pressure).max() < 1e-11


def two_boxes(order):
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    vertices = np.concatenate([corners, corners + np.array([3.0, 0.0])])
    edges = {
        f"{name}{box}": [(4 * box + a, 4 * box + b)]
        for box in range(2)
        for name, (a, b) in {"bottom": (0, 1), "right": (1, 2), "top": (2, 3), "left": (3, 0)}.items()
    }
    blocks = {"fluid": [(0, 1, 2, 3), (4, 5, 6, 7)]}
    return generate(BlockStructure.build(vertices, blocks, edges=edges, counts=2), order)


def test_each_of_two_boxes_has_a_level_of_its_own(flows):
    mesh = two_boxes(3)
    names = tuple(mesh.edge_groups)
    closed = flows.solver(mesh, [case.NoSlip(names)], body_force=("0", "-2*x"))  # 2 y x is no gradient: the boxes stir
    assert len(closed.enclosed(mesh.points).pinned) == 2
    state = flows.steady(closed)
    assert np.abs(state.velocity).max() > 1e-3
    weights = closed.geometry(mesh.points).weights
    p = state.pressure[closed.space.pressure_cells] @ closed.space.pressure.N.T
    left = mesh.points[mesh.cells].mean(axis=1)[:, 0] < 2.0
    for box in (left, ~left):
        assert abs(np.sum(weights[box] * p[box])) < 1e-12

    others = tuple(name for name in names if name != "top1")
    half = flows.solver(mesh, [case.NoSlip(others), flows.pressure("top1", 3)])
    assert len(half.enclosed(mesh.points).pinned) == 1
    state = flows.steady(half)
    p = state.pressure[half.space.pressure_cells]
    np.testing.assert_allclose(p[~left], 3.0, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(p[left], 0.0, atol=1e-12)


def test_a_small_leak_is_spread_evenly(flows):
    # 2 % more leaves than enters: ∇·u = 0.02 everywhere instead of a source at one node.
    conditions = [flows.velocity("left", 1, 0), flows.velocity("right", 1.02, 0), case.Slip(("top", "bottom"))]
    solver = flows.solver(flows.grid(3, 4, 4), conditions)
    state = flows.steady(solver)
    gradients = physical_gradients(solver.geometry(solver.mesh.points), solver.space.velocity)
    u = state.velocity[solver.space.velocity_cells]
    divergence = sum((dN @ u)[..., a] for a, dN in enumerate(gradients))
    np.testing.assert_allclose(divergence, 0.02, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(state.velocity[:, 0], 1.0 + 0.02 * solver.mesh.points[:, 0], rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_velocities_that_cannot_balance_are_reported(flows, model):
    conditions = [flows.velocity("left", "4*y*(1 - y)", 0), case.NoSlip(("right", "top", "bottom"))]
    solver = flows.solver(flows.grid(2), conditions, model=model)
    with pytest.raises(CaseError, match=r"bring in 0\.66\d* per unit time more than they let out") as caught:
        flows.steady(solver)
    assert caught.value.place == "fluid.boundary"


def test_more_may_be_left_over_where_the_mesh_moves(flows):
    # 6 % more leaves than enters. At rest that is a mistake.
    conditions = [flows.velocity("left", 1, 0), flows.velocity("right", 1.06, 0), case.Slip(("top", "bottom"))]
    solver = flows.solver(flows.grid(2), conditions)
    with pytest.raises(CaseError, match="an incompressible fluid needs the sum 0"):
        flows.march(solver, solver.initial_state(), (0.1,))
    X = solver.mesh.points
    state = flows.march(solver, solver.initial_state(), (0.1,), lambda t: X + 0.1 * t * X * (1.0 - X))
    assert np.isfinite(state.velocity).all()


def test_velocities_that_balance_only_some_of_the_time_are_reported_when_they_do_not(flows):
    conditions = [flows.velocity("left", "1 + t", 0), flows.velocity("right", 1, 0), case.Slip(("top", "bottom"))]
    solver = flows.solver(flows.grid(2), conditions, initial_velocity=("1", "0"))
    state = flows.march(solver, solver.initial_state(), (0.05,))
    with pytest.raises(CaseError, match="an incompressible fluid needs the sum 0"):
        flows.march(solver, state, (0.5,), steps=(0.05,))


def test_a_box_that_is_squeezed_cannot_be_solved_for(flows):
    mesh = flows.grid(2)
    solver = flows.solver(mesh, [case.NoSlip(flows.around)])
    with pytest.raises(CaseError, match="an incompressible fluid needs the sum 0"):
        flows.march(solver, solver.initial_state(), (0.1,), lambda t: mesh.points * [1.0, 1.0 - 0.3 * t])
