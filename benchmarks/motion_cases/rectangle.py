"""Rectangles: the bodies that move and the boxes around them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Rectangle"]


@dataclass(frozen=True)
class Rectangle:
    """A rectangle along the axes."""

    left: float
    bottom: float
    right: float
    top: float

    @staticmethod
    def centered(width: float, height: float) -> Rectangle:
        """Rectangle about the origin."""
        return Rectangle(-0.5 * width, -0.5 * height, 0.5 * width, 0.5 * height)

    @property
    def corners(self) -> Array:
        """Corners counter-clockwise from the lower left one, shape (4, 2)."""
        low, high = (self.left, self.bottom), (self.right, self.top)
        return np.array([low, (high[0], low[1]), high, (low[0], high[1])])

    def cut(self, parts: Sequence[int]) -> Array:
        """Points counter-clockwise from the lower left corner, the bottom, right, top and left cut in equal parts."""
        corners = self.corners
        sides = zip(corners, np.roll(corners, -1, axis=0), parts, strict=True)
        return np.concatenate([a + np.arange(n)[:, None] / n * (b - a) for a, b, n in sides])

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Whether points, shape (..., 2), lie within or on the sides."""
        return np.asarray((self._depth(points) > -self._tolerance).all(axis=-1))

    def edges(self, structure: BlockStructure) -> Index:
        """Boundary edges of a structure with both ends in the rectangle."""
        topology = structure.topology
        inside = self.contains(structure.vertices)[topology.edges].all(axis=1)
        return np.flatnonzero(inside & (topology.blocks_per_edge == 1)).astype(np.int64)

    def side_vertices(self, structure: BlockStructure) -> Index:
        """Vertices of a structure on one side; those on two, the corners, are left out."""
        sides = (np.abs(self._depth(structure.vertices)) < self._tolerance).sum(axis=-1)
        return np.flatnonzero(sides == 1).astype(np.int64)

    def _depth(self, points: Array) -> Array:
        """Signed distances from left, bottom, right and top, positive inside, shape (..., 4)."""
        low, high = self.corners[0], self.corners[2]
        return np.concatenate([points - low, high - points], axis=-1)

    @property
    def _tolerance(self) -> float:
        return 1e-9 * float(np.ptp(self.corners))
