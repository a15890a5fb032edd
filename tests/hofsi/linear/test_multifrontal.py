"""Multifrontal LU against dense solutions and SuperLU."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi.errors import LinearSolverError
from hofsi.fem.assembly import MatrixPattern
from hofsi.linear.checked import CheckedSolver
from hofsi.linear.direct import DirectFactor, PivotedFactor
from hofsi.linear.multifrontal import EliminationTree, MultifrontalFactor, multifrontal_solver


def elements(nx=6, ny=5, fields=3, fixed=0.2, seed=21):
    """Element matrices on a grid with several unknowns a corner, some of which are held."""
    rng = np.random.default_rng(seed)
    k = np.arange((nx + 1) * (ny + 1)).reshape(ny + 1, nx + 1)
    corners = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    cells = (fields * corners[:, :, None] + np.arange(fields)).reshape(len(corners), -1)
    free = rng.random(fields * k.size) > fixed
    number = np.where(free, np.cumsum(free) - 1, -1)
    x, y = np.meshgrid(np.arange(nx), np.arange(ny))
    S = rng.standard_normal((len(cells), cells.shape[1], cells.shape[1])) + 6.0 * np.eye(cells.shape[1])
    return number[cells], int(free.sum()), np.stack([x.ravel(), y.ravel()], axis=-1).astype(float), S


def assembled(cells, size, S):
    return MatrixPattern(cells, size).matrix(S)


@pytest.mark.parametrize("leaf", [1, 2, 5, 100])
@pytest.mark.parametrize("fixed", [0.0, 0.3])
def test_solution_is_that_of_the_assembled_system(leaf, fixed):
    cells, size, places, S = elements(fixed=fixed)
    K = assembled(cells, size, S)
    tree = EliminationTree(cells, size, places, leaf)
    factor = MultifrontalFactor(tree, S)
    b = np.random.default_rng(4).standard_normal(size)
    np.testing.assert_allclose(factor.substitute(b), np.linalg.solve(K.toarray(), b), atol=1e-11)
    np.testing.assert_allclose(factor.product(b), K @ b, atol=1e-12)
    assert factor.norm() >= abs(K).sum(axis=1).max() - 1e-9
    assert factor.entries == tree.entries >= size


def test_factors_are_used_again_and_the_right_hand_side_is_kept():
    cells, size, places, S = elements()
    solver = multifrontal_solver(EliminationTree(cells, size, places), S, lambda: assembled(cells, size, S))
    K = assembled(cells, size, S)
    for seed in (5, 6):
        b = np.random.default_rng(seed).standard_normal(size)
        given = b.copy()
        x = solver.solve(b)
        np.testing.assert_array_equal(b, given)
        np.testing.assert_allclose(K @ x, b, atol=1e-11)
    assert not solver.fell_back


@pytest.mark.parametrize("leaf", [1, 3, 100])
def test_kept_unknowns_are_left_with_the_schur_complement(leaf):
    cells, size, places, S = elements(fixed=0.1)
    kept = 11
    # Any unknowns may be kept; they are numbered last.
    number = np.random.default_rng(3).permutation(size)
    cells = np.where(cells >= 0, number[cells], -1)
    K = assembled(cells, size, S).toarray()
    n = size - kept
    factor = MultifrontalFactor(EliminationTree(cells, size, places, leaf, kept), S)
    inner = np.linalg.solve(K[:n, :n], K[:n, n:])
    np.testing.assert_allclose(factor.complement, K[n:, n:] - K[n:, :n] @ inner, atol=1e-11)
    x = np.random.default_rng(7).standard_normal(kept)
    np.testing.assert_allclose(factor.extended(x), np.append(-inner @ x, x), atol=1e-11)
    b = np.random.default_rng(8).standard_normal(n)
    np.testing.assert_allclose(factor.substitute(b), np.linalg.solve(K[:n, :n], b), atol=1e-11)
    np.testing.assert_allclose(factor.product(b), K[:n, :n] @ b, atol=1e-12)


def test_nothing_kept_leaves_nothing():
    cells, size, places, S = elements()
    assert MultifrontalFactor(EliminationTree(cells, size, places), S).complement.shape == (0, 0)


def saddle(scale=1.0):
    """Like Stokes: the last field of each corner has no diagonal."""
    cells, size, places, S = elements(fixed=0.0, seed=8)
    S = S + S.transpose(0, 2, 1)
    third = np.arange(2, S.shape[1], 3)
    S[:, third[:, None], third] = 0.0
    return cells, size, places, scale * S


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_saddle_points_need_no_diagonal(scale):
    cells, size, places, S = saddle(scale)
    solver = multifrontal_solver(EliminationTree(cells, size, places), S, lambda: assembled(cells, size, S))
    x = np.random.default_rng(9).standard_normal(size)
    K = assembled(cells, size, S)
    np.testing.assert_allclose(solver.solve(K @ x), x, atol=1e-8)
    np.testing.assert_allclose(DirectFactor(K).solve(K @ x), x, atol=1e-8)


def test_a_front_without_pivots_is_solved_by_other_means():
    # Two elements; what the first eliminates has no diagonal and no coupling to itself.
    cells = np.array([[0, 1], [1, 2]])
    S = np.array([[[0.0, 1.0], [1.0, 0.0]], [[1.0, 2.0], [0.5, 3.0]]])
    tree = EliminationTree(cells, 3, np.array([[0.0, 0.0], [1.0, 0.0]]), 1)
    with pytest.raises(LinearSolverError, match="a front of 1 unknowns is singular at unknown"):
        MultifrontalFactor(tree, S)
    solver = multifrontal_solver(tree, S, lambda: assembled(cells, 3, S))
    assert solver.fell_back
    K = assembled(cells, 3, S).toarray()
    np.testing.assert_allclose(solver.solve(K @ [1.0, -2.0, 3.0]), [1.0, -2.0, 3.0], atol=1e-12)


def test_a_poor_pivot_is_mended_by_refinement():
    cells = np.array([[0, 1], [1, 2]])
    S = np.array([[[1e-18, 1.0], [1.0, 0.0]], [[1.0, 2.0], [0.5, 3.0]]])
    tree = EliminationTree(cells, 3, np.array([[0.0, 0.0], [1.0, 0.0]]), 1)
    solver = multifrontal_solver(tree, S, lambda: assembled(cells, 3, S))
    K = assembled(cells, 3, S).toarray()
    b = K @ [1.0, -2.0, 3.0]
    assert np.abs(K @ MultifrontalFactor(tree, S).substitute(b) - b).max() > 0.1
    np.testing.assert_allclose(solver.solve(b), [1.0, -2.0, 3.0], atol=1e-10)


def test_poor_factors_give_way_to_safe_ones():
    class Poor(MultifrontalFactor):
        def substitute(self, b):
            return 0.5 * super().substitute(b)

    cells, size, places, S = elements()
    K = assembled(cells, size, S)
    solver = CheckedSolver(Poor(EliminationTree(cells, size, places), S), lambda: PivotedFactor(K))
    x = np.random.default_rng(9).standard_normal(size)
    np.testing.assert_allclose(solver.solve(K @ x), x, atol=1e-10)
    assert solver.fell_back


def test_factors_can_be_told_to_give_way():
    cells, size, places, S = elements()
    K = assembled(cells, size, S)
    solver = multifrontal_solver(EliminationTree(cells, size, places), S, lambda: assembled(cells, size, S))
    b = K @ np.random.default_rng(9).standard_normal(size)
    solver.fall_back()
    assert solver.fell_back
    np.testing.assert_array_equal(solver.solve(b), CheckedSolver(PivotedFactor(K)).solve(b))
    solver.fall_back()  # there is nothing left to fall back to
    assert solver.fell_back


def test_a_singular_matrix_is_reported():
    cells, size, places, S = elements(fixed=0.0)
    S = S - S.mean(axis=2, keepdims=True)  # constant vectors are in the kernel
    S -= (S.sum(axis=2) / S.shape[2])[:, :, None]
    solver = multifrontal_solver(EliminationTree(cells, size, places), S, lambda: assembled(cells, size, S))
    with pytest.raises(LinearSolverError, match="singular"):
        solver.solve(np.random.default_rng(2).standard_normal(size))


def test_no_unknowns():
    cells, places = np.full((4, 3), -1), np.zeros((4, 2))
    factor = MultifrontalFactor(EliminationTree(cells, 0, places), np.ones((4, 3, 3)))
    assert factor.substitute(np.zeros(0)).shape == (0,)
