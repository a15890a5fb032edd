"""Nodal normals of element sides, weighted with the basis so that they conserve flux."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.numbering import side_nodes
from hofsi.fem.constraints import DirectedNodes
from hofsi.fem.element import ElementTable, boundary_first
from hofsi.fem.geometry import side_geometry

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["consistent_normals"]

_KINK = 0.1  # radians between the normals of two sides from which their common node counts as a corner, ...
_CURVED = 0.2  # ... or this part of what one of the sides turns by itself: coarse elements of a smooth curve have kinks


def consistent_normals(X: Array, cells: Index, sides: Index, tables: tuple[ElementTable, ...]) -> list[DirectedNodes]:
    """Constraints along the normals n_i ∝ ∫ N_i n ds of the nodes on some sides.

    Nodes where two sides meet at an angle get two constraints, one along each side's normal. The angle of a corner is
    more than 0.1, and more than a fifth of the angle by which either side turns.

    Parameters
    ----------
    X : ndarray, shape (e, n, 2)
        Node positions, local nodes in the order of ``tables``.
    cells : ndarray, shape (e, n)
    sides : ndarray, shape (k, 2)
    tables : tuple of ElementTable
        Basis on the four sides; local nodes boundary first.

    Returns
    -------
    list of DirectedNodes
        One entry for smooth nodes; two more for corners, if there are any.

    References
    ----------
    Engelman, Sani, Gresho, Int. J. Numer. Meth. Fluids 2 (1982) 225–238, doi:10.1002/fld.1650020302.
    """
    order = tables[0].order
    position = np.argsort(boundary_first(order)[0])
    nodes, normals, turning = [], [], []
    for side in side_geometry(X, sides, tables):
        local = position[side_nodes(order)[side.number]]
        nodes.append(cells[side.elements][:, local])
        normals.append(side.table.N[:, local].T @ side.normals)
        turning.append(np.repeat(_angle(normals[-1][:, 0], normals[-1][:, -1]), len(local)))
    flat, vectors = np.concatenate(nodes).ravel(), np.concatenate(normals).reshape(-1, 2)
    units = vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
    found, inverse = np.unique(flat, return_inverse=True)
    total = np.stack([np.bincount(inverse, weights=vectors[:, d]) for d in range(2)], axis=-1)
    mean = total / np.hypot(total[:, 0], total[:, 1])[:, None]
    allowed = np.full(len(found), _KINK)
    np.maximum.at(allowed, inverse, _CURVED * np.concatenate(turning))
    corner = np.zeros(len(found), dtype=bool)
    corner[inverse[2.0 * _angle(mean[inverse], units) > allowed[inverse]]] = True  # half the kink is to either side
    corner &= np.bincount(inverse) > 1
    entries = [DirectedNodes(found[~corner], mean[~corner])]
    if corner.any():
        first = np.full(len(found), len(flat))
        last = np.zeros(len(found), dtype=np.int64)
        np.minimum.at(first, inverse, np.arange(len(flat)))
        np.maximum.at(last, inverse, np.arange(len(flat)))
        entries += [DirectedNodes(found[corner], units[which[corner]]) for which in (first, last)]
    return entries


def _angle(first: Array, second: Array) -> Array:
    """Angle between vectors (k, 2), in [0, π]."""
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.asarray(np.abs(np.arctan2(cross, np.sum(first * second, axis=1))))
