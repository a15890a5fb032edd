"""Neighbours of elements across shared sides, and how much their sizes differ."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.quality.measures import element_areas

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["neighbours", "size_jump"]


def neighbours(mesh: QuadMesh) -> Index:
    """Pairs of elements that share a side, shape (k, 2).

    Sides are told apart by their middle nodes, since two elements around a hole may share both corners of two sides.
    """
    order = mesh.order
    middle = side_nodes(order)[:, [order // 2, order - order // 2]]  # one node twice, or the two next to the middle
    sides = np.sort(mesh.cells[:, middle], axis=2).reshape(-1, 2)
    keys = sides[:, 0] * (int(mesh.cells.max(initial=0)) + 1) + sides[:, 1]
    sequence = np.argsort(keys, kind="stable")
    same = np.flatnonzero(np.diff(keys[sequence]) == 0)
    return np.stack([sequence[same], sequence[same + 1]], axis=-1) // 4


def size_jump(mesh: QuadMesh) -> Array:
    """Largest ratio of areas between an element and its neighbours, the larger over the smaller, shape (e,).

    At least 1, and 1 where there is no neighbour; infinite where one of two areas is not positive.
    """
    return _jumps(neighbours(mesh), element_areas(mesh))


def _jumps(pairs: Index, areas: Array) -> Array:
    first, second = areas[pairs[:, 0]], areas[pairs[:, 1]]
    smaller, larger = np.minimum(first, second), np.maximum(first, second)
    with np.errstate(over="ignore"):
        ratio = np.where(smaller > 0.0, larger / np.where(smaller > 0.0, smaller, 1.0), np.inf)
    ratio[np.isnan(first) | np.isnan(second)] = np.nan
    result = np.ones(len(areas))
    for side in range(2):
        np.maximum.at(result, pairs[:, side], ratio)
    return result
