from __future__ import annotations

import numpy as np
import pytest

from hoblock.numbering import side_nodes
from hoblock.reference import gauss_lobatto
from hofsi.fem.element import boundary_first, element_table, side_table


def nodes_of(order):
    x = gauss_lobatto(order)
    return np.stack(np.meshgrid(x, x, indexing="xy"), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_basis_reproduces_polynomials_of_its_order(order):
    table = element_table(order, order + 2)
    x, y = nodes_of(order).T
    values = x**order * y - 2.0 * y**order
    p, q = table.points.T
    np.testing.assert_allclose(table.N @ values, p**order * q - 2.0 * q**order, atol=1e-13)
    np.testing.assert_allclose(table.dN[..., 0] @ values, order * p ** (order - 1) * q, atol=1e-12)
    np.testing.assert_allclose(table.dN[..., 1] @ values, p**order - 2.0 * order * q ** (order - 1), atol=1e-12)


@pytest.mark.parametrize("count", [2, 4, 7])
def test_quadrature_is_exact_to_degree_twice_count_minus_one(count):
    table = element_table(2, count)
    x, y = table.points.T
    degree = 2 * count - 2
    exact = (2.0 / (degree + 1)) ** 2
    assert table.weights @ (x**degree * y**degree) == pytest.approx(exact, rel=1e-13)
    assert abs(table.weights @ (x ** (degree + 2) * y**degree) - 2.0 / (degree + 3) * 2.0 / (degree + 1)) > 1e-6


@pytest.mark.parametrize("order", [1, 3, 4])
def test_side_tables_lie_on_the_sides_in_their_direction(order):
    nodes = nodes_of(order)
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for table, (first, last) in zip(side_table(order, order + 1), [(0, 1), (1, 2), (3, 2), (0, 3)], strict=True):
        s = table.points - corners[first]
        along = corners[last] - corners[first]
        np.testing.assert_allclose(s @ [-along[1], along[0]], 0.0, atol=1e-14)
        assert (np.diff(s @ along) > 0.0).all()
        np.testing.assert_allclose(table.N @ nodes, table.points, atol=1e-13)
        assert table.weights.sum() == pytest.approx(2.0)


@pytest.mark.parametrize("order", [1, 2, 5])
def test_boundary_first_is_a_permutation_that_starts_with_the_side_nodes(order):
    local, count = boundary_first(order)
    assert count == 4 * order
    assert sorted(local) == list(range((order + 1) ** 2))
    assert set(local[:count]) == set(side_nodes(order).ravel())
