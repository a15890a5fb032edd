"""Arcs of ellipses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Ellipse"]

_ON_IT = 1e-9


@dataclass(frozen=True)
class Ellipse:
    """Arc of an ellipse, x(θ) = c + R(rotation) (a cos θ, b sin θ), with θ from ``start`` to ``start + opening``.

    Parameters
    ----------
    center : (float, float)
        c.
    radii : (float, float)
        a and b, positive.
    rotation : float
        Angle of the first axis from the x-axis, in radians.
    start, opening : float
        Angle θ at t = 0 (the eccentric anomaly) and its signed change, in radians.
    """

    center: tuple[float, float]
    radii: tuple[float, float]
    rotation: float
    start: float
    opening: float

    def __post_init__(self) -> None:
        numbers = np.array([*self.center, *self.radii, self.rotation, self.start, self.opening], dtype=float)
        if not np.isfinite(numbers).all() or min(self.radii) <= 0.0:
            raise CurveError(
                f"ellipse about ({self.center[0]:g}, {self.center[1]:g}): radii {self.radii[0]:g} and "
                f"{self.radii[1]:g}; expected positive radii, and all numbers finite."
            )
        if not 0.0 < abs(self.opening) <= 2.0 * np.pi:
            raise CurveError(
                f"ellipse about ({self.center[0]:g}, {self.center[1]:g}): opening angle {self.opening:g}; expected one "
                "between -2 pi and 2 pi that is not zero."
            )

    @staticmethod
    def from_center(
        center: tuple[float, float],
        radii: tuple[float, float],
        rotation: float,
        first: ArrayLike,
        second: ArrayLike,
        *,
        long_way: bool = False,
    ) -> Ellipse:
        """Return the arc between two points of an ellipse.

        Parameters
        ----------
        center, radii, rotation
            As of the class.
        first, second : array_like, shape (2,)
        long_way : bool
            Take the longer of the two arcs, by the change of θ.

        Raises
        ------
        CurveError
            If a point is not on the ellipse, both coincide, or both arcs are equally long.
        """
        whole = Ellipse(center, radii, rotation, 0.0, 2.0 * np.pi)
        start, stop = (whole._angle(np.asarray(point, dtype=float)) for point in (first, second))
        opening = (stop - start + np.pi) % (2.0 * np.pi) - np.pi
        if abs(abs(opening) - np.pi) < _ON_IT or abs(opening) < _ON_IT:
            what = "coincide" if abs(opening) < _ON_IT else "lie opposite each other, so two arcs fit"
            raise CurveError(
                f"ellipse about ({center[0]:g}, {center[1]:g}): the end points {what}. Split the edge by a vertex."
            )
        if long_way:
            opening -= np.copysign(2.0 * np.pi, opening)
        return Ellipse(whole.center, whole.radii, whole.rotation, start, opening)

    def _angle(self, point: Array) -> float:
        """Angle θ of a point of the ellipse."""
        c, s = np.cos(self.rotation), np.sin(self.rotation)
        x, y = point - np.array(self.center)
        local = np.array([c * x + s * y, c * y - s * x]) / np.array(self.radii)
        rounding = 16.0 * np.finfo(float).eps * float(np.abs(point).max()) / min(self.radii)
        if not abs(float(np.hypot(*local)) - 1.0) <= _ON_IT + rounding:
            raise CurveError(
                f"ellipse about ({self.center[0]:g}, {self.center[1]:g}): the point ({point[0]:.9g}, {point[1]:.9g}) "
                f"is at {float(np.hypot(*local)):.9g} of the radius in its direction; expected 1. "
                "Move the vertex or change centre, radii or rotation."
            )
        return float(np.arctan2(local[1], local[0]))

    def cut(self, first: Array, second: Array) -> Ellipse | None:
        """Return the arc of the same ellipse between ends near the present ones, or None if they are not on it."""
        try:
            angles = np.array([self._angle(first), self._angle(second)])
        except CurveError:
            return None
        turned = angles - (self.start, self.start + self.opening)
        turned -= 2.0 * np.pi * np.round(turned / (2.0 * np.pi))  # the nearer way round
        opening = self.opening + float(turned[1] - turned[0])
        if opening * self.opening <= 0.0 or abs(opening) > 2.0 * np.pi:
            return None
        return Ellipse(self.center, self.radii, self.rotation, self.start + float(turned[0]), opening)

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``, equal steps of θ."""
        angle = self.start + self.opening * np.asarray(t, dtype=float)
        x, y = self.radii[0] * np.cos(angle), self.radii[1] * np.sin(angle)
        c, s = np.cos(self.rotation), np.sin(self.rotation)
        return np.stack([self.center[0] + c * x - s * y, self.center[1] + s * x + c * y], axis=-1)
