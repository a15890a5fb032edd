"""Circular arcs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Arc"]


@dataclass(frozen=True)
class Arc:
    """Circular arc: centre, radius, angle at t = 0 and signed opening angle, in radians."""

    center: tuple[float, float]
    radius: float
    start: float
    opening: float

    @staticmethod
    def from_center(center: tuple[float, float], first: Array, second: Array) -> Arc:
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
    def through(first: Array, middle: Array, second: Array) -> Arc:
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
        if opening * self.opening <= 0.0:
            return None
        return Arc(self.center, self.radius, self.start + float(turned[0]), opening)

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        angle = self.start + self.opening * np.asarray(t, dtype=float)
        return np.stack(
            [self.center[0] + self.radius * np.cos(angle), self.center[1] + self.radius * np.sin(angle)], axis=-1
        )
