"""Curves: the geometry of block edges, maps t ∈ [0, 1] → (n, 2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import CurveError
from hoblock.reference import gauss_lobatto, lagrange

Array = NDArray[np.float64]

__all__ = ["Arc", "Curve", "Displaced", "NodalCurve", "Parametric", "Reversed", "reverse", "with_ends"]


class Curve(Protocol):
    """Geometry of a block edge, from its first vertex at t = 0 to its second at t = 1."""

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t`` of shape (n,), returned with shape (n, 2)."""
        ...


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


@dataclass(frozen=True)
class Parametric:
    """A curve given by a function of t that returns points of shape (n, 2)."""

    function: Callable[[Array], Array]

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        t = np.asarray(t, dtype=float)
        points = np.asarray(self.function(t), dtype=float)
        if points.shape != (*t.shape, 2):
            raise CurveError(
                f"parametric curve: returned shape {points.shape} for {t.shape[0]} parameters; "
                f"expected {(*t.shape, 2)}."
            )
        if not np.all(np.isfinite(points)):
            bad = t[~np.isfinite(points).all(axis=-1)][0]
            raise CurveError(f"parametric curve: not finite at t = {bad:g}.")
        return points


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
        points = np.asarray(self.points, dtype=float)
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

    def __call__(self, t: Array) -> Array:
        """Points at ``t``; the elements have equal parameter length."""
        scaled = np.asarray(t, dtype=float) * self.count
        element = np.clip(scaled.astype(int), 0, self.count - 1)
        values = lagrange(gauss_lobatto(self.order), 2.0 * (scaled - element) - 1.0)
        nodes = element[:, None] * self.order + np.arange(self.order + 1)
        return np.asarray((values[:, None, :] @ self.points[nodes])[:, 0, :])


@dataclass(frozen=True)
class Reversed:
    """A curve walked from the other end."""

    curve: Curve

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        return self.curve(1.0 - np.asarray(t, dtype=float))


def reverse(curve: Curve) -> Curve:
    """Return the curve walked from the other end; a nodal curve stays one."""
    if isinstance(curve, NodalCurve):
        return NodalCurve(curve.points[::-1], curve.order)
    return curve.curve if isinstance(curve, Reversed) else Reversed(curve)


def with_ends(curve: Curve, shifts: tuple[Array, Array], ends: tuple[Array, Array]) -> Curve:
    """Return a curve for an edge whose vertices have moved.

    An arc whose new ends lie on its circle is cut anew from the circle, so that a vertex can slide along it. Any other
    curve keeps its shape, with the displacement of the ends blended linearly along it.

    Parameters
    ----------
    curve : Curve
    shifts : pair of ndarray, shape (2,)
        Displacements of the ends.
    ends : pair of ndarray, shape (2,)
        New positions of the ends.
    """
    first, second = shifts
    if isinstance(curve, Displaced):  # keep one level of blending, however often the structure moves
        first, second = first + np.array(curve.first), second + np.array(curve.second)
        curve = curve.curve
    arc = curve.curve if isinstance(curve, Reversed) else curve
    if isinstance(arc, Arc):
        cut = arc.cut(*(ends if arc is curve else ends[::-1]))
        if cut is not None:
            return cut if arc is curve else Reversed(cut)
    return Displaced(curve, (float(first[0]), float(first[1])), (float(second[0]), float(second[1])))


@dataclass(frozen=True)
class Displaced:
    """A curve whose ends have moved: the displacement of the ends is blended linearly along it."""

    curve: Curve
    first: tuple[float, float]
    second: tuple[float, float]

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        t = np.asarray(t, dtype=float)[:, None]
        return np.asarray(self.curve(t[:, 0]) + (1.0 - t) * np.array(self.first) + t * np.array(self.second))
