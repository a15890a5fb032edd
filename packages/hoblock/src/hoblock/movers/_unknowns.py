"""Unknowns of movers: x and y of free vertices, then the coordinates of sliding ones on their paths."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["chain_rule"]


def chain_rule(free: Index, sliding: Index, tangents: Array, count: int) -> Any:
    """Derivative of x and y of some vertices by the unknowns, sparse, shape (2 count, unknowns).

    Parameters
    ----------
    free, sliding : ndarray
        Places of the free and the sliding vertices among them.
    tangents : ndarray, shape (len(sliding), 2)
        Derivatives of the sliding ones by their coordinates.
    count : int
        Number of vertices.
    """
    from scipy.sparse import csr_matrix

    split = 2 * len(free)
    rows = np.concatenate([(2 * free[:, None] + [0, 1]).ravel(), (2 * sliding[:, None] + [0, 1]).ravel()])
    columns = np.concatenate([np.arange(split), split + np.repeat(np.arange(len(sliding)), 2)])
    values = np.concatenate([np.ones(split), tangents.ravel()])
    return csr_matrix((values, (rows, columns)), shape=(2 * count, split + len(sliding)))
