"""Fields of tensor-product elements at other points than their nodes; exact, they are polynomials."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.reference import gauss_lobatto, lagrange
from hofsi.fem.element import boundary_first
from hofsi.fem.spaces import TaylorHood

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["gathered", "lexicographic", "pressure_at_nodes", "resampled"]


def resampled(values: Array, s: Array) -> Array:
    """Values of element polynomials on a grid of points.

    Parameters
    ----------
    values : ndarray, shape (e, (q + 1)²) or (e, (q + 1)², k)
        At the GLL nodes, lexicographic; the order q is that of the array.
    s : ndarray, shape (m,)
        Points in [-1, 1].

    Returns
    -------
    ndarray, shape (e, m²) or (e, m², k)
        At the grid s × s, ξ fastest.
    """
    n = round(values.shape[1] ** 0.5)
    B = lagrange(gauss_lobatto(n - 1), s)
    grid = values.reshape(len(values), n, n, -1)
    along_xi = np.einsum("ai,ejik->ejak", B, grid)
    both = np.einsum("bj,ejak->ebak", B, along_xi)
    return np.asarray(both.reshape(len(values), len(s) ** 2, *values.shape[2:]))


def gathered(values: Array, cells: Index, count: int) -> Array:
    """Nodal array (count, ...) of element values (e, i, ...) that agree where elements meet."""
    result = np.empty((count, *values.shape[2:]))
    result[cells] = values
    return result


def lexicographic(cells: Index, order: int) -> Index:
    """Nodes of elements in lexicographic order, from the order of a space, boundary first."""
    result = np.empty_like(cells)
    result[:, boundary_first(order)[0]] = cells
    return result


def pressure_at_nodes(space: TaylorHood, pressure: Array) -> Array:
    """Pressure of order p - 1 at the nodes of the mesh, which has order p.

    Parameters
    ----------
    space : TaylorHood
    pressure : ndarray, shape (m,)

    Returns
    -------
    ndarray, shape (n,)
    """
    p = space.velocity.order
    values = pressure[lexicographic(space.pressure_cells, p - 1)]
    cells = lexicographic(space.velocity_cells, p)
    return gathered(resampled(values, gauss_lobatto(p)), cells, space.velocity_count)
