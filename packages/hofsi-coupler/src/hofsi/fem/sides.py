"""Element sides at the boundary of a mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh

Index = NDArray[np.int64]

__all__ = ["boundary_sides"]


def boundary_sides(mesh: QuadMesh) -> Index:
    """Element sides that belong to one element only, shape (k, 2): (element, side)."""
    pairs = np.sort(mesh.corners[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2), axis=1)
    _, inverse, counts = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    alone = np.flatnonzero(counts[inverse.ravel()] == 1)
    return np.stack([alone // 4, alone % 4], axis=-1)
