"""Curves given by an isoline of a function."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.isoline import STEEPEST, Branch, follow
from hoblock.curves.nearest import nearest_on_level_set
from hoblock.curves.strip import RELATIVE_STEP, Function, Strip, gradient_of, own_gradient, ratio, values_of
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["LevelSet"]

_ON = 1e-9  # distance from the isoline, in chord lengths, at which a vertex lies on it


@dataclass(frozen=True)
class LevelSet:
    """The isoline φ = level between two points on it, as a function of the position along their chord.

    The point at t lies on the chord's normal through ``first + t (second - first)``. The isoline is followed by
    continuity from one end to the other, so that other isolines within reach do no harm as long as it is clear which
    one leads from end to end. The points are converged to round-off; where φ is smooth, so is the curve.

    Parameters
    ----------
    function : callable
        φ, points (n, 2) to values (n,); must be finite in the strip that is searched. A field such as
        `hoblock.fields.GridField` will do.
    first, second : (float, float)
        Ends, on the isoline within 1e-9 of their distance; see `nearest_on_level_set`.
    level : float
    reach : float
        How far the isoline is searched on both sides of the chord, as a fraction of the chord's length.
    gradient : callable, optional
        Points (n, 2) to gradients (n, 2). By default the function's own method ``gradient``, if it has one, else
        central differences; they make Newton's method faster, not the curve more accurate.

    Raises
    ------
    CurveError
        At construction, if the arguments are impossible; at the first evaluation, if an end is not on the isoline, no
        isoline leads from end to end within reach, it is not clear which one, or the isoline turns back over the
        chord, with the place and a way out.
    """

    function: Function
    first: tuple[float, float]
    second: tuple[float, float]
    level: float = 0.0
    reach: float = 0.5
    gradient: Function | None = None

    def __post_init__(self) -> None:
        for name in ("first", "second"):
            point = np.asarray(getattr(self, name), dtype=float)
            if point.shape != (2,) or not np.isfinite(point).all():
                raise CurveError(f"level set: {name} is {point.tolist()}; expected two finite coordinates.")
            object.__setattr__(self, name, (float(point[0]), float(point[1])))
        if self.first == self.second:
            raise CurveError(f"{self._name}: both ends are the same point; expected two. Use more vertices.")
        for name, value in (("function", self.function), ("gradient", self.gradient)):
            if not callable(value) and not (name == "gradient" and value is None):
                raise CurveError(f"level set: {name} is {value!r}; expected a function of points (n, 2).")
        if not np.isfinite(self.level):
            raise CurveError(f"level set: level is {self.level}; expected a finite number.")
        if not (0.0 < self.reach < np.inf):
            raise CurveError(
                f"level set: reach is {self.reach}; expected a positive fraction of the chord's length, such as 0.5."
            )

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        t = np.asarray(t, dtype=float)
        branch = self._branch
        return branch.strip.points(t, branch.offsets(t))

    def cut(self, first: Array, second: Array) -> LevelSet | None:
        """Return the part of the isoline between other ends, or None if they are not on it."""
        ends = np.array([first, second], dtype=float)
        if not np.ptp(ends, axis=0).any():
            return None
        part = LevelSet(self.function, tuple(ends[0]), tuple(ends[1]), self.level, self.reach, self.gradient)
        strip = part._strip
        return part if (part._distance(ends, strip.length) <= _allowed(strip)).all() else None

    def distance(self, points: Array) -> Array:
        """Distance of points (n, 2) from the isoline to first order, the modulus of (φ - level)/∇φ, shape (n,)."""
        return self._distance(np.asarray(points, dtype=float), self._strip.length)

    def _distance(self, points: Array, size: float) -> Array:
        value = values_of(self.function, points, self._name) - self.level
        slope = gradient_of(
            self.function, own_gradient(self.function, self.gradient), points, RELATIVE_STEP * size, self._name
        )
        return ratio(np.abs(value), np.hypot(slope[:, 0], slope[:, 1]))

    @property
    def _name(self) -> str:
        (a, b), (c, d) = self.first, self.second
        return f"level set from ({a:.6g}, {b:.6g}) to ({c:.6g}, {d:.6g})"

    @cached_property
    def _strip(self) -> Strip:
        gradient = own_gradient(self.function, self.gradient)
        return Strip(self.function, gradient, self.level, self.first, self.second, self._name)

    @cached_property
    def _branch(self) -> Branch:
        _check_ends(self._strip)
        return follow(self._strip, self.reach)


def _allowed(strip: Strip) -> float:
    return strip.length * (_ON + 16.0 * strip.rounding)


def _check_ends(strip: Strip) -> None:
    """Both ends lie on the isoline, and it leaves them along the chord rather than across."""
    t, s = np.array([0.0, 1.0]), np.zeros(2)
    value = strip.values(t, s)
    along, across = strip.derivatives(t, s)
    distance = strip.length * ratio(np.abs(value), np.hypot(along, across))
    for which, point, d, a, b in zip(("first", "second"), strip.points(t, s), distance, along, across, strict=True):
        where = f"({point[0]:.6g}, {point[1]:.6g})"
        if np.isinf(d):
            raise CurveError(
                f"{strip.name}: the {which} vertex {where} is not on the isoline, and the function's gradient vanishes "
                f"there{_nearest(strip, point)}; expected a vertex within {_allowed(strip):.2g} of the isoline. Move "
                "the vertex, and check the function and its level."
            )
        if not d <= _allowed(strip):
            raise CurveError(
                f"{strip.name}: the {which} vertex {where} is {d:.3g} away from the isoline{_nearest(strip, point)}; "
                f"expected at most {_allowed(strip):.2g}. Move the vertex there, or let it be moved (project = true in "
                "a scene, nearest_on_level_set in Python)."
            )
        if a == b == 0.0:
            raise CurveError(
                f"{strip.name}: the function's gradient vanishes at the {which} vertex {where}; expected a function "
                "that crosses the level with a slope."
            )
        if abs(a) > STEEPEST * abs(b):
            raise CurveError(
                f"{strip.name}: the isoline runs along the chord's normal at the {which} vertex {where}, so it is no "
                "function of the position along the chord. Split the edge with more vertices on the isoline."
            )


def _nearest(strip: Strip, point: Array) -> str:
    """Where the vertex ought to be, for the message, if that can be found."""
    try:
        x = nearest_on_level_set(
            strip.function, point[None, :], level=strip.level, reach=strip.length, gradient=strip.gradient
        )[0]
    except CurveError:
        return ""
    return f" (nearest point: ({x[0]:.12g}, {x[1]:.12g}))"
