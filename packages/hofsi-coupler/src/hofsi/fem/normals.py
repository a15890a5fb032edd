"""Nodal normals of element sides, weighted with the basis so that they conserve flux."""

from __future__ import annotations

import numpy as np
from hoblock.numbering import side_nodes
from numpy.typing import NDArray

from hofsi.fem.constraints import DirectedNodes
from hofsi.fem.element import ElementTable, boundary_first
from hofsi.fem.geometry import side_geometry

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["consistent_normals"]

_KINK = 0.1  # radians between the normals of two sides from which their common node counts as a corner


def consistent_normals(X: Array, cells: Index, sides: Index, tables: tuple[ElementTable, ...]) -> list[DirectedNodes]:
    """Constraints along the normals n_i ∝ ∫ N_i n ds of the nodes on some sides.

    Nodes where two sides meet at an angle get two constraints, one along each side's normal.

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
    nodes, normals = [], []
    for side in side_geometry(X, sides, tables):
        local = position[side_nodes(order)[side.number]]
        nodes.append(cells[side.elements][:, local])
        normals.append((side.table.N[:, local].T @ side.normals))
    flat, vectors = np.concatenate(nodes).ravel(), np.concatenate(normals).reshape(-1, 2)
    units = vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
    found, inverse = np.unique(flat, return_inverse=True)
    total = np.stack([np.bincount(inverse, weights=vectors[:, d]) for d in range(2)], axis=-1)
    mean = total / np.hypot(total[:, 0], total[:, 1])[:, None]
    deviation = np.abs(mean[inverse, 0] * units[:, 1] - mean[inverse, 1] * units[:, 0])
    corner = np.zeros(len(found), dtype=bool)
    # Half the opening between two sides; end values of weighted normals on smooth curves differ far less.
    corner[inverse[(deviation > np.sin(_KINK / 2.0)) & (np.bincount(inverse)[inverse] > 1)]] = True
    entries = [DirectedNodes(found[~corner], mean[~corner])]
    if corner.any():
        first = np.full(len(found), len(flat))
        last = np.zeros(len(found), dtype=np.int64)
        np.minimum.at(first, inverse, np.arange(len(flat)))
        np.maximum.at(last, inverse, np.arange(len(flat)))
        entries += [DirectedNodes(found[corner], units[which[corner]]) for which in (first, last)]
    return entries

