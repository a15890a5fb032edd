"""Coarser meshes of the same structure: every second line of element sides is left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

__all__ = ["Nesting", "nested"]

_FIRST, _SECOND = 1, 2

_THIN = 8.0
"""Ratio of the lengths of an element above which only its shorter one is doubled."""


@dataclass(frozen=True, eq=False)
class Nesting:
    """How elements lie in those of a coarser mesh: one, two or four in each.

    Attributes
    ----------
    parent : ndarray, shape (e,)
        The coarse element of each element.
    part : ndarray, shape (e, 2)
        Which part of its parent an element is along the parent's ξ and η: 0 all, 1 the first half, 2 the second half.
    turn : ndarray, shape (e,)
        Corner k of an element's parent lies towards the element's corner ``(k + turn) % 4``.
    corners : ndarray, shape (c, 4)
        Corners of the coarse elements, counter-clockwise, named as those of the fine ones.
    """

    parent: Index
    part: Index
    turn: Index
    corners: Index


def nested(corners: Index, kept: Index, lengths: Array | None = None) -> Nesting | None:
    """Merge elements across lines of element sides, no two of them side by side.

    A line goes straight on through every vertex of four elements. Lines along the boundary, lines that end at vertices
    of another number of elements, and lines through vertices that must be kept remain. Between them, every second line
    goes; where their number is even, one strip of elements stays as it is in that direction. No two sides of the coarse
    elements have the same ends.

    Parameters
    ----------
    corners : ndarray, shape (e, 4)
        Vertices of each element, counter-clockwise.
    kept : ndarray
        Vertices that the coarse elements must have as corners.
    lengths : ndarray, shape (e, 2), optional
        Of the elements along ξ and η. Lines that lie much further apart than the elements between them are wide remain
        too: what couples strongly, across thin elements, is to be coarsened first.

    Returns
    -------
    Nesting or None
        None if no line can go.
    """
    sides, first, second = _sides(corners)
    lines, count = _lines(sides, first, second, corners)
    across = _across(lines[sides], count)
    far = _far_apart(lines[sides], count, lengths)
    while True:
        gone = _alternate(across, far | _fixed(lines, count, sides, corners, kept))[lines]
        if not gone.any():
            return None
        nesting = _merged(corners, sides, first, second, gone)
        doubled = _doubled(corners, sides, nesting)
        if not doubled.size:
            return nesting
        kept = np.concatenate([kept, doubled])


def _sides(corners: Index) -> tuple[Index, Index, Index]:
    """Number of each element's sides, side s from corner s; for sides of two elements, each as 4 element + side."""
    start, stop = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    keys = np.minimum(start, stop) * (int(corners.max()) + 1) + np.maximum(start, stop)
    _, number, counts = np.unique(keys, return_inverse=True, return_counts=True)
    order = np.argsort(number.ravel(), kind="stable")
    begin = np.concatenate(([0], np.cumsum(counts)))[:-1][counts == 2]
    return number.reshape(corners.shape), order[begin], order[begin + 1]


def _vertex_counts(corners: Index) -> tuple[Index, Flags]:
    """How many elements each vertex has, and whether it lies on the boundary."""
    size = int(corners.max()) + 1
    sides, first, _ = _sides(corners)
    outer = np.ones(int(sides.max()) + 1, dtype=bool)
    outer[sides.ravel()[first]] = False
    on = np.zeros(size, dtype=bool)
    element, side = np.nonzero(outer[sides])
    on[corners[element, side]] = on[corners[element, (side + 1) % 4]] = True
    return np.bincount(corners.ravel(), minlength=size), on


def _lines(sides: Index, first: Index, second: Index, corners: Index) -> tuple[Index, int]:
    """The line of each side: those that meet opposite each other at a vertex of four elements hang together."""
    elements, outer = _vertex_counts(corners)
    regular = (elements == 4) & ~outer
    (e, s), (f, t) = divmod(first, 4), divmod(second, 4)
    pairs = []
    # The common side runs from corner s to s + 1 of one element, which are t + 1 and t of the other.
    for corner, here, there in ((corners[e, s], s - 1, t + 1), (corners[e, (s + 1) % 4], s + 1, t - 1)):
        through = regular[corner]
        pairs.append(np.stack([sides[e, here % 4], sides[f, there % 4]])[:, through])
    joined = np.concatenate(pairs, axis=1)
    size = int(sides.max()) + 1
    graph = sp.csr_matrix((np.ones(joined.shape[1], dtype=np.int8), joined), shape=(size, size))
    count, lines = sp.csgraph.connected_components(graph, directed=False)
    return lines.astype(np.int64), int(count)


def _fixed(lines: Index, count: int, sides: Index, corners: Index, kept: Index) -> Flags:
    """Lines that stay: along the boundary, and at vertices that are irregular or wanted."""
    elements, outer = _vertex_counts(corners)
    wanted = ~outer & (elements != 4)
    wanted |= outer & (elements > 2)
    wanted[kept] = True
    at = wanted[corners] | wanted[np.roll(corners, -1, axis=1)]
    single = np.bincount(sides.ravel()) == 1
    fixed = np.zeros(count, dtype=bool)
    fixed[lines[sides[at]]] = True
    fixed[lines[single]] = True
    return fixed


def _far_apart(lines: Index, count: int, lengths: Array | None) -> Flags:
    """Lines beside which an element is much longer than wide; ``lines`` are those of the elements' sides."""
    ratio = np.zeros(count)
    if lengths is not None:
        for along, sides in enumerate(((1, 3), (0, 2))):  # sides that are apart along ξ, along η
            for side in sides:
                np.maximum.at(ratio, lines[:, side], lengths[:, along] / lengths[:, 1 - along])
    return ratio > _THIN


def _across(lines: Index, count: int) -> sp.csr_matrix:
    """Which lines lie on opposite sides of an element."""
    pairs = np.concatenate([lines[:, [0, 2]], lines[:, [1, 3]]])
    graph = sp.csr_matrix((np.ones(len(pairs), dtype=np.int32), pairs.T), shape=(count, count))
    return (graph + graph.T).tocsr()


def _alternate(across: sp.csr_matrix, fixed: Flags) -> Flags:
    """Lines that go: not fixed, no two side by side; beginning beside the fixed ones and then every second."""
    start = fixed.copy()
    start[across.diagonal() > 0] = fixed[across.diagonal() > 0] = True
    number, labels = sp.csgraph.connected_components(across, directed=False)
    without = np.setdiff1d(np.arange(number), labels[start])
    start[np.unique(labels, return_index=True)[1][without]] = True  # rings without an end begin anywhere
    distance, front = np.where(start, 0, -1), start
    level = 0
    while front.any():
        level += 1
        front = (across @ front.astype(np.int32) > 0) & (distance < 0)
        distance[front] = level
    gone = np.zeros(len(fixed), dtype=bool)
    for line in np.argsort(distance, kind="stable"):  # as many as elements along one side of the mesh, not in all
        if not start[line]:
            beside = across.indices[across.indptr[line] : across.indptr[line + 1]]
            gone[line] = not gone[beside].any()
    return gone


def _merged(corners: Index, sides: Index, first: Index, second: Index, gone: Flags) -> Nesting:
    """Merge elements across sides that go."""
    through = gone[sides.ravel()[first]]
    (e, s), (f, t) = divmod(first[through], 4), divmod(second[through], 4)
    n = len(corners)
    graph = sp.csr_matrix((np.ones(len(e), dtype=np.int8), (e, f)), shape=(n, n))
    count, parent = sp.csgraph.connected_components(graph, directed=False)
    turn = np.full(n, -1)
    turn[np.unique(parent, return_index=True)[1]] = 0
    for _ in range(2):  # to the elements beside the first one, and to that across the corner
        for a, side, b, beyond in ((e, s, f, t), (f, t, e, s)):
            known = (turn[a] >= 0) & (turn[b] < 0)
            turn[b[known]] = (beyond - side + turn[a] - 2)[known] % 4
    inner = gone[sides][np.arange(n)[:, None], (np.arange(4) + turn[:, None]) % 4]  # sides as the parent counts them
    part = np.zeros((n, 2), dtype=np.int64)
    for axis, (low, high) in enumerate(((3, 1), (0, 2))):
        part[inner[:, high], axis], part[inner[:, low], axis] = _FIRST, _SECOND
    coarse = np.full((count, 4), -1, dtype=np.int64)
    for corner in range(4):
        outer = np.flatnonzero(~inner[:, corner] & ~inner[:, corner - 1])
        coarse[parent[outer], corner] = corners[outer, (corner + turn[outer]) % 4]
    return Nesting(parent.astype(np.int64), part, turn, coarse)


def _doubled(corners: Index, sides: Index, nesting: Nesting) -> Index:
    """Vertices in the middle of coarse sides whose ends are those of another coarse side too, as in rings of two."""
    elements, turn = np.arange(len(corners)), nesting.turn
    halves = np.full((2, len(nesting.corners), 4), -1, dtype=np.int64)
    middle = np.full((len(nesting.corners), 4), -1, dtype=np.int64)
    for side in range(4):
        own = (side + turn) % 4
        for end in (0, 1):  # of the side, where the element with that corner is
            corner = (side + end + turn) % 4
            there = corners[elements, corner] == nesting.corners[nesting.parent, (side + end) % 4]
            parents = nesting.parent[there]
            halves[end, parents, side] = sides[elements, own][there]
            if not end:
                middle[parents, side] = corners[elements, (own + 1) % 4][there]
    start, stop = nesting.corners.ravel(), np.roll(nesting.corners, -1, axis=1).ravel()
    ends = np.sort(np.stack([start, stop], axis=-1), axis=1)
    parts = np.sort(halves.reshape(2, -1).T, axis=1)
    distinct = np.unique(np.concatenate([ends, parts], axis=1), axis=0)
    pairs, counts = np.unique(distinct[:, :2], axis=0, return_counts=True)
    size = int(corners.max()) + 1
    twice = np.isin(ends @ np.array([size, 1]), pairs[counts > 1] @ np.array([size, 1]))
    return np.unique(middle.ravel()[twice])
