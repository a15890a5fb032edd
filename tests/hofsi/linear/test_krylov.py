from __future__ import annotations

import warnings

import numpy as np
import pytest
import scipy.sparse as sp

from hofsi.errors import LinearSolverError
from hofsi.linear.krylov import KrylovSolver, flexible_gmres

SIZE = 90


def matrix(seed=83):
    rng = np.random.default_rng(seed)
    return np.eye(SIZE) * 4.0 + rng.standard_normal((SIZE, SIZE)) / np.sqrt(SIZE)


class Diagonal:
    """Jacobi's preconditioner."""

    def __init__(self, A):
        self._d = 1.0 / np.diag(A)

    def solve(self, b, /):
        return self._d * b


class Inverse:
    """Preconditioner that is exact but for rounding."""

    def __init__(self, A):
        self._inverse = np.linalg.inv(A)

    def solve(self, b, /):
        return self._inverse @ b


@pytest.fixture
def pyamg():
    return pytest.importorskip("pyamg")


@pytest.mark.usefixtures("pyamg")
@pytest.mark.parametrize("restart", [60, 7])
def test_solution_and_number_of_iterations(restart):
    A = matrix()
    x = np.random.default_rng(8).standard_normal(SIZE)
    filters = list(warnings.filters)
    found, iterations = flexible_gmres(A.__matmul__, Diagonal(A).solve, A @ x, 1e-11, restart=restart)
    np.testing.assert_allclose(found, x, rtol=0.0, atol=1e-9)
    assert 5 < iterations < 35
    assert warnings.filters == filters


@pytest.mark.usefixtures("pyamg")
def test_preconditioner_may_change_from_iteration_to_iteration():
    A = matrix()
    scales = iter(np.random.default_rng(4).uniform(0.3, 3.0, 400))
    x = np.ones(SIZE)
    found, _ = flexible_gmres(A.__matmul__, lambda v: next(scales) * v, A @ x, 1e-10)
    np.testing.assert_allclose(found, x, rtol=0.0, atol=1e-8)


@pytest.mark.usefixtures("pyamg")
def test_tolerance_that_is_not_reached_is_an_error_with_numbers():
    shift = np.roll(np.eye(SIZE), 1, axis=0)  # nothing is gained before the last iteration
    b = np.eye(SIZE)[0]
    with pytest.raises(
        LinearSolverError,
        match=rf"relative residual of 1 after 20 iterations on {SIZE} unknowns; "
        r"expected 1e-10 \(linear\.tolerance\).*linear\.solver",
    ) as caught:
        flexible_gmres(shift.__matmul__, lambda v: v, b, 1e-10, restart=10, cycles=2)
    assert caught.value.reason == "max_iterations"


@pytest.mark.usefixtures("pyamg")
def test_preconditioner_that_is_not_finite_is_an_error():
    with pytest.raises(LinearSolverError, match="FGMRES"):
        flexible_gmres(matrix().__matmul__, lambda v: v * np.nan, np.ones(SIZE), 1e-10)


def test_right_hand_sides_that_need_no_iteration():
    found, iterations = flexible_gmres(matrix().__matmul__, lambda v: v, np.zeros(SIZE), 1e-10)
    np.testing.assert_array_equal(found, 0.0)
    assert iterations == 0
    with pytest.raises(LinearSolverError, match="right-hand side is not finite"):
        flexible_gmres(matrix().__matmul__, lambda v: v, np.full(SIZE, np.inf), 1e-10)


@pytest.mark.usefixtures("pyamg")
def test_rounding_is_accepted_if_the_size_of_the_matrix_is_known():
    Q, _ = np.linalg.qr(np.random.default_rng(77).standard_normal((40, 40)))
    A = (Q * np.logspace(0, -11, 40)) @ Q.T
    b = Q[:, -1].copy()  # the solution is 1e11 times as large as b
    with pytest.raises(LinearSolverError, match="relative residual"):
        flexible_gmres(A.__matmul__, Inverse(A).solve, b, 1e-10)
    solver = KrylovSolver(sp.csr_matrix(A), Inverse(A), 1e-10)
    x = solver.solve(b)
    assert 0 < solver.iterations < 200
    np.testing.assert_allclose(x / np.linalg.norm(x), b, atol=1e-3)
