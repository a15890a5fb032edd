"""Node numbers of any order on the same elements: geometry, velocity and pressure share this code."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.int64]

__all__ = ["corner_nodes", "number_nodes", "side_nodes"]


def corner_nodes(order: int) -> Index:
    """Local numbers of the four corners, counter-clockwise, of an element of the given order."""
    return np.array([0, order, (order + 1) ** 2 - 1, order * (order + 1)])


def side_nodes(order: int) -> Index:
    """Local nodes of the four sides, shape (4, p + 1), each along its direction (increasing coordinate)."""
    k = np.arange(order + 1)
    n = order + 1
    return np.stack([k, order + n * k, order * n + k, n * k])


def number_nodes(corners: Index, order: int) -> tuple[Index, int]:
    """Number the nodes of elements of one order that are connected through their corners and edges.

    Parameters
    ----------
    corners : ndarray, shape (e, 4)
        Corner identities of each element, counter-clockwise; any integers.
    order : int
        Order q ≥ 1.

    Returns
    -------
    cells : ndarray, shape (e, (q + 1)²)
        Node numbers, lexicographic in each element.
    count : int
        Number of nodes: corners first, then edges, then interiors.
    """
    unique, compressed = np.unique(corners, return_inverse=True)
    compressed = compressed.reshape(corners.shape).astype(np.int64)
    cells = np.empty((len(corners), (order + 1) ** 2), dtype=np.int64)
    count = len(unique)
    cells[:, corner_nodes(order)] = compressed
    if order == 1:
        return cells, count
    sides = compressed[:, [[0, 1], [1, 2], [3, 2], [0, 3]]]  # (e, 4, 2), directed
    start, stop = sides.reshape(-1, 2).T
    ascending = start < stop
    keys = np.where(ascending, start * count + stop, stop * count + start)  # one integer a pair sorts faster
    pairs, first, edge = np.unique(keys, return_index=True, return_inverse=True)
    same = ascending == ascending[first[edge]]  # runs like the first element that has the edge
    inner = np.arange(order - 1)
    numbers = count + edge[:, None] * (order - 1) + np.where(same[:, None], inner, inner[::-1])
    cells[:, side_nodes(order)[:, 1:-1].ravel()] = numbers.reshape(len(corners), -1)
    count += len(pairs) * (order - 1)
    inside = (np.arange(1, order)[:, None] * (order + 1) + np.arange(1, order)).ravel()
    cells[:, inside] = count + np.arange(len(corners) * len(inside)).reshape(len(corners), -1)
    return cells, count + len(corners) * len(inside)
