"""Sums one direction after the other, against sums over all points at once."""

import numpy as np
import pytest

from hoblock.reference import (
    differentiation_matrix,
    gauss_legendre,
    gauss_lobatto,
    lagrange,
    tensor_basis,
    tensor_gradient,
    tensor_quadrature,
)
from hofsi.kernels.tensor_products import mass, product_tables, transport


@pytest.fixture(params=[(1, 3), (2, 4), (5, 4), (7, 9)], ids=str)
def both(request):
    order, count = request.param
    rng = np.random.default_rng(11 * order + count)
    nodes, order_of_nodes = gauss_lobatto(order), rng.permutation((order + 1) ** 2)
    values = lagrange(nodes, gauss_legendre(count)[0])
    tables = product_tables(values, values @ differentiation_matrix(nodes), order_of_nodes)
    points = tensor_quadrature(count)[0]
    N, dN = tensor_basis(nodes, points)[:, order_of_nodes], tensor_gradient(nodes, points)[:, order_of_nodes]
    return tables, N, dN, rng.normal(size=(2, 6, count**2))


def close(ours, theirs):
    np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-12 * np.abs(theirs).max())


def test_mass(both):
    tables, N, _, (c, _) = both
    close(mass(tables, c), np.einsum("eq,qi,qj->eij", c, N, N))


def test_transport(both):
    tables, N, dN, (c, d) = both
    expected = np.einsum("eq,qi,qj->eij", c, N, dN[..., 0]) + np.einsum("eq,qi,qj->eij", d, N, dN[..., 1])
    close(transport(tables, c, d), expected)


def test_the_mass_matrix_is_symmetric_to_the_last_digit(both):
    tables, _, _, (c, _) = both
    M = mass(tables, c)
    np.testing.assert_array_equal(M, M.transpose(0, 2, 1))
