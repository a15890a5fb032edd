"""Taylor–Hood numbering: continuous pressure, complete local orders, blocks that go where they belong."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, generate
from hoblock.reference import gauss_lobatto, tensor_basis
from hofsi.fem.spaces import TaylorHood

ORDERS = (2, 3, 4, 7)


def star(order):
    """Three quads round an interior vertex, one curved edge: every relative orientation that can occur."""
    angle = np.pi / 3.0 * np.arange(6)
    vertices = np.concatenate([[[0.0, 0.0]], np.stack([np.cos(angle), np.sin(angle)], axis=-1)])
    quads = [(0, 1, 2, 3), (0, 3, 4, 5), (0, 5, 6, 1)]
    curves = {(1, 2): Arc.from_center((0.0, 0.0), vertices[1], vertices[2])}
    return generate(BlockStructure.build(vertices, {"fluid": quads}, curves=curves, counts=2), order)


@pytest.mark.parametrize("order", ORDERS)
def test_pressure_nodes_lie_at_one_place_whichever_element_looks(order):
    mesh = star(order)
    space = TaylorHood.on(mesh)
    local = gauss_lobatto(order - 1)
    grid = np.stack(np.meshgrid(local, local, indexing="xy"), axis=-1).reshape(-1, 2)
    places = tensor_basis(gauss_lobatto(order), grid) @ mesh.points[mesh.cells]
    # Undo the order "boundary first" by finding at which local node each basis function of the pressure is one.
    found = np.full((space.pressure_count, 2), np.nan)
    table = tensor_basis(local, space.pressure.points)
    which = [int(np.flatnonzero((table == column[:, None]).all(axis=0))[0]) for column in space.pressure.N.T]
    assert sorted(which) == list(range(order**2))
    for element, cell in enumerate(space.pressure_cells):
        known = ~np.isnan(found[cell, 0])
        np.testing.assert_allclose(found[cell[known]], places[element, which][known], rtol=0.0, atol=1e-13)
        found[cell] = places[element, which]
    assert not np.isnan(found).any()
    distances = np.hypot(*(found[:, None] - found[None]).transpose(2, 0, 1)) + np.eye(len(found))
    assert distances.min() > 1e-3


@pytest.mark.parametrize("order", ORDERS)
def test_velocity_nodes_are_the_nodes_of_the_mesh(order):
    mesh = star(order)
    space = TaylorHood.on(mesh)
    expected = tensor_basis(gauss_lobatto(order), space.velocity.points) @ mesh.points[mesh.cells]
    np.testing.assert_allclose(space.velocity.N @ mesh.points[space.velocity_cells], expected, rtol=0.0, atol=1e-13)
    assert space.velocity_count == len(mesh.points)


@pytest.mark.parametrize("order", ORDERS)
def test_every_local_unknown_has_one_place_and_those_on_the_boundary_come_first(order):
    space = TaylorHood.on(star(order))
    k = space.dofs.shape[1]
    places = np.concatenate([np.arange(k)[rows] for field in range(3) for rows in space.rows(field)])
    assert sorted(places) == list(range(k))
    inside = np.concatenate([np.arange(k)[space.rows(field)[1]] for field in range(3)])
    np.testing.assert_array_equal(np.sort(inside), np.arange(space.boundary, k))
    counts = np.bincount(space.dofs[:, space.boundary :].ravel(), minlength=space.size)
    assert counts.max(initial=0) <= 1  # unknowns inside an element belong to it alone
    shared = np.bincount(space.dofs.ravel(), minlength=space.size)
    assert shared.min() == 1
    assert not np.any(counts[shared > 1])
    for field, cells in (
        (0, 2 * space.velocity_cells),
        (1, 2 * space.velocity_cells + 1),
        (2, 2 * space.velocity_count + space.pressure_cells),
    ):
        rows = np.concatenate([np.arange(k)[part] for part in space.rows(field)])
        np.testing.assert_array_equal(space.dofs[:, rows], cells)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_blocks_act_on_their_fields(order):
    space = TaylorHood.on(star(order))
    rng = np.random.default_rng(17)
    e, n, m, k = len(space.dofs), space.velocity_cells.shape[1], space.pressure_cells.shape[1], space.dofs.shape[1]
    x = rng.standard_normal((e, k))
    part = [x[:, np.concatenate([np.arange(k)[rows] for rows in space.rows(field)])] for field in range(3)]
    widths = (n, n, m)
    for row in range(3):
        for column in range(3):
            block = rng.standard_normal((e, widths[row], widths[column]))
            A = np.zeros((e, k, k))
            space.put(A, row, column, block)
            y = (A @ x[:, :, None])[:, :, 0]
            expected = (block @ part[column][:, :, None])[:, :, 0]
            rows = np.concatenate([np.arange(k)[part_] for part_ in space.rows(row)])
            np.testing.assert_allclose(y[:, rows], expected, rtol=0.0, atol=1e-12)
            assert not np.delete(y, rows, axis=1).any()


@pytest.mark.parametrize("order", [2, 4])
def test_saddle_point_matrices_are_made_of_their_blocks(order):
    space = TaylorHood.on(star(order))
    rng = np.random.default_rng(31)
    e, n, m = len(space.dofs), space.velocity_cells.shape[1], space.pressure_cells.shape[1]
    velocity, divergence = rng.standard_normal((2, 2, e, n, n)), rng.standard_normal((2, e, m, n))
    expected = np.zeros((e, space.dofs.shape[1], space.dofs.shape[1]))
    for a in range(2):
        for b in range(2):
            space.put(expected, a, b, velocity[a, b])
        space.put(expected, 2, a, divergence[a])
        space.put(expected, a, 2, divergence[a].transpose(0, 2, 1))
    np.testing.assert_array_equal(space.matrices(velocity, divergence), expected)


def test_local_vectors_hold_the_velocity_and_no_pressure():
    space = TaylorHood.on(star(4))
    values = np.random.default_rng(23).standard_normal((*space.velocity_cells.shape, 2))
    local = space.local_vector(values)
    for a in range(2):
        found = np.concatenate([local[:, rows] for rows in space.rows(a)], axis=1)
        np.testing.assert_array_equal(found, values[..., a])
    assert not any(local[:, rows].any() for rows in space.rows(2))


@pytest.mark.parametrize("order", [2, 5])
def test_side_tables_continue_the_element_tables(order):
    mesh = star(order)
    space = TaylorHood.on(mesh)
    rng = np.random.default_rng(41)
    for table, sides in ((space.velocity, space.velocity_sides), (space.pressure, space.pressure_sides)):
        # A polynomial of the basis' order, through values at quadrature points inside, has one continuation.
        nodal = rng.standard_normal(table.N.shape[1])
        gauss = np.polynomial.legendre.leggauss(order + 2)[0]
        for number, side in enumerate(sides):
            fixed, value = ((1, -1.0), (0, 1.0), (1, 1.0), (0, -1.0))[number]
            np.testing.assert_array_equal(side.points[:, fixed], value)
            expected = tensor_basis(gauss, side.points) @ (table.N @ nodal)
            np.testing.assert_allclose(side.N @ nodal, expected, rtol=0.0, atol=1e-12)


def test_first_order_meshes_have_no_taylor_hood_space():
    with pytest.raises(ValueError, match=r"mesh.order >= 2; got 1"):
        TaylorHood.on(star(1))
