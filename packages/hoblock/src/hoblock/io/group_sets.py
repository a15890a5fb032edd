"""Groups that may overlap, as classes that do not: what formats with one number an element need."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh

Index = NDArray[np.int64]

__all__ = ["boundary_sides", "group_sets", "named_sides"]


def group_sets(groups: Mapping[str, Index], count: int) -> tuple[list[tuple[int, ...]], Index]:
    """Sort things into classes by the set of groups they belong to.

    Parameters
    ----------
    groups : mapping of str to ndarray
        Members of each group, numbers below ``count``.
    count : int

    Returns
    -------
    sets : list of tuple of int
        The sets of groups (positions in the mapping) that occur. First the single groups, in their order, whether or
        not they have members of their own, then the others. Without groups it is the empty set alone.
    classes : ndarray, shape (count,)
        Index into ``sets`` of each thing.
    """
    member = np.zeros((count, len(groups)), dtype=bool)
    for column, members in enumerate(groups.values()):
        member[members, column] = True
    sets: list[tuple[int, ...]] = [(k,) for k in range(len(groups))]
    if not groups:
        return [()], np.zeros(count, dtype=np.int64)
    patterns, which = np.unique(member, axis=0, return_inverse=True)
    number = np.zeros(len(patterns), dtype=np.int64)
    for k, pattern in enumerate(patterns):
        held = tuple(np.flatnonzero(pattern).tolist())
        if held not in sets:
            sets.append(held)
        number[k] = sets.index(held)
    return sets, number[which.ravel()]


def named_sides(mesh: QuadMesh) -> tuple[Index, dict[str, Index]]:
    """All element sides that have a name, each once, and where those of each group are in that list."""
    keys = {name: sides[:, 0] * 4 + sides[:, 1] for name, sides in mesh.edge_groups.items()}
    every = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *keys.values()]))
    return np.stack([every // 4, every % 4], axis=-1), {name: np.searchsorted(every, key) for name, key in keys.items()}


def boundary_sides(mesh: QuadMesh) -> Index:
    """Sides (element, side) that belong to one element only, shape (k, 2)."""
    ends = mesh.corners[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2)
    keys = ends.min(axis=1) * len(mesh.points) + ends.max(axis=1)
    _, first, uses = np.unique(keys, return_index=True, return_counts=True)
    single = np.sort(first[uses == 1])
    return np.stack([single // 4, single % 4], axis=-1)
