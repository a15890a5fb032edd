"""Blocks that a motion has turned over."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["inverted_blocks"]


def inverted_blocks(topology: BlockTopology, vertices: Array, *, curved: Iterable[int] = ()) -> Index:
    """Blocks that are not valid bilinear quads: a corner with an angle of 180° or more, or vertices out of order.

    A quick look at the blocks before any element is made. It does not replace the bound of det J of the elements.

    Parameters
    ----------
    topology : BlockTopology
    vertices : ndarray, shape (n, 2)
    curved : iterable of int, optional
        Edges that are not straight. A corner at one of them is not judged, since its angle is not that of the chords.

    Returns
    -------
    ndarray
        Blocks with a corner whose cross product is not positive (or not finite), ascending.
    """
    corners = np.asarray(vertices, dtype=float)[topology.quads]
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    bent = np.isin(topology.block_edges, np.fromiter(curved, dtype=np.int64))
    straight = ~(bent | np.roll(bent, 1, axis=1))  # corner k lies between sides k - 1 and k
    return np.flatnonzero((~(cross > 0.0) & straight).any(axis=1))
