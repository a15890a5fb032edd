"""Newton's method with old factors: the same flows, and new factors when there is a reason."""

import numpy as np
import pytest

from hofsi import case
from hofsi.solvers.fluid import FluidSolver

PROFILE = "4*y*(1 - y)*(1 + 0.2*sin(3*t))"


def channel(flows, lag, order=3):
    mesh = flows.grid(order, 4, 3, size=(3.0, 1.0))
    conditions = (
        flows.velocity("left", PROFILE, "0.1*sin(2*t)"),
        case.NoSlip(("top",)),
        case.Slip(("bottom",)),
        case.DoNothing(("right",)),
    )
    fluid = case.Fluid(1.0, 0.02, (), conditions, convection="newton")
    nobody = np.array([], dtype=np.int64)
    return FluidSolver(mesh, fluid, case.NonlinearSettings(), case.LinearSettings(lag=lag), nobody)


def start(flows, solver):
    return flows.steady(solver)


@pytest.mark.parametrize("order", [2, 4])
def test_steps_are_the_same_and_factors_are_made_rarely(flows, order):
    ends, counts = [], []
    for lag in (True, False):
        solver = channel(flows, lag, order)
        state = start(flows, solver)
        made = solver.counts.factorisations
        state = flows.march(solver, state, (0.05,) * 12)
        ends.append(state)
        counts.append(solver.counts.factorisations - made)
        assert sum(solver.counts.reasons.values()) == solver.counts.factorisations
    np.testing.assert_allclose(ends[0].velocity, ends[1].velocity, atol=1e-9)
    np.testing.assert_allclose(ends[0].pressure, ends[1].pressure, atol=1e-8)
    assert counts[0] <= 3
    assert counts[1] >= 24


def test_on_a_moving_mesh_too(flows):
    ends = []
    for lag in (True, False):
        solver = channel(flows, lag)
        X = solver.mesh.points
        state = flows.march(
            solver, start(flows, solver), (0.05,) * 6, lambda t, X=X: X * [1.0 + 0.1 * np.sin(t), 1.0 - 0.05 * t]
        )
        ends.append(state)
    np.testing.assert_allclose(ends[0].velocity, ends[1].velocity, atol=1e-9)
    np.testing.assert_allclose(ends[0].reaction, ends[1].reaction, atol=1e-9)


def reasons(solver, action):
    before = dict(solver.counts.reasons)
    action()
    return {name: n - before.get(name, 0) for name, n in solver.counts.reasons.items() if n > before.get(name, 0)}


def test_the_first_matrix_is_factorised(flows):
    solver = channel(flows, True)
    assert reasons(solver, lambda: start(flows, solver))["first"] == 1


def test_a_step_of_another_size_is_factorised(flows):
    solver = channel(flows, True)
    state = flows.march(solver, start(flows, solver), (0.05,) * 3)
    assert not reasons(solver, lambda: flows.march(solver, state, (0.04,), steps=(0.05,) * 3))
    assert reasons(solver, lambda: flows.march(solver, state, (0.01,), steps=(0.05,) * 3)) == {"step size": 1}


def test_a_flow_that_turns_round_is_factorised(flows):
    solver = channel(flows, True)
    state = flows.march(solver, start(flows, solver), (0.05,) * 3)
    turned = type(state)(tuple(-u for u in state.velocities), state.pressure, state.points, state.reaction, state.time)
    assert reasons(solver, lambda: flows.march(solver, turned, (0.05,), steps=(0.05,) * 3))["flow"] >= 1


def test_without_lag_every_matrix_is_factorised(flows):
    solver = channel(flows, False)
    found = reasons(solver, lambda: start(flows, solver))
    assert found == {"new matrix": solver.counts.solves}
    assert solver.counts.linear_iterations == 0


def test_factors_of_another_mesh_do_not_serve_unseen(flows):
    """Each step has a mesh of its own: every iteration has its own matrix."""
    solver = channel(flows, True)
    X, state = solver.mesh.points, start(flows, solver)
    before = solver.counts.assemblies, solver.counts.solves
    flows.march(solver, state, (0.05,) * 3, lambda t: X * [1.0 + 1e-9 * t, 1.0])
    made, solved = solver.counts.assemblies - before[0], solver.counts.solves - before[1]
    assert made >= 3
    assert solved >= made
