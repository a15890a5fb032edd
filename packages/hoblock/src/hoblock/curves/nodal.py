"""Curves given by the nodes of elements, as a simulation computes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import CurveError
from hoblock.reference import gauss_lobatto, lagrange

Array = NDArray[np.float64]

__all__ = ["NodalCurve"]


@dataclass(frozen=True, eq=False)
class NodalCurve:
    """A curve given by its element nodes: piecewise polynomials of one order, GLL nodes.

    This is how an interface edge takes the result of a simulation. A mesh of the same order and count takes the nodes
    as they are, whatever the edge's grading.

    Parameters
    ----------
    points : ndarray, shape (n p + 1, 2)
        Nodes of n elements of order p, in the direction of the edge.
    order : int
        The order p.
    """

    points: Array
    order: int

    def __post_init__(self) -> None:
        if self.order < 1:
            raise CurveError(f"nodal curve: order is {self.order}; expected an integer >= 1.")
        points = np.array(self.points, dtype=float)
        points.setflags(write=False)
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or (len(points) - 1) % self.order:
            raise CurveError(
                f"nodal curve: points have shape {points.shape}; expected (n*{self.order} + 1, 2) for n elements."
            )
        if not np.isfinite(points).all():
            bad = int(np.argmin(np.isfinite(points).all(axis=1)))
            raise CurveError(f"nodal curve: points[{bad}] is {points[bad].tolist()}; expected finite coordinates.")
        object.__setattr__(self, "points", points)

    @property
    def count(self) -> int:
        """Number of elements."""
        return (len(self.points) - 1) // self.order

    @property
    def breaks(self) -> Array:
        """Parameters of the corners between elements."""
        return np.arange(1, self.count) / self.count

    def __call__(self, t: Array) -> Array:
        """Points at ``t``; the elements have equal parameter length."""
        scaled = np.asarray(t, dtype=float) * self.count
        element = np.clip(scaled.astype(int), 0, self.count - 1)
        values = lagrange(gauss_lobatto(self.order), 2.0 * (scaled - element) - 1.0)
        nodes = element[:, None] * self.order + np.arange(self.order + 1)
        return np.asarray((values[:, None, :] @ self.points[nodes])[:, 0, :])
