"""Flow through the boundary and mean pressures: exact for polynomials, conservative, relative to a mesh that moves."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi import case
from hofsi.errors import CaseError
from hofsi.solvers.fluid import FluidState
from hofsi.solvers.fluid_flow import BoundaryFlow


def state_of(solver, x, y, points=None, mesh_velocity=None, pressure=None):
    points = solver.mesh.points if points is None else points
    p = np.zeros(solver.space.pressure_count) if pressure is None else pressure
    velocity = np.stack([x(*points.T), y(*points.T)], axis=-1)
    return FluidState((velocity,), p, (points,), np.zeros(points.shape), 0.0, mesh_velocity)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_flow_of_a_polynomial_is_exact(flows, order):
    solver = flows.solver(flows.grid(order), [case.NoSlip(flows.around)])
    state = state_of(solver, lambda x, y: 1.0 + 3.0 * y**2, lambda x, y: 2.0 * x + y)
    expected = {"left": -2.0, "right": 2.0, "bottom": -1.0, "top": 2.0}
    for name, rate in expected.items():
        assert BoundaryFlow(solver, [name]).rate(state) == pytest.approx(rate, abs=1e-13)
    whole = BoundaryFlow(solver)
    assert whole.rate(state) == pytest.approx(sum(expected.values()), abs=1e-13)  # the divergence is 1
    assert whole.inflow(state) == pytest.approx(3.0, abs=1e-13)


def test_a_side_with_two_names_counts_once(flows):
    solver = flows.solver(flows.grid(2), [case.NoSlip(flows.around)])
    state = state_of(solver, lambda x, y: 1.0 + 0.0 * x, lambda x, y: 0.0 * x)
    assert BoundaryFlow(solver, ["right", "right"]).rate(state) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("order", [2, 4])
def test_through_a_circle_flows_what_its_source_gives(flows, order):
    """u = x on polynomials of the circle: twice the area that these enclose."""
    solver = flows.solver(flows.annulus(order), [case.NoSlip(("inner", "outer"))])
    state = state_of(solver, lambda x, y: x, lambda x, y: y)
    area = solver.geometry(state.points[0]).weights.sum()
    outer, inner = (BoundaryFlow(solver, [name]).rate(state) for name in ("outer", "inner"))
    assert outer + inner == pytest.approx(2.0 * area, rel=1e-13)
    assert outer == pytest.approx(2.0 * np.pi, rel={2: 2e-2, 4: 1e-4}[order])


def test_relative_to_the_mesh_a_wall_that_moves_lets_nothing_through(flows):
    solver = flows.solver(flows.grid(3), [case.NoSlip(flows.around)])
    w = np.stack([solver.mesh.points[:, 1], np.cos(solver.mesh.points[:, 0])], axis=-1)
    state = state_of(solver, lambda x, y: y, lambda x, y: np.cos(x), mesh_velocity=w)
    top = BoundaryFlow(solver, ["top"])
    assert top.rate(state) == pytest.approx(np.sin(1.0), abs=1e-4)
    assert top.rate(state, relative=True) == 0.0
    at_rest = state_of(solver, lambda x, y: y, lambda x, y: np.cos(x))
    assert top.rate(at_rest, relative=True) == top.rate(at_rest)


def test_mean_pressure_is_that_of_the_length(flows):
    solver = flows.solver(
        flows.grid(3, size=(2.0, 1.0)), [case.NoSlip(flows.around)], body_force=("2 - x", "0"), viscosity=0.1
    )
    state = flows.steady(solver)  # p = 2 x - x²/2 + constant, with the mean 0
    mean = 2.0 - 2.0 / 3.0
    expected = {"left": -mean, "right": 2.0 - mean, "bottom": 0.0, "top": 0.0}
    for name, value in expected.items():
        assert BoundaryFlow(solver, [name]).mean_pressure(state) == pytest.approx(value, abs=1e-11)


@pytest.mark.parametrize("convection", ["newton", "extrapolated"])
def test_what_enters_a_channel_with_a_moving_wall_leaves_it(flows, convection):
    """Conservation of volume holds in every step, with the swept volume as the flow through the wall."""
    mesh = flows.rectangle(3, 3, 2)
    conditions = [flows.velocity("left", "y*(1 - y)", 0), case.NoSlip(("bottom", "top")), case.DoNothing(("right",))]
    solver = flows.solver(mesh, conditions, viscosity=0.05, convection=convection)

    def position(time):
        x, y = mesh.points.T
        return np.stack([x, y * (1.0 + 0.3 * np.sin(3.0 * time) * np.sin(np.pi * x))], axis=-1)

    state = flows.march(solver, solver.initial_state(), [0.05] * 4, position, linear=convection != "newton")
    rates = {name: BoundaryFlow(solver, [name]).rate(state) for name in flows.around}
    assert rates["top"] > 0.1  # the wall goes up and takes fluid with it
    assert rates["left"] == pytest.approx(-1.0 / 6.0, abs=1e-12)
    assert sum(rates.values()) == pytest.approx(0.0, abs=1e-12)
    assert BoundaryFlow(solver).rate(state) == pytest.approx(0.0, abs=1e-12)


def test_names_that_are_not_there(flows):
    solver = flows.solver(flows.grid(2), [case.NoSlip(flows.around)])
    with pytest.raises(CaseError, match="no edges named 'lft' at the fluid; known: bottom, left, right, top"):
        BoundaryFlow(solver, ["lft"])
