"""Parts of block structures: some blocks with their edges, curves, gradings, numbers of elements and names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import TopologyError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["blocks_where", "extracted"]


def extracted(structure: BlockStructure, blocks: Iterable[int | str] | str) -> BlockStructure:
    """Return the part of a structure made of some blocks.

    Edges keep their direction, curves, gradings, names and numbers of elements; names without a block or an edge in
    the part are left out.

    Parameters
    ----------
    structure : BlockStructure
    blocks : sequence of int or str
        Numbers of blocks, names of groups of blocks, or both. See `blocks_where` to choose by place.

    Raises
    ------
    TopologyError
        If there are none, or one does not exist.
    """
    topology = structure.topology
    wanted: list[int] = []
    for block in (blocks,) if isinstance(blocks, str) else blocks:
        if isinstance(block, str):
            wanted.extend(topology.blocks_in(block).tolist())
        else:
            wanted.append(topology.block(block))
    if not wanted:
        raise TopologyError(f"extracted: no blocks; expected numbers from 0 to {len(topology.quads) - 1} or names.")
    return structure.part(np.unique(wanted))


def blocks_where(structure: BlockStructure, predicate: Callable[[Array, Array], Sequence[bool] | Array]) -> Index:
    """Return the blocks whose centre is at certain places.

    Parameters
    ----------
    structure : BlockStructure
    predicate : callable
        Function of arrays x and y, shape (b,): means of the four vertices of each block. Returns a
        truth value for each.

    Returns
    -------
    ndarray
        Numbers of blocks, ascending; maybe none.

    Raises
    ------
    ValueError
        If the predicate returns another shape.
    """
    x, y = structure.vertices[structure.topology.quads].mean(axis=1).T
    chosen = np.asarray(predicate(x, y))
    if chosen.shape != x.shape:
        raise ValueError(f"blocks_where: the predicate returned shape {chosen.shape} for {x.shape}; use & and |.")
    return np.flatnonzero(chosen)
