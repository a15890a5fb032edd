import numpy as np
import pytest
import scipy.sparse as sp

from hofsi.errors import LinearSolverError
from hofsi.linear.direct import DirectFactor
from hofsi.linear.lagged import LaggedSolver

N = 200


@pytest.fixture
def rng():
    return np.random.default_rng(20261126)


def matrix(change, seed=7):
    rng = np.random.default_rng(seed)
    A = sp.diags_array([-1.0, 2.5, -1.3], offsets=[-1, 0, 1], shape=(N, N)).tocsc()
    return sp.csc_matrix(A + change * sp.diags_array(rng.uniform(-1.0, 1.0, N)))


def lagged(change, goal=1e-9, limit=30):
    A, made = matrix(change), []

    def factorise():
        made.append(1)
        return DirectFactor(A)

    return A, LaggedSolver(A.__matmul__, DirectFactor(matrix(0.0)), factorise, goal, limit), made


@pytest.mark.parametrize("goal", [1e-1, 1e-5, 1e-11])
def test_the_residual_reaches_the_goal_without_new_factors(rng, goal):
    A, solver, made = lagged(0.3, goal)
    b = rng.normal(size=N)
    assert np.linalg.norm(b - A @ solver.solve(b)) <= 2.0 * goal
    assert not made
    assert not solver.renewed
    assert solver.iterations > 0


def test_a_nearer_matrix_takes_fewer_iterations(rng):
    b = rng.normal(size=N)
    counts = []
    for change in (0.0, 0.01, 0.3):
        solver = lagged(change)[1]
        solver.solve(b)
        counts.append(solver.iterations)
    assert counts[0] == 1
    assert counts[0] < counts[1] < counts[2]


def test_too_many_iterations_lead_to_new_factors_once(rng):
    A, solver, made = lagged(1.0, limit=3)
    for _ in range(2):
        b = rng.normal(size=N)
        np.testing.assert_allclose(A @ solver.solve(b), b, atol=1e-11)
    assert solver.renewed
    assert made == [1]
    assert solver.iterations <= 4


def test_zero_is_solved_by_zero():
    solver = lagged(0.3)[1]
    np.testing.assert_array_equal(solver.solve(np.zeros(N)), 0.0)
    assert solver.iterations == 0


def test_a_right_hand_side_that_is_not_finite_is_refused():
    with pytest.raises(LinearSolverError, match="not finite"):
        lagged(0.3)[1].solve(np.full(N, np.nan))
