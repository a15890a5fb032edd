"""The fluid's nonlinear iterations: how they converge, and what they say when they do not."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi import case
from hofsi.errors import LinearSolverError, NewtonError

NOBODY = np.zeros((0, 2))


UNEVEN = "6*y*(1 - y)*exp(-y)"


def driven(flows, **settings):
    conditions = [flows.velocity("top", 1, 0), case.NoSlip(("left", "right", "bottom"))]
    return flows.solver(flows.grid(2, 4, 4), conditions, viscosity=1e-3, **settings)


def test_newton_says_how_far_it_came(flows):
    solver = driven(flows, max_iterations=1)
    before = solver.initial_state()
    step = solver.begin_steady(before, solver.mesh.points)
    message = (
        r"fluid, t = 0: .*relative residual of .* after 1 iterations; expected below 1e-12.* "
        r"Approached little by little, 0(\.\d+)? of the convection was reached"
    )
    with pytest.raises(NewtonError, match=message) as caught:
        step.solve(NOBODY)
    assert caught.value.reason == "max_iterations"
    assert not step.converged
    assert not np.any(before.velocity)


def test_newton_that_leaves_the_finite_numbers_says_so(flows):
    solver = driven(flows, initial_velocity=("1e200*y*(1 - y)*x", "1e200*x*(1 - x)"))
    with pytest.raises(NewtonError, match="not finite") as caught:
        flows.steady(solver)
    assert caught.value.reason == "diverged"


def test_a_flow_that_newton_does_not_find_from_rest_is_approached_with_more_and_more_of_the_convection(flows):
    mesh = flows.rectangle(4, 6, 6)
    conditions = [flows.velocity("top", 1, 0), case.NoSlip(("left", "right", "bottom"))]
    solver = flows.solver(mesh, conditions, viscosity=1e-3, tolerance=1e-10)
    step = solver.begin_steady(solver.initial_state(), mesh.points)
    step.solve(NOBODY, max_iterations=25)
    assert not step.converged
    assert solver.counts.continuation_steps == 0
    state = flows.steady(solver)
    assert solver.counts.continuation_steps > 2
    # Botella, Peyret, Computers & Fluids 27 (1998) 421-433, doi:10.1016/S0045-7930(98)00002-4: u at the centre.
    middle = np.argmin(np.hypot(*(mesh.points - 0.5).T))
    assert state.velocity[middle, 0] == pytest.approx(-0.0620561, abs=0.015)
    # What was found is a solution of the whole problem.
    again = solver.begin_steady(state, solver.mesh.points)
    before = solver.counts.factorisations
    again.solve(NOBODY)
    assert solver.counts.factorisations <= before + 1


@pytest.mark.parametrize("mode", ["newton", "picard"])
def test_a_flow_without_stress_converges(flows, mode):
    # Every term of the equations vanishes: there is no force to compare the residual with.
    turn = 0.3
    x, y = flows.rotation(turn) @ [1.0, 0.0]
    conditions = [flows.velocity("left", x, y), case.Slip(("top", "bottom")), flows.traction("right", 0, 0)]
    solver = flows.solver(flows.grid(3, turn=turn), conditions, viscosity=0.1, max_iterations=60, convection=mode)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, np.broadcast_to([x, y], state.velocity.shape), rtol=0.0, atol=1e-12)


def test_a_tolerance_below_rounding_is_met_as_far_as_rounding_allows(flows):
    solver = flows.channel(2, 4, 3, UNEVEN, viscosity=0.1, tolerance=1e-30)
    assert np.isfinite(flows.steady(solver).velocity).all()


def test_a_limited_solve_says_whether_it_converged(flows):
    solver = flows.channel(viscosity=0.05)
    step = solver.begin_steady(solver.initial_state(), solver.mesh.points)
    step.solve(NOBODY, max_iterations=1)
    assert not step.converged
    first = solver.counts.factorisations
    assert first == 1
    for _ in range(20):
        step.solve(NOBODY, max_iterations=1)
        if step.converged:
            break
    assert step.converged
    done = solver.counts.factorisations
    step.solve(NOBODY, max_iterations=1)  # nothing left to do
    assert solver.counts.factorisations == done
    expected = flows.field(solver.mesh.points, flows.parabola, 0)
    np.testing.assert_allclose(step.accept().velocity, expected, rtol=0.0, atol=1e-11)


def test_picard_and_newton_meet_in_the_same_flow(flows):
    def solve(mode):
        solver = flows.channel(2, 4, 3, UNEVEN, viscosity=0.1, tolerance=1e-11, max_iterations=60, convection=mode)
        return flows.steady(solver), solver.counts.iterations

    (newton, few), (picard, many) = solve("newton"), solve("picard")
    np.testing.assert_allclose(picard.velocity, newton.velocity, rtol=0.0, atol=1e-8)
    assert few < many


def test_newton_converges_quadratically(flows):
    solver = flows.channel(3, 4, 3, UNEVEN, viscosity=0.1)
    reference = flows.steady(solver).velocity
    step = solver.begin_steady(solver.initial_state(), solver.mesh.points)
    errors = [np.abs(step.solve(NOBODY, max_iterations=1)[0] - reference).max() for _ in range(5)]
    small = [k for k, error in enumerate(errors[:-1]) if error < 1e-1 and errors[k + 1] > 1e-12]
    assert small
    assert all(errors[k + 1] < 30.0 * errors[k] ** 2 for k in small)


def test_a_step_that_was_not_solved_has_no_reaction(flows):
    solver = flows.channel()
    step = solver.begin_step(solver.initial_state(), solver.mesh.points, (0.1,), 0.1, convection="linearised")
    with pytest.raises(ValueError, match="has not been solved"):
        step.reaction()


def test_a_matrix_that_is_singular_is_not_passed_over(flows):
    # Between slip walls, with free ends, nothing resists a steady body force.
    conditions = [case.Slip(("top", "bottom")), flows.traction("left", 0, 0), flows.traction("right", 0, 0)]
    solver = flows.solver(flows.grid(2), conditions, model="stokes", body_force=("1", "0"))
    with pytest.raises(LinearSolverError, match="singular"):
        flows.steady(solver)
