"""Unknowns that the same elements have, as one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Pairs", "UnknownGroups"]


class UnknownGroups:
    """Unknowns that the same elements have, those on a side of an element for example: cuts treat them alike.

    Parameters
    ----------
    cells : ndarray, shape (e, k)
        Unknowns of each element; negative ones are none.
    kept : ndarray, optional
        Unknowns that are not in a group with others than themselves.

    Attributes
    ----------
    kept : ndarray of bool, shape (g,)
        Groups of such unknowns.
    sizes, degree : ndarray, shape (g,)
        How many unknowns a group has, and how many elements have it.
    pairs : Pairs
        All groups and the elements that have them.
    """

    def __init__(self, cells: Index, kept: Index | None = None) -> None:
        elements, local = np.nonzero(cells >= 0)
        unknowns = cells[elements, local]
        sequence = np.argsort(unknowns, kind="stable")
        unknowns, elements = unknowns[sequence], elements[sequence]
        starts = np.flatnonzero(np.diff(unknowns, prepend=-1))
        degree = np.diff(np.append(starts, len(unknowns)))
        # Elements of each unknown, side by side.
        table = np.full((len(starts), int(degree.max(initial=0)) + 1), -1)
        column = np.arange(len(unknowns)) - np.repeat(starts, degree)
        table[np.repeat(np.arange(len(starts)), degree), column] = elements
        table[:, -1] = np.isin(unknowns[starts], [] if kept is None else kept)
        keys = np.lexsort(table.T[::-1]) if table.size else np.zeros(0, dtype=np.int64)
        new = np.append(True, (np.diff(table[keys], axis=0) != 0).any(axis=1))[: len(keys)]
        self._unknowns, self._starts = unknowns[starts][keys], np.append(np.flatnonzero(new), len(keys))
        self.sizes = np.diff(self._starts)
        self.degree = degree[keys][new]
        chosen, self.kept = table[keys][new][:, :-1], table[keys][new][:, -1] == 1
        self.pairs = Pairs(np.repeat(np.arange(len(chosen)), self.degree), chosen[chosen >= 0])

    def members(self, groups: Index) -> Index:
        """Unknowns of some groups, group after group, ascending in each."""
        sizes = self.sizes[groups]
        offsets = np.repeat(self._starts[groups] - np.append(0, np.cumsum(sizes)[:-1])[: len(groups)], sizes)
        return np.asarray(self._unknowns[offsets + np.arange(len(offsets))])

    def middles(self, places: Array) -> Array:
        """Mean place of the elements of each group."""
        g, n = self.pairs.group, len(self.degree)
        sums = [np.bincount(g, weights=x, minlength=n) for x in places[self.pairs.element].T]
        return np.asarray(np.stack(sums, axis=-1) / np.maximum(self.degree, 1)[:, None])


class Pairs:
    """Which of some elements have which groups: pairs of both, ascending in the groups.

    Attributes
    ----------
    group, element : ndarray, shape (n,)
    starts : ndarray
        Where the pairs of each group that occurs begin.
    """

    def __init__(self, group: Index, element: Index) -> None:
        self.group, self.element = group, element
        self.starts = np.flatnonzero(np.diff(group, prepend=-1))

    @property
    def groups(self) -> Index:
        """Groups that occur."""
        return self.group[self.starts]

    @property
    def counts(self) -> Index:
        """How many of the elements have each of them."""
        return np.diff(np.append(self.starts, len(self.group)))

    def restricted(self, elements: Index) -> Pairs:
        """The pairs of some of the elements."""
        inside = np.zeros(int(self.element.max(initial=-1)) + 1, dtype=bool)
        inside[elements[elements < len(inside)]] = True
        kept = inside[self.element]
        return Pairs(self.group[kept], self.element[kept])
