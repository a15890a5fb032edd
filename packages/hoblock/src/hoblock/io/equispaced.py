"""Equispaced geometry for file formats that assume it, and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.reference import equispaced, gauss_lobatto, lagrange

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["equispaced_points", "equispaced_values", "resampled"]


def equispaced_points(mesh: QuadMesh) -> Array:
    """Points of the same elements with equispaced instead of GLL nodes.

    Parameters
    ----------
    mesh : QuadMesh

    Returns
    -------
    ndarray, shape (n, 2)
        Numbered as in ``mesh.cells``. The geometry is exactly the same: an element map is a polynomial of order p,
        whatever nodes carry it.
    """
    return equispaced_values(mesh, mesh.points)


def equispaced_values(mesh: QuadMesh, values: Array) -> Array:
    """Values at the equispaced nodes of a continuous field that is given at the GLL nodes.

    Parameters
    ----------
    mesh : QuadMesh
    values : ndarray, shape (n, ...)
        One row for each node.

    Returns
    -------
    ndarray, shape (n, ...)
        A new array, numbered as in ``mesh.cells``.
    """
    return resampled(values, mesh.cells, mesh.order, gauss_lobatto(mesh.order), equispaced(mesh.order))


def resampled(values: Array, cells: Index, order: int, before: Array, after: Array) -> Array:
    """Values of the same element-wise polynomials at other nodes.

    Parameters
    ----------
    values : ndarray, shape (n, ...)
        At the nodes ``before`` of each element.
    cells : ndarray, shape (e, (p + 1)²)
        Lexicographic.
    order : int
    before, after : ndarray, shape (p + 1,)
        Reference nodes in [-1, 1]. Both contain the ends, so that values on a common side depend on it alone.

    Returns
    -------
    ndarray, shape (n, ...)
        At the nodes ``after``; rows that no element uses are copied.
    """
    result = np.array(values, dtype=float)
    if np.array_equal(before, after):
        return result
    n = order + 1
    B = lagrange(before, after)
    local = result[cells].reshape(len(cells), n, n, -1)  # (e, j, i, d), j along η
    along_xi = B @ local
    along_eta = B @ along_xi.reshape(len(cells), n, -1)  # (e, j, i d)
    result[cells] = along_eta.reshape(len(cells), n * n, *result.shape[1:])
    return result
