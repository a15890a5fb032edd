"""Nested dissection of elements: which unknowns are eliminated where, and what is left over at each place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Front", "dissect"]

_BALANCE = (0.5, 0.45, 0.55)
"""Shares of the elements on one side of a cut that are tried."""


@dataclass(frozen=True, eq=False)
class Front:
    """A part of the elements, and the unknowns that are dealt with when its matrix is complete.

    Attributes
    ----------
    elements : ndarray
        Of a leaf, ascending; empty for a part that consists of two others.
    children : tuple of int
        Numbers of these two.
    unknowns : ndarray
        Those that are eliminated, which no other element has, one beside the other along the cut, then those that are
        left, in the order in which they will be eliminated.
    eliminated : int
        How many are eliminated.
    """

    elements: Index
    children: tuple[int, ...]
    unknowns: Index
    eliminated: int


def dissect(cells: Index, places: Array, leaf: int) -> tuple[Front, ...]:
    """Cut the elements in two again and again, by lines that cross few unknowns.

    Parameters
    ----------
    cells : ndarray, shape (e, k)
        Unknowns of each element; negative ones are none.
    places : ndarray, shape (e, 2)
        Where the elements are.
    leaf : int
        Elements of a part that is not cut any more.

    Returns
    -------
    tuple of Front
        Children before their parents; the last one has all elements. Parts that do not touch are joined by a front
        with nothing to eliminate.

    References
    ----------
    George, SIAM J. Numer. Anal. 10 (1973) 345–363, doi:10.1137/0710032.
    """
    size = int(cells.max(initial=-1)) + 1
    shared = _incidence(cells, size)
    total = np.bincount(cells[cells >= 0], minlength=size)
    middles = np.asarray(shared.T @ places) / np.maximum(total, 1)[:, None]
    parts: list[tuple[Index, tuple[int, ...], Index, Index]] = []

    def visit(elements: Index) -> tuple[int, Index, Index]:
        """Number of the part of some elements, its unknowns that are left, and how many of its elements have each."""
        children: tuple[int, ...] = ()
        if len(elements) <= leaf:
            mine = cells[elements]
            unknowns, counts = np.unique(mine[mine >= 0], return_counts=True)
        else:
            first, second = (visit(half) for half in _cut(elements, shared, places))
            children = first[0], second[0]
            unknowns, inverse = np.unique(np.concatenate([first[1], second[1]]), return_inverse=True)
            counts = np.bincount(inverse, weights=np.concatenate([first[2], second[2]])).astype(np.int64)
        done = counts == total[unknowns]
        own = unknowns[done][np.argsort(_along(middles[unknowns[done]]), kind="stable")]
        parts.append((np.sort(elements) if not children else elements[:0], children, own, unknowns[~done]))
        return len(parts) - 1, unknowns[~done], counts[~done]

    visit(np.arange(len(cells)))
    order = np.full(size, -1)
    eliminated = np.concatenate([part[2] for part in parts])
    order[eliminated] = np.arange(len(eliminated))
    return tuple(
        Front(elements, children, np.concatenate([own, left[np.argsort(order[left])]]), len(own))
        for elements, children, own, left in parts
    )


def _along(places: Array) -> Array:
    """Places along the direction in which they extend furthest: neighbours on a cut stay together."""
    if len(places) < 2:
        return np.zeros(len(places))
    x = places - places.mean(axis=0)
    return np.asarray(x @ np.linalg.eigh(x.T @ x)[1][:, 1])


def _incidence(cells: Index, size: int) -> sp.csr_matrix:
    """Elements by unknowns."""
    rows, columns = np.nonzero(cells >= 0)
    return sp.csr_matrix((np.ones(len(rows)), (rows, cells[rows, columns])), shape=(len(cells), size))


def _cut(elements: Index, shared: sp.csr_matrix, places: Array) -> tuple[Index, Index]:
    """Two parts of about equal size with few unknowns in common: the best of some straight cuts and one by distance."""
    mine = shared[elements]
    x = places[elements] - places[elements].mean(axis=0)
    keys = [x[:, 0], x[:, 1], x[:, 0] + x[:, 1], x[:, 0] - x[:, 1], _distance(mine)]
    best: tuple[int, Index, Index] | None = None
    degree = np.asarray(mine.sum(axis=0)).ravel()
    for key in keys:
        sequence = np.argsort(key, kind="stable")
        for share in _BALANCE:
            half = max(1, min(len(elements) - 1, round(share * len(elements))))
            low, high = sequence[:half], sequence[half:]
            inside = np.asarray(mine[low].sum(axis=0)).ravel()
            common = int(((inside > 0.0) & (inside < degree)).sum())
            if best is None or common < best[0]:
                best = common, low, high
    assert best is not None
    return elements[best[1]], elements[best[2]]


def _distance(mine: sp.csr_matrix) -> Array:
    """Distance in elements from one at the end of the longest way through them."""
    from scipy.sparse.csgraph import breadth_first_order, shortest_path

    graph = (mine @ mine.T).tocsr()
    last = int(breadth_first_order(graph, 0, return_predecessors=False)[-1])
    found = shortest_path(graph, unweighted=True, indices=last, directed=False)
    return np.asarray(np.where(np.isfinite(found), found, len(found)), dtype=float)
