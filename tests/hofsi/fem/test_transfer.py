from __future__ import annotations

import numpy as np
import pytest

from hoblock.reference import gauss_lobatto, tensor_basis
from hofsi.fem.constraints import DirectedNodes, NodeConstraints
from hofsi.fem.element import boundary_first
from hofsi.fem.nesting import nested
from hofsi.fem.spaces import TaylorHood
from hofsi.fem.transfer import Transfer, coarse_constraints

NONE = np.zeros(0, dtype=np.int64)


def quads(columns, rows, seed=None):
    """Corners of a grid of quads, each beginning to count anywhere, and the places of the vertices."""
    number = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    corners = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    if seed is not None:
        turns = np.random.default_rng(seed).integers(0, 4, len(corners))
        corners = np.stack([np.roll(quad, turn) for quad, turn in zip(corners, turns, strict=True)])
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
    return corners, np.stack([x.ravel(), y.ravel()], axis=-1)


def positions(corners, vertices, order):
    """Nodes of bilinear elements, those on the boundary first, shape (e, n, 2)."""
    xi, eta = np.meshgrid(gauss_lobatto(order), gauss_lobatto(order))
    local = np.stack([xi.ravel(), eta.ravel()], axis=-1)[boundary_first(order)[0]]
    return tensor_basis(gauss_lobatto(1), local) @ vertices[corners[:, [0, 1, 3, 2]]]


def spaces(order, columns, rows, seed=None):
    corners, vertices = quads(columns, rows, seed)
    nesting = nested(corners, NONE)
    transfer = Transfer(TaylorHood.on_quads(corners, order), TaylorHood.on_quads(nesting.corners, order), nesting)
    return transfer, positions(corners, vertices, order), positions(nesting.corners, vertices, order), nesting


def sampled(space, velocity_places, pressure_places):
    """Element vectors of polynomials that the spaces contain."""
    p = space.order
    x, y = velocity_places[..., 0], velocity_places[..., 1]
    result = space.local_vector(np.stack([(x - 0.3) ** p + y, x * (y + 0.2) ** p], axis=-1))
    x, y = pressure_places[..., 0], pressure_places[..., 1]
    pressure = (x + 0.5 * y) ** (p - 1)
    b = space.pressure_boundary
    on, inside = space.rows(2)
    result[:, on], result[:, inside] = pressure[:, :b], pressure[:, b:]
    return result


@pytest.mark.parametrize("order", [2, 3, 5])
@pytest.mark.parametrize(("columns", "rows"), [(4, 2), (3, 4)])
def test_polynomials_are_interpolated_exactly(order, columns, rows):
    transfer, fine, coarse, nesting = spaces(order, columns, rows, seed=31)
    corners, vertices = quads(columns, rows, seed=31)
    fine_pressure = positions(corners, vertices, order - 1)
    coarse_pressure = positions(nesting.corners, vertices, order - 1)
    found = transfer.prolong(sampled(transfer.coarse, coarse, coarse_pressure))
    expected = sampled(transfer.fine, fine, fine_pressure)[:, : transfer.fine.boundary]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("order", [2, 4])
def test_restriction_is_the_transpose_and_matrices_are_galerkins(order):
    transfer, *_ = spaces(order, 4, 4, seed=7)
    rng = np.random.default_rng(19)
    fine, coarse = transfer.fine, transfer.coarse
    r, x = rng.standard_normal((len(fine.dofs), fine.boundary)), rng.standard_normal(coarse.dofs.shape)
    assert np.sum(r * transfer.prolong(x)) == pytest.approx(np.sum(transfer.restrict(r) * x), rel=1e-12)
    # A matrix that acts on the elements' boundaries alone shows Pᵀ A P by the same two.
    b = fine.boundary
    A = np.zeros((len(fine.dofs), fine.dofs.shape[1], fine.dofs.shape[1]))
    A[:, :b, :b] = rng.standard_normal((len(fine.dofs), b, b))
    product = (transfer.matrices(A) @ x[:, :, None])[:, :, 0]
    expected = transfer.restrict((A[:, :b, :b] @ transfer.prolong(x)[:, :, None])[:, :, 0])
    np.testing.assert_allclose(product, expected, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
def test_constraints_of_sides_are_those_of_the_fine_sides(order):
    transfer, fine, coarse, _ = spaces(order, 4, 2, seed=3)
    normal = np.array([0.6, 0.8])

    def on(space, places, axis, value):
        return np.unique(space.velocity_cells[np.abs(places[..., axis] - value) < 1e-12])

    def constraints(space, places):
        top = on(space, places, 1, 2.0)
        entries = [DirectedNodes.component(on(space, places, 0, 0.0), axis) for axis in range(2)]
        entries += [DirectedNodes.component(on(space, places, 1, 0.0), 1)]
        entries += [DirectedNodes(top, np.tile(normal, (len(top), 1)))]
        return NodeConstraints(space.velocity_count, entries)

    found = coarse_constraints(transfer, constraints(transfer.fine, fine))
    expected = constraints(transfer.coarse, coarse)
    np.testing.assert_array_equal(found.fixed, expected.fixed)
    np.testing.assert_array_equal(found.rotated, expected.rotated)
    np.testing.assert_allclose(found.frames, expected.frames, atol=1e-14)
