"""What every mover of all nodes of a mesh offers."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FullMeshMover"]


class FullMeshMover(Protocol):
    """Places all nodes of a mesh of order p when those on a moving body are given.

    Movers are made as ``Class(mesh, moving, fixed, ...)`` from a reference mesh, ascending node numbers on the moving
    body and ascending node numbers on the rest of the boundary, which stay. They hold no state. One-step methods start
    from the reference, so that one position has one mesh; incremental ones start from the last accepted state.
    """

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions, shape (n, 2).

        Parameters
        ----------
        current : ndarray, shape (n, 2)
            Node positions of the last accepted state; ignored by one-step methods.
        positions : ndarray, shape (len(moving), 2)
            Positions of the moving nodes; the result has exactly these.

        Raises
        ------
        MotionFailed
            If there is no mesh for these positions. Elements of a mesh that is returned may be turned over.
        ValueError
            If an argument has another shape or is not finite.
        """
        ...
