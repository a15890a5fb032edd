"""Circular arcs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Arc"]


@dataclass(frozen=True)
class Arc:
    """Circular arc: centre, radius, angle at t = 0 and signed opening angle, in radians.

    Parameters
    ----------
    center : (float, float)
    radius : float
        Positive.
    start, opening : float
        Angle at t = 0 and its change, positive counter-clockwise, at most a full turn.
    """

    center: tuple[float, float]
    radius: float
    start: float
    opening: float

    def __post_init__(self) -> None:
        place = f"arc about {tuple(self.center)}"
        if np.shape(self.center) != (2,) or not np.isfinite([*self.center, self.radius, self.start]).all():
            raise CurveError(f"{place}: radius {self.radius}, start {self.start}; expected finite numbers.")
        if not self.radius > 0.0:
            raise CurveError(f"{place}: radius {self.radius:g}; expected a positive one.")
        if not 0.0 < abs(self.opening) <= 2.0 * np.pi * (1.0 + 1e-12):
            raise CurveError(
                f"{place}: opening angle {self.opening:g}; expected one between -2 pi and 2 pi that is not zero."
            )

    @staticmethod
    def from_center(center: tuple[float, float], first: ArrayLike, second: ArrayLike) -> Arc:
        """Return the shorter arc about ``center`` from one point to the other.

        Raises
        ------
        CurveError
            If the points are at different distances from the centre, coincide with it, or are diametrically opposite.
        """
        c = np.asarray(center, dtype=float)
        a, b = np.asarray(first, dtype=float) - c, np.asarray(second, dtype=float) - c
        ra, rb = float(np.hypot(*a)), float(np.hypot(*b))
        rounding = 8.0 * np.finfo(float).eps * float(np.abs([c, c + a, c + b]).max())  # far from the origin
        if min(ra, rb) == 0.0 or abs(ra - rb) > 1e-9 * max(ra, rb) + rounding:
            raise CurveError(
                f"arc about ({c[0]:g}, {c[1]:g}): the end points are {ra:.12g} and {rb:.12g} away from the centre; "
                "the distances must be equal and positive. Move a vertex or the centre."
            )
        opening = float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))
        if abs(abs(opening) - np.pi) < 1e-9:
            raise CurveError(
                f"arc about ({c[0]:g}, {c[1]:g}): the end points lie opposite each other, so two arcs fit. "
                "Give a third point (through) instead of the centre."
            )
        return Arc((float(c[0]), float(c[1])), ra, float(np.arctan2(a[1], a[0])), opening)

    @staticmethod
    def with_angle(first: ArrayLike, second: ArrayLike, angle: float) -> Arc:
        """Return the arc from one point to another that turns by an angle.

        Parameters
        ----------
        first, second : array_like, shape (2,)
        angle : float
            Opening angle in radians, between -2 pi and 2 pi, not zero; positive counter-clockwise about the centre.

        Raises
        ------
        CurveError
            If there is no such angle, or the points coincide.
        """
        a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
        if not 0.0 < abs(angle) < 2.0 * np.pi:
            raise CurveError(
                f"arc of angle {angle:g}: expected an angle in radians between -2 pi and 2 pi that is not zero. "
                "Leave the curve out for a straight edge."
            )
        chord = b - a
        length = float(np.hypot(*chord))
        if length == 0.0:
            raise CurveError(f"arc of angle {angle:g}: both end points are ({a[0]:g}, {a[1]:g}). Move a vertex.")
        height = 0.5 / np.tan(0.5 * angle)  # of the centre above the chord, to its left, in chords
        center = 0.5 * (a + b) + height * np.array([-chord[1], chord[0]])
        start = a - center
        radius = 0.5 * length / abs(np.sin(0.5 * angle))
        return Arc((float(center[0]), float(center[1])), float(radius), float(np.arctan2(start[1], start[0])), angle)

    @staticmethod
    def through(first: ArrayLike, middle: ArrayLike, second: ArrayLike) -> Arc:
        """Return the arc from ``first`` through ``middle`` to ``second``.

        Raises
        ------
        CurveError
            If the three points lie on a line.
        """
        a, m, b = (np.asarray(point, dtype=float) for point in (first, middle, second))
        p, q = m - a, b - a
        cross = p[0] * q[1] - p[1] * q[0]
        if abs(cross) <= 1e-12 * max(float(p @ p), float(q @ q)):
            raise CurveError(f"arc through ({m[0]:g}, {m[1]:g}): the three points lie on a line. Leave the curve out.")
        offset = np.array([q[1] * (p @ p) - p[1] * (q @ q), p[0] * (q @ q) - q[0] * (p @ p)]) / (2.0 * cross)
        center = a + offset
        radius = float(np.hypot(*offset))
        start, stop = (float(np.arctan2(*(point - center)[::-1])) for point in (a, b))
        # The arc runs counter-clockwise exactly if `middle` is right of the chord.
        opening = (stop - start) % (2.0 * np.pi) if cross > 0.0 else -((start - stop) % (2.0 * np.pi))
        return Arc((float(center[0]), float(center[1])), radius, start, opening)

    def cut(self, first: Array, second: Array) -> Arc | None:
        """Return the arc of the same circle between ends near the present ones, or None if they are not on it."""
        offsets = np.stack([first, second]) - np.array(self.center)
        if np.abs(np.hypot(offsets[:, 0], offsets[:, 1]) - self.radius).max() > 1e-9 * self.radius:
            return None
        angles = np.arctan2(offsets[:, 1], offsets[:, 0])
        turned = angles - (self.start, self.start + self.opening)
        turned -= 2.0 * np.pi * np.round(turned / (2.0 * np.pi))  # the nearer way round
        opening = self.opening + float(turned[1] - turned[0])
        if opening * self.opening <= 0.0 or abs(opening) > 2.0 * np.pi:
            return None
        return Arc(self.center, self.radius, self.start + float(turned[0]), opening)

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        angle = self.start + self.opening * np.asarray(t, dtype=float)
        return np.stack(
            [self.center[0] + self.radius * np.cos(angle), self.center[1] + self.radius * np.sin(angle)], axis=-1
        )
