"""The same elements at another order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.numbering import number_nodes
from hoblock.reference import equispaced, gauss_lobatto, lagrange

Array = NDArray[np.float64]

__all__ = ["geometric_error", "resample"]

_CHUNK = 200_000  # points evaluated at a time, to bound the memory


def resample(mesh: QuadMesh, order: int) -> QuadMesh:
    """Return the mesh with elements of another order.

    Upwards the geometry is exactly the same. Downwards each element map is interpolated at the GLL nodes of the lower
    order: corners stay, neighbours still fit, and `geometric_error` tells how far the elements have moved.

    Parameters
    ----------
    mesh : QuadMesh
    order : int
        Order q ≥ 1.

    Returns
    -------
    QuadMesh
        Same elements in the same order and of the same names; nodes are numbered by `number_nodes`. The mesh itself if
        it has that order.

    Raises
    ------
    ValueError
        If the order is below one.
    """
    if order == mesh.order:
        return mesh
    nodes = gauss_lobatto(order)
    cells, count = number_nodes(mesh.corners, order)
    points = np.empty((count, 2))
    points[cells] = _evaluate(mesh, nodes)
    corners = _corner_places(order)
    points[cells[:, corners]] = mesh.points[mesh.corners]  # exactly
    return QuadMesh(points, cells, order, mesh.cell_groups, mesh.edge_groups)


def geometric_error(mesh: QuadMesh, other: QuadMesh) -> float:
    """Largest distance between points of equal (ξ, η) of two meshes with the same elements.

    It is an upper bound of how far boundaries are apart, sampled at (4p + 1)² points of each element.

    Parameters
    ----------
    mesh, other : QuadMesh
        Of any orders.

    Raises
    ------
    ValueError
        If the numbers of elements differ.
    """
    if len(mesh.cells) != len(other.cells):
        raise ValueError(
            f"geometric_error: {len(mesh.cells)} and {len(other.cells)} elements; expected the same elements twice."
        )
    grid = equispaced(4 * max(mesh.order, other.order))
    step = max(1, _CHUNK // len(grid) ** 2)
    largest = 0.0
    for start in range(0, len(mesh.cells), step):
        some = slice(start, start + step)
        largest = max(largest, float(np.hypot(*(_evaluate(mesh, grid, some) - _evaluate(other, grid, some)).T).max()))
    return largest


def _corner_places(order: int) -> list[int]:
    n = order + 1
    return [0, n - 1, n * n - 1, n * n - n]


def _evaluate(mesh: QuadMesh, grid: Array, some: slice = slice(None)) -> Array:
    """Positions of a tensor grid of reference points in some elements, shape (e, k², 2), ξ fastest."""
    n = mesh.order + 1
    B = lagrange(gauss_lobatto(mesh.order), grid)
    x = mesh.points[mesh.cells[some]].reshape(-1, n, n, 2)  # (e, j, i, d)
    return np.asarray(np.einsum("bj,ai,ejid->ebad", B, B, x, optimize=True).reshape(len(x), -1, 2))
