"""Batches of matrices to solve with."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi.errors import LinearSolverError
from hofsi.fem.blocks import BlockFactors, BlockInverses, block_solver, joined


def matrices(count, rows):
    """Well-conditioned, unsymmetric, with no element of the diagonal fit to be a pivot."""
    rng = np.random.default_rng(31)
    return np.roll(rng.standard_normal((count, rows, rows)) + 4.0 * np.sqrt(rows) * np.eye(rows), 1, axis=1)


@pytest.mark.parametrize("kind", [BlockFactors, BlockInverses, block_solver])
@pytest.mark.parametrize("columns", [1, 7])
@pytest.mark.parametrize("rows", [5, 120])
def test_solutions_satisfy_their_equations(kind, rows, columns):
    padded = matrices(3, rows + 2)
    B = padded[:, 1:-1, 2:] + padded[:, 2:, :-2]  # neither symmetric nor contiguous
    right = np.random.default_rng(32).standard_normal((3, rows, columns))
    given = B.copy()
    X = kind(B).solve(right)
    np.testing.assert_allclose(B @ X, right, rtol=0.0, atol=1e-10)
    np.testing.assert_array_equal(B, given)


def test_large_blocks_are_factorised_and_small_ones_inverted():
    assert isinstance(block_solver(matrices(2, 20)), BlockInverses)
    assert isinstance(block_solver(matrices(2, 130)), BlockFactors)


@pytest.mark.parametrize("kind", [BlockFactors, BlockInverses])
def test_a_singular_block_is_an_error(kind):
    B = matrices(3, 6)
    B[1, :, 2] = 0.0
    with pytest.raises(LinearSolverError, match="inner unknowns is singular"):
        kind(B)


@pytest.mark.parametrize("n", [4, 120])
def test_batches_of_solvers_are_joined(n):
    rng = np.random.default_rng(3)
    B, R = rng.standard_normal((5, n, n)), rng.standard_normal((5, n, 2))
    solver = joined([block_solver(B[:2]), block_solver(B[2:4]), block_solver(B[4:])])
    np.testing.assert_allclose(B @ solver.solve(R), R, atol=1e-9)


@pytest.mark.parametrize("rows", [4, 120])
def test_a_flow_that_diverged_is_told_from_a_singular_matrix(rows):
    with pytest.raises(LinearSolverError, match="has diverged"):
        block_solver(np.full((2, rows, rows), 1e200))
