from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from hofsi.errors import LinearSolverError
from hofsi.linear.direct import DirectFactor


def laplacian(n):
    one = sp.diags_array([-np.ones(n - 1), 2.0 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
    return sp.csc_matrix(sp.kron(one, sp.eye_array(n)) + sp.kron(sp.eye_array(n), one))


def saddle_point(n, seed=91):
    rng = np.random.default_rng(seed)
    A = laplacian(n)
    B = sp.random_array((n, n * n), density=0.3, rng=rng)
    return sp.csc_matrix(sp.block_array([[A, B.T], [B, None]]))


@pytest.mark.parametrize("matrix", [laplacian(12), saddle_point(8)], ids=["definite", "saddle point"])
def test_solution(matrix):
    x = np.random.default_rng(12).standard_normal(matrix.shape[0])
    factor = DirectFactor(matrix)
    np.testing.assert_allclose(factor.solve(matrix @ x), x, rtol=1e-9, atol=1e-9)
    assert factor.entries >= matrix.shape[0]


def test_zero_diagonal_that_defeats_diagonal_pivots_is_solved_all_the_same():
    n = 30
    rng = np.random.default_rng(3)
    tiny = 1e-18 * np.eye(n)
    B = np.eye(n) + 0.1 * rng.standard_normal((n, n))
    dense = np.block([[tiny, B], [B.T, tiny]])
    x = rng.standard_normal(2 * n)
    np.testing.assert_allclose(DirectFactor(sp.csc_matrix(dense)).solve(dense @ x), x, rtol=1e-10, atol=1e-10)


def test_ill_conditioned_but_regular_matrix_is_solved():
    n = 60  # a clamped beam by finite differences and a stiff spring: condition number about 1e15
    second = laplacian_1d(n)
    matrix = sp.csc_matrix(second @ second)
    matrix[n - 1, n - 1] += 1e9
    b = np.ones(n)
    x = DirectFactor(matrix).solve(b)
    scale = np.abs(matrix).sum(axis=1).max() * np.abs(x).max()
    assert np.abs(matrix @ x - b).max() <= 1e-13 * scale


def laplacian_1d(n):
    return sp.csc_matrix(sp.diags_array([-np.ones(n - 1), 2.0 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1]))


def test_rounding_alone_is_no_reason_to_refuse():
    rng = np.random.default_rng(77)
    Q, _ = np.linalg.qr(rng.standard_normal((40, 40)))
    dense = (Q * np.logspace(0, -11, 40)) @ Q.T
    matrix = sp.csc_matrix((dense + dense.T) / 2.0)
    b = Q[:, -1].copy()  # the solution is 1e11 times as large as b
    x = DirectFactor(matrix).solve(b)
    assert np.abs(matrix @ x - b).max() > 1e-8
    np.testing.assert_allclose(x / np.linalg.norm(x), b, atol=1e-3)


def test_zero_right_hand_side():
    np.testing.assert_array_equal(DirectFactor(laplacian(4)).solve(np.zeros(16)), np.zeros(16))


def test_no_unknowns():
    assert DirectFactor(sp.csc_matrix((0, 0))).solve(np.zeros(0)).shape == (0,)


def test_exactly_singular_matrix_is_reported():
    with pytest.raises(LinearSolverError, match=r"matrix of size 3 is singular .* boundary condition may be missing"):
        DirectFactor(sp.csc_matrix(np.diag([1.0, 0.0, 2.0])))


def test_numerically_singular_matrix_is_reported():
    n = 50
    matrix = laplacian_1d(n)
    matrix[0, 0] = matrix[n - 1, n - 1] = 1.0  # a free chain: constant vectors are in the kernel
    matrix = sp.csc_matrix(matrix * np.pi)
    with pytest.raises(LinearSolverError, match="singular"):
        DirectFactor(matrix).solve(np.ones(n))


def test_right_hand_side_that_is_not_finite_is_refused():
    b = np.ones(16)
    b[3] = np.nan
    with pytest.raises(LinearSolverError, match="right-hand side is not finite"):
        DirectFactor(laplacian(4)).solve(b)
