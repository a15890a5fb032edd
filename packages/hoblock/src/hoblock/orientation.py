"""Directions of block edges such that opposite edges of every block are parallel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import TopologyError

Index = NDArray[np.int64]

__all__ = ["orient"]


def orient(quads: Index, names: Sequence[str]) -> tuple[Index, Index, Index, Index]:
    """Direct the edges of conforming quads and find their chains.

    Parameters
    ----------
    quads : ndarray, shape (b, 4)
        Vertices, counter-clockwise.
    names : sequence of str
        Vertex names, for messages.

    Returns
    -------
    edges : ndarray, shape (m, 2)
        Directed edges.
    block_edges : ndarray, shape (b, 4)
        Edges of the *rotated* blocks: bottom, right, top, left.
    chains : ndarray, shape (m,)
        Chain of each edge, numbered by first appearance.
    rotation : ndarray, shape (b,)
        By how many places each quad is rotated so that both edges leave its first vertex.

    Raises
    ------
    TopologyError
        If an edge belongs to more than two blocks, or two blocks lie on the same side of it. (These make
        the surface orientable, so that no chain can meet itself in the other direction.)

    References
    ----------
    Homolya & Ham, SIAM J. Sci. Comput. 38 (2016) S48–S61, doi:10.1137/15M1021325.
    """
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    pairs, edge_of_side = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    edge_of_side = edge_of_side.reshape(-1, 4)
    forward = (sides[:, 0] < sides[:, 1]).reshape(-1, 4)
    _check_neighbours(quads, pairs, edge_of_side, forward, names)

    blocks_of_edge: list[list[tuple[int, int]]] = [[] for _ in pairs]
    for block, row in enumerate(edge_of_side):
        for side, edge in enumerate(row):
            blocks_of_edge[edge].append((block, side))

    chains = np.full(len(pairs), -1)
    positive = np.zeros(len(pairs), dtype=bool)  # runs from the smaller to the larger vertex number
    count = 0
    for seed in edge_of_side.ravel():
        if chains[seed] >= 0:
            continue
        block, side = blocks_of_edge[seed][0]
        # Start along the block as the user wrote it: sides 0 and 1 forwards, 2 and 3 backwards.
        chains[seed], positive[seed] = count, forward[block, side] == (side < 2)
        stack = [int(seed)]
        while stack:
            edge = stack.pop()
            for block, side in blocks_of_edge[edge]:
                opposite = (side + 2) % 4
                other = int(edge_of_side[block, opposite])
                # Counter-clockwise sides of a quad are antiparallel.
                direction = bool(positive[edge] ^ forward[block, side] ^ forward[block, opposite] ^ True)
                if chains[other] < 0:
                    chains[other], positive[other] = count, direction
                    stack.append(other)
        count += 1
    edges = np.where(positive[:, None], pairs, pairs[:, ::-1])
    along = positive[edge_of_side] == forward  # side directed counter-clockwise
    # The first vertex is the one both of whose edges leave it: side k along, side k - 1 against.
    rotation = np.argmax(along & ~np.roll(along, 1, axis=1), axis=1)
    block_edges = np.take_along_axis(edge_of_side, (np.arange(4) + rotation[:, None]) % 4, axis=1)
    return edges, block_edges, chains, rotation


def _check_neighbours(
    quads: Index, pairs: Index, edge_of_side: Index, forward: NDArray[np.bool_], names: Sequence[str]
) -> None:
    uses = np.bincount(edge_of_side.ravel(), minlength=len(pairs))
    both = np.bincount(edge_of_side.ravel(), weights=forward.ravel(), minlength=len(pairs))
    bad = np.flatnonzero((uses > 2) | ((uses == 2) & (both != 1)))
    if not bad.size:
        return
    edge = int(bad[0])
    blocks = [int(b) for b in np.flatnonzero((edge_of_side == edge).any(axis=1))]
    what = "belongs to more than two blocks" if uses[edge] > 2 else "has two blocks on the same side"
    raise TopologyError(
        f"edge {names[pairs[edge][0]]}–{names[pairs[edge][1]]} {what}: blocks {', '.join(map(str, blocks))} "
        f"({'; '.join(','.join(names[v] for v in quads[b]) for b in blocks)}). Blocks must not overlap."
    )
