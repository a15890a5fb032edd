"""Bézier curves, polynomial and rational."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.control_points import plane_points, positive_weights

Array = NDArray[np.float64]

__all__ = ["Bezier"]


@dataclass(frozen=True, eq=False)
class Bezier:
    """Bézier curve of any degree, rational if it has weights.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Control points; the first and the last are the ends.
    weights : array_like, shape (n,), optional
        Positive weights of the control points.

    References
    ----------
    Farin: Curves and Surfaces for CAGD, 5th edition, Morgan Kaufmann 2002, Sections 4.2 and 13.2.
    """

    points: Array
    weights: Array | None = None

    def __post_init__(self) -> None:
        points = plane_points(self.points, "Bézier curve", 2)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "weights", positive_weights(self.weights, len(points), "Bézier curve"))

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``, by de Casteljau's algorithm."""
        t = np.asarray(t, dtype=float)[None, :, None]
        weights = np.ones(len(self.points)) if self.weights is None else self.weights
        levels = np.concatenate([weights[:, None] * self.points, weights[:, None]], axis=1)[:, None, :]
        while len(levels) > 1:
            levels = (1.0 - t) * levels[:-1] + t * levels[1:]
        return np.asarray(levels[0][:, :2] / levels[0][:, 2:])
