"""Nested dissection of elements: which unknowns are eliminated where, and what is left over at each place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.linear.unknown_groups import Pairs, UnknownGroups

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
        left, in the order in which they will be eliminated, and at last those that will not be.
    eliminated : int
        How many are eliminated.
    """

    elements: Index
    children: tuple[int, ...]
    unknowns: Index
    eliminated: int


def dissect(cells: Index, places: Array, leaf: int, kept: Index | None = None) -> tuple[Front, ...]:
    """Cut the elements in two again and again, by lines that cross few unknowns.

    Parameters
    ----------
    cells : ndarray, shape (e, k)
        Unknowns of each element; negative ones are none.
    places : ndarray, shape (e, 2)
        Where the elements are.
    leaf : int
        Elements of a part that is not cut any more.
    kept : ndarray, optional
        Unknowns that are not eliminated anywhere.

    Returns
    -------
    tuple of Front
        Children before their parents; the last one has all elements. Parts that do not touch are joined by a front
        with nothing to eliminate.

    References
    ----------
    George, SIAM J. Numer. Anal. 10 (1973) 345–363, doi:10.1137/0710032.
    """
    groups = UnknownGroups(cells, kept)
    middles = groups.middles(places)
    parts: list[tuple[Index, tuple[int, ...], Index, Index]] = []

    def visit(elements: Index, pairs: Pairs) -> tuple[int, Index, Index]:
        """Number of the part of some elements, its groups that are left, and how many of its elements have each."""
        children: tuple[int, ...] = ()
        if len(elements) <= leaf:
            own, counts = pairs.groups, pairs.counts
        else:
            first, second = (visit(half, pairs.restricted(half)) for half in _cut(elements, pairs, groups, places))
            children = first[0], second[0]
            own, inverse = np.unique(np.concatenate([first[1], second[1]]), return_inverse=True)
            counts = np.bincount(inverse, weights=np.concatenate([first[2], second[2]])).astype(np.int64)
        done = (counts == groups.degree[own]) & ~groups.kept[own]
        eliminated = own[done][np.argsort(_along(middles[own[done]]), kind="stable")]
        parts.append((np.sort(elements) if not children else elements[:0], children, eliminated, own[~done]))
        return len(parts) - 1, own[~done], counts[~done]

    visit(np.arange(len(cells)), groups.pairs)
    order = len(groups.degree) + np.arange(len(groups.degree))
    eliminated = np.concatenate([part[2] for part in parts])
    order[eliminated] = np.arange(len(eliminated))
    fronts = []
    for elements, children, own, left in parts:
        left = left[np.argsort(order[left])]
        unknowns = groups.members(np.concatenate([own, left]))
        fronts.append(Front(elements, children, unknowns, int(groups.sizes[own].sum())))
    return tuple(fronts)


def _along(places: Array) -> Array:
    """Places along the direction in which they extend furthest: neighbours on a cut stay together."""
    if len(places) < 2:
        return np.zeros(len(places))
    x = places - places.mean(axis=0)
    return np.asarray(x @ np.linalg.eigh(x.T @ x)[1][:, 1])


def _cut(elements: Index, pairs: Pairs, groups: UnknownGroups, places: Array) -> tuple[Index, Index]:
    """Two parts of about equal size with few unknowns in common: the best of some straight cuts and one by distance."""
    x = places[elements] - places[elements].mean(axis=0)
    number = np.empty(int(elements.max()) + 1, dtype=np.int64)
    number[elements] = np.arange(len(elements))
    local = number[pairs.element]
    keys = np.stack([x[:, 0], x[:, 1], x[:, 0] + x[:, 1], x[:, 0] - x[:, 1], _distance(local, pairs, len(elements))])
    sequences = np.argsort(keys, axis=1, kind="stable")
    position = np.empty_like(sequences)
    np.put_along_axis(position, sequences, np.arange(len(elements))[None, :], axis=1)
    best: tuple[int, int, int] | None = None
    if len(local):
        of_pairs, sizes = position[:, local], groups.sizes[pairs.groups]
        first = np.minimum.reduceat(of_pairs, pairs.starts, axis=1)
        last = np.maximum.reduceat(of_pairs, pairs.starts, axis=1)
    for share in _BALANCE:
        half = max(1, min(len(elements) - 1, round(share * len(elements))))
        common = ((first < half) & (last >= half)) @ sizes if len(local) else np.zeros(len(keys), dtype=np.int64)
        k = int(common.argmin())
        if best is None or int(common[k]) < best[0]:
            best = int(common[k]), k, half
    assert best is not None
    sequence = elements[sequences[best[1]]]
    return sequence[: best[2]], sequence[best[2] :]


def _distance(local: Index, pairs: Pairs, count: int) -> Array:
    """Distance in elements from one at the end of the longest way through them; the count if there is no way."""
    groups = np.repeat(np.arange(len(pairs.starts)), pairs.counts)
    found = _levels(0, local, groups, count)
    found[found == count] = -1
    return _levels(int(found.argmax()), local, groups, count).astype(float)


def _levels(start: int, local: Index, groups: Index, count: int) -> Index:
    """Breadth-first search over pairs of elements and groups from one element."""
    distance = np.full(count, count)
    distance[start] = level = 0
    front = distance == 0
    while front.any():
        level += 1
        touched = np.zeros(int(groups.max(initial=-1)) + 1, dtype=bool)
        touched[groups[front[local]]] = True
        front = np.zeros(count, dtype=bool)
        front[local[touched[groups]]] = True
        front &= distance == count
        distance[front] = level
    return distance
