"""Fields of elements at other points than their nodes."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.reference import gauss_lobatto, tensor_basis
from hofsi.fem.resampling import gathered, lexicographic, pressure_at_nodes, resampled
from hofsi.fem.spaces import TaylorHood


@pytest.mark.parametrize("order", [1, 2, 3, 6])
@pytest.mark.parametrize("shape", [(), (1,), (2,), (3,)])
def test_resampling_evaluates_the_polynomials(order, shape):
    rng = np.random.default_rng(83)
    values = rng.standard_normal((4, (order + 1) ** 2, *shape))
    s = np.array([-1.0, -0.35, 0.2, 0.9, 1.0])
    grid = np.stack(np.meshgrid(s, s, indexing="xy"), axis=-1).reshape(-1, 2)  # ξ fastest
    expected = np.tensordot(values, tensor_basis(gauss_lobatto(order), grid), axes=(1, 1))
    expected = np.moveaxis(expected, -1, 1)
    np.testing.assert_allclose(resampled(values, s), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_pressure_at_nodes_is_the_pressure(distorted, order):
    mesh = distorted(order)
    space = TaylorHood.on(mesh)
    rng = np.random.default_rng(84)
    pressure = rng.standard_normal(space.pressure_count)
    at_nodes = pressure_at_nodes(space, pressure)
    grid = np.stack(np.meshgrid(gauss_lobatto(order), gauss_lobatto(order), indexing="xy"), axis=-1).reshape(-1, 2)
    basis = tensor_basis(gauss_lobatto(order - 1), grid)
    for element in range(len(mesh.cells)):
        lexical = lexicographic(space.pressure_cells, order - 1)[element]
        np.testing.assert_allclose(at_nodes[mesh.cells[element]], basis @ pressure[lexical], rtol=0, atol=1e-13)


@pytest.mark.parametrize("order", [2, 4])
def test_pressure_integrals_do_not_change(distorted, order):
    mesh = distorted(order)
    space = TaylorHood.on(mesh)
    pressure = np.random.default_rng(85).standard_normal(space.pressure_count)
    nodal = pressure_at_nodes(space, pressure)
    at_quadrature = space.velocity.N @ nodal[space.velocity_cells][:, :, None]
    expected = space.pressure.N @ pressure[space.pressure_cells][:, :, None]
    np.testing.assert_allclose(at_quadrature, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_lexicographic_undoes_the_order_of_the_space(distorted, order):
    mesh = distorted(order + 1)
    space = TaylorHood.on(mesh)
    assert np.array_equal(lexicographic(space.velocity_cells, order + 1), mesh.cells)
    assert sorted(lexicographic(space.pressure_cells, order)[1]) == sorted(space.pressure_cells[1])


def test_gathered_inverts_the_distribution_to_elements(distorted):
    mesh = distorted(3)
    values = np.random.default_rng(86).standard_normal((len(mesh.points), 2))
    assert np.array_equal(gathered(values[mesh.cells], mesh.cells, len(values)), values)
