"""Node orders of other programs: permutations from the lexicographic order of hoblock's elements."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.int64]

__all__ = ["line_node_order", "node_order"]


@cache
def node_order(order: int, target: str) -> Index:
    """Permutation that puts the nodes of a quad into another program's order.

    Parameters
    ----------
    order : int
        Order p ≥ 1 of the element.
    target : {"vtk", "gmsh", "mfem", "skfem"}
        VTK's Lagrange quadrilateral (cell type 70; also 9 for p = 1 and 28 for p = 2), Gmsh's quadrangles (types 3,
        10, 36, 37, 38, 47 … 51 for p = 1 … 10), the nodes of MFEM's continuous elements (``H1_QuadrilateralElement``;
        those of its discontinuous ones, L2, are lexicographic as hoblock's are), or the degrees of freedom of the
        elements of `hoblock.io.skfem.lagrange_element` (also of scikit-fem's own ElementQuad1 and ElementQuad2).

    Returns
    -------
    ndarray, shape ((p + 1)²,)
        ``cells[:, node_order(p, target)]`` is in that program's order. VTK and Gmsh assume equispaced nodes, see
        `hoblock.io.equispaced.equispaced_points`; the others take GLL nodes.

    Raises
    ------
    ValueError
        If the order is below one or the target is unknown.
    """
    _check(order, target)
    grid = np.arange((order + 1) ** 2).reshape(order + 1, order + 1)
    result = _ORDERS[target](grid)
    result.setflags(write=False)
    return result


@cache
def line_node_order(order: int, target: str) -> Index:
    """Permutation of the nodes of a side, shape (p + 1,): both ends first, then the inner nodes along the side.

    Parameters and errors are those of `node_order`; all the programs agree.
    """
    _check(order, target)
    result = np.concatenate(([0, order], np.arange(1, order)))
    result.setflags(write=False)
    return result


def _check(order: int, target: str) -> None:
    if order < 1:
        raise ValueError(f"node_order: order is {order}; expected an integer >= 1.")
    if target not in _ORDERS:
        raise ValueError(f"node_order: target is {target!r}; expected one of {', '.join(map(repr, _ORDERS))}.")


def _corners(grid: Index) -> Index:
    return np.array([grid[0, 0], grid[0, -1], grid[-1, -1], grid[-1, 0]])


def _vtk(grid: Index) -> Index:
    """Corners; sides 0, 1, 2, 3, each along the increasing coordinate; interior lexicographically."""
    sides = (grid[0, 1:-1], grid[1:-1, -1], grid[-1, 1:-1], grid[1:-1, 0])
    return np.concatenate([_corners(grid), *sides, grid[1:-1, 1:-1].ravel()])


def _gmsh(grid: Index) -> Index:
    """Corners; sides walked counter-clockwise; the interior likewise, as a quad of order p - 2."""
    layers = []
    while len(grid) > 1:
        sides = (grid[0, 1:-1], grid[1:-1, -1], grid[-1, -2:0:-1], grid[-2:0:-1, 0])
        layers.extend([_corners(grid), *sides])
        grid = grid[1:-1, 1:-1]
    return np.concatenate([*layers, grid.ravel()])


def _mfem(grid: Index) -> Index:
    """Corners; sides walked counter-clockwise; interior lexicographically."""
    sides = (grid[0, 1:-1], grid[1:-1, -1], grid[-1, -2:0:-1], grid[-2:0:-1, 0])
    return np.concatenate([_corners(grid), *sides, grid[1:-1, 1:-1].ravel()])


_ORDERS = {"gmsh": _gmsh, "mfem": _mfem, "skfem": _vtk, "vtk": _vtk}
