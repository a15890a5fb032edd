"""B-spline and NURBS curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.control_points import plane_points, positive_weights
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["BSpline", "Nurbs"]


@dataclass(frozen=True, eq=False)
class Nurbs:
    """Non-uniform rational B-spline.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Control points.
    weights : array_like, shape (n,), optional
        Positive weights; equal ones if left out, which makes a B-spline.
    degree : int
        Degree d, from 1 to n - 1.
    knots : array_like, shape (n + d + 1,), optional
        Non-decreasing. The curve runs over the knots from number d to number n (from 0), mapped to [0, 1]. If left
        out: equally spaced, d + 1 times at both ends, so that the curve begins and ends at control points.

    References
    ----------
    Piegl & Tiller: The NURBS Book, 2nd edition, Springer 1997, Eqs. (3.1) and (4.1).
    """

    points: Array
    weights: Array | None = None
    degree: int = 3
    knots: Array | None = None

    def __post_init__(self) -> None:
        points = plane_points(self.points, self._kind, 2)
        count = len(points)
        if isinstance(self.degree, bool) or not isinstance(self.degree, int | np.integer):
            raise CurveError(f"{self._kind}: degree is {self.degree!r}; expected an integer.")
        if not 1 <= self.degree < count:
            raise CurveError(
                f"{self._kind}: degree {self.degree} with {count} control points; expected a degree from 1 to "
                f"{count - 1}. Lower the degree or add points."
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "weights", positive_weights(self.weights, count, self._kind))
        object.__setattr__(self, "knots", _knots(self.knots, count, int(self.degree), self._kind))

    @property
    def _kind(self) -> str:
        return "NURBS"

    @cached_property
    def _spline(self) -> Any:
        from scipy import interpolate

        weights = np.ones(len(self.points)) if self.weights is None else self.weights
        homogeneous = np.concatenate([weights[:, None] * self.points, weights[:, None]], axis=1)
        return interpolate.BSpline(self.knots, homogeneous, int(self.degree))

    @cached_property
    def breaks(self) -> Array:
        """Parameters of the inner knots."""
        knots = np.asarray(self.knots)
        low, high = knots[self.degree], knots[-self.degree - 1]
        t = (np.unique(knots) - low) / (high - low)
        return np.asarray(t[(t > 0.0) & (t < 1.0)])

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        knots = np.asarray(self.knots)
        low, high = knots[self.degree], knots[-self.degree - 1]
        t = np.asarray(t, dtype=float)
        values = np.asarray(self._spline((1.0 - t) * low + t * high))
        return np.asarray(values[:, :2] / values[:, 2:])


class BSpline(Nurbs):
    """B-spline: `Nurbs` without weights.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Control points.
    degree : int
    knots : array_like, optional
        As of `Nurbs`.
    """

    def __init__(self, points: Array, degree: int = 3, knots: Array | None = None) -> None:
        super().__init__(points, None, degree, knots)

    @property
    def _kind(self) -> str:
        return "B-spline"


def _knots(knots: Array | None, count: int, degree: int, kind: str) -> Array:
    """Return the knots, checked, or equally spaced ones."""
    if knots is None:
        inner = np.linspace(0.0, 1.0, count - degree + 1)
        array = np.concatenate([np.zeros(degree), inner, np.ones(degree)])
    else:
        array = np.array(knots, dtype=float)
    if array.shape != (count + degree + 1,):
        raise CurveError(
            f"{kind}: {array.size} knots; expected {count + degree + 1}, the number of control points {count} plus the "
            f"degree {degree} plus 1."
        )
    if not np.isfinite(array).all() or (np.diff(array) < 0.0).any():
        k = int(np.argmin(np.where(np.isfinite(np.diff(array)), np.diff(array), -np.inf)))
        raise CurveError(
            f"{kind}: knots[{k}] is {array[k]:g} and knots[{k + 1}] is {array[k + 1]:g}; expected finite numbers that "
            "do not decrease."
        )
    inside = array[degree : count + 1]
    _, times = np.unique(array[(array > inside[0]) & (array < inside[-1])], return_counts=True)
    if inside[0] == inside[-1] or (times > degree).any():
        raise CurveError(
            f"{kind}: knots {array.tolist()} make a curve that is empty or breaks apart; expected no inner knot more "
            f"than {degree} times."
        )
    array.setflags(write=False)
    return array
