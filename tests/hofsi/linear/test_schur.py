from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from hofsi.linear.schur import BlockTriangular, LeastSquaresCommutator, ScaledLaplacian

VELOCITIES, PRESSURES = 40, 11


class Inverse:
    """Dense inverse of a matrix."""

    def __init__(self, A):
        self._inverse = np.linalg.inv(A.toarray() if sp.issparse(A) else A)
        self.calls = 0

    def solve(self, r, /):
        self.calls += 1
        return self._inverse @ r


@pytest.fixture
def parts():
    rng = np.random.default_rng(19)
    D = rng.uniform(0.5, 2.0, VELOCITIES)
    return rng, D, sp.csr_matrix(rng.standard_normal((PRESSURES, VELOCITIES)))


def test_factorised_and_iterated_laplacian_agree_to_two_digits(parts):
    rng, D, B = parts
    made = []

    def approximate(L):
        made.append(Inverse(L + 0.1 * sp.diags(L.diagonal())))
        return made[-1]

    exact = ScaledLaplacian(B, D, approximate)
    assert exact.factorised
    assert not made
    iterated = ScaledLaplacian(B, D, approximate, factorise_up_to=PRESSURES - 1)
    L = B.toarray() / D @ B.toarray().T
    r = rng.standard_normal(PRESSURES)
    np.testing.assert_allclose(L @ exact.solve(r), r, atol=1e-11)
    residual = np.linalg.norm(L @ iterated.solve(r) - r) / np.linalg.norm(r)
    assert 1e-13 < residual <= 1.01e-2
    assert made[0].calls > 1


def test_commutator_is_exact_if_the_operators_commute(parts):
    # F = c D is pure inertia with a lumped mass matrix: -B F⁻¹ Bᵀ is then a multiple of L.
    rng, D, B = parts
    commutator = LeastSquaresCommutator(lambda v: 7.0 * D * v, ScaledLaplacian(B, D, Inverse))
    S = -B.toarray() / (7.0 * D) @ B.toarray().T
    p = rng.standard_normal(PRESSURES)
    np.testing.assert_allclose(commutator.solve(S @ p), p, atol=1e-11)


def test_block_triangular_is_the_inverse_of_the_upper_triangle(parts):
    rng, _, B = parts
    F = np.diag(rng.uniform(1.0, 3.0, VELOCITIES)) + 0.1 * rng.standard_normal((VELOCITIES, VELOCITIES))
    S = -np.eye(PRESSURES) + 0.1 * rng.standard_normal((PRESSURES, PRESSURES))
    upper = np.block([[F, B.toarray().T], [np.zeros((PRESSURES, VELOCITIES)), S]])
    x = rng.standard_normal(VELOCITIES + PRESSURES)
    triangular = BlockTriangular(Inverse(F), Inverse(S), B.T.tocsr())
    np.testing.assert_allclose(triangular.solve(upper @ x), x, atol=1e-11)
