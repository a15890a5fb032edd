from __future__ import annotations

import numpy as np
import pytest

from hofsi.fem.assembly import MatrixPattern, assemble_vector

SIZE = 11


def numbered(rng, elements=7, local=4, negative=True):
    dofs = np.stack([rng.choice(SIZE, local, replace=False) for _ in range(elements)])
    if negative:
        dofs[rng.random(dofs.shape) < 0.2] = -1
    return dofs


@pytest.mark.parametrize("negative", [True, False])
def test_vector_is_the_sum_without_dropped_entries(negative):
    rng = np.random.default_rng(5)
    dofs = numbered(rng, negative=negative)
    values = rng.standard_normal(dofs.shape)
    expected = np.zeros(SIZE)
    keep = dofs >= 0
    np.add.at(expected, dofs[keep], values[keep])
    np.testing.assert_allclose(assemble_vector(dofs, values, SIZE), expected, atol=1e-15)


@pytest.mark.parametrize("negative", [True, False])
def test_matrix_is_the_sum_without_dropped_entries(negative):
    rng = np.random.default_rng(6)
    dofs = numbered(rng, negative=negative)
    values = rng.standard_normal((*dofs.shape, dofs.shape[1]))
    expected = np.zeros((SIZE, SIZE))
    for numbers, block in zip(dofs, values, strict=True):
        keep = numbers >= 0
        expected[np.ix_(numbers[keep], numbers[keep])] += block[np.ix_(keep, keep)]
    pattern = MatrixPattern(dofs, SIZE)
    for factor in (1.0, -2.5):  # the pattern is used again with other values
        matrix = pattern.matrix(factor * values)
        np.testing.assert_allclose(matrix.toarray(), factor * expected, atol=1e-14)
        assert matrix.has_sorted_indices
        assert matrix.nnz == np.count_nonzero(expected)


def test_nothing_but_dropped_entries_gives_an_empty_matrix():
    pattern = MatrixPattern(np.full((2, 3), -1), 4)
    assert pattern.matrix(np.ones((2, 3, 3))).nnz == 0
    np.testing.assert_array_equal(assemble_vector(np.full((2, 3), -1), np.ones((2, 3)), 4), np.zeros(4))
