from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from hofsi.errors import LinearSolverError
from hofsi.linear.patches import PatchSmoother

pytest.importorskip("pyamg")

SIZE = 40


def matrix():
    rng = np.random.default_rng(47)
    return sp.csr_matrix(sp.random_array((SIZE, SIZE), density=0.2, rng=rng) + 4.0 * sp.eye_array(SIZE))


def patches(*groups):
    rows = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    return sp.csr_matrix((np.ones(len(rows)), (rows, np.concatenate(groups))), shape=(len(groups), SIZE))


def swept(A, b, groups):
    """Multiplicative Schwarz, written down."""
    x = np.zeros(SIZE)
    for group in groups:
        x[group] += np.linalg.solve(A[np.ix_(group, group)], (b - A @ x)[group])
    return x


GROUPS = [np.arange(0, 12), np.array([3, 5, 9, 20, 21]), np.arange(12, 30), np.arange(25, 40)]


@pytest.mark.parametrize(("precision", "tolerance"), [(np.float64, 1e-13), (np.float32, 1e-5)])
def test_sweeps_are_multiplicative_schwarz(precision, tolerance):
    A, b = matrix(), np.random.default_rng(53).standard_normal(SIZE)
    smoother = PatchSmoother(A, patches(*GROUPS), precision=precision)
    for backward in (False, True):
        x = np.zeros(SIZE, dtype=precision)
        smoother.sweep(x, b.astype(precision), backward=backward)
        expected = swept(A.toarray(), b, GROUPS[::-1] if backward else GROUPS)
        np.testing.assert_allclose(x, expected, rtol=0.0, atol=tolerance)
    np.testing.assert_allclose(smoother.residual(x, b.astype(precision)), b - A @ x, atol=tolerance)


def test_patches_are_inverted_some_at_a_time(monkeypatch):
    b = np.random.default_rng(59).standard_normal(SIZE)
    found = []
    for entries in (10**6, 30):
        monkeypatch.setattr("hofsi.linear.patches._AT_ONCE", entries)
        x = np.zeros(SIZE)
        PatchSmoother(matrix(), patches(*GROUPS)).sweep(x, b)
        found.append(x)
    np.testing.assert_array_equal(*found)


def test_singular_patches_are_solved_in_the_sense_of_least_squares_if_they_may():
    A = matrix().tolil()
    A[:3, :] = 0.0
    A[:, :3] = 0.0
    A[:3, :3] = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    group = [np.arange(3), np.arange(3, SIZE)]
    with pytest.raises(LinearSolverError, match="patch of 3 unknowns is singular"):
        PatchSmoother(_exactly_singular(), patches(*group))
    x = np.zeros(SIZE)
    b = np.concatenate([[1.0, 0.0, -1.0], np.zeros(SIZE - 3)])
    PatchSmoother(A.tocsr(), patches(*group), pseudo=True).sweep(x, b)
    np.testing.assert_allclose(x[:3], [1.0, 0.0, -1.0], atol=1e-12)


def _exactly_singular():
    A = sp.eye_array(SIZE).tolil()
    A[:3, :3] = 1.0
    return sp.csr_matrix(A)
