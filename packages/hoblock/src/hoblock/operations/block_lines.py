"""Straight lines of a block's coordinates (u, v), mapped to the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve

Array = NDArray[np.float64]

__all__ = ["BlockLine", "block_line"]


@dataclass(frozen=True, eq=False)
class BlockLine:
    """The image of a straight line in (u, v) under the transfinite map of a block.

    Parameters
    ----------
    sides : tuple of (Curve or None)
        Bottom, right, top, left; None if straight.
    corners : ndarray, shape (4, 2)
        Counter-clockwise.
    start, stop : (float, float)
        Ends of the line.

    References
    ----------
    Gordon & Hall, Int. J. Numer. Meth. Engng 7 (1973) 461–477, doi:10.1002/nme.1620070405.
    """

    sides: tuple[Curve | None, Curve | None, Curve | None, Curve | None]
    corners: Array
    start: tuple[float, float]
    stop: tuple[float, float]

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        t = np.asarray(t, dtype=float)
        u, v = ((1.0 - t) * a + t * b for a, b in zip(self.start, self.stop, strict=True))
        a, b, c, d = self.corners
        points = (
            np.outer((1 - u) * (1 - v), a) + np.outer(u * (1 - v), b) + np.outer(u * v, c) + np.outer((1 - u) * v, d)
        )
        for curve, weight, along in zip(self.sides, (1 - v, u, v, 1 - u), (u, v, u, v), strict=True):
            if curve is not None:
                ends = np.asarray(curve(np.array([0.0, 1.0])), dtype=float)
                chord = np.outer(1 - along, ends[0]) + np.outer(along, ends[1])
                points += weight[:, None] * (curve(along) - chord)
        return np.asarray(points)


def block_line(
    structure: BlockStructure, block: int, start: tuple[float, float], stop: tuple[float, float]
) -> BlockLine:
    """Return the image of the line from ``start`` to ``stop`` in the coordinates (u, v) of a block."""
    topology = structure.topology
    bottom, right, top, left = (structure.curves.get(side) for side in topology.block_edges[block].tolist())
    corners = structure.vertices[topology.quads[block]]
    return BlockLine((bottom, right, top, left), corners, start, stop)
