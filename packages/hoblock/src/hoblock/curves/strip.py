"""A function in the strip along a chord, in the chord's own coordinates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import CurveError, FieldError

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Function = Callable[[Array], Array]

__all__ = ["RELATIVE_STEP", "Function", "Strip", "gradient_of", "own_gradient", "ratio", "values_of"]

RELATIVE_STEP = float(np.finfo(float).eps) ** (1.0 / 3.0)
"""Step of central differences whose truncation equals their round-off, relative to the size of things."""


@dataclass(frozen=True)
class Strip:
    """A function φ - level at (t, s): t along the chord, s along its left normal, both in chord lengths.

    Attributes
    ----------
    function : callable
        φ, points (n, 2) to values (n,).
    gradient : callable or None
        Points (n, 2) to gradients (n, 2); None for central differences.
    level : float
    first, second : (float, float)
        Ends of the chord.
    name : str
        What the chord is, for messages.
    """

    function: Function
    gradient: Function | None
    level: float
    first: tuple[float, float]
    second: tuple[float, float]
    name: str

    @property
    def chord(self) -> Array:
        """From the first end to the second, shape (2,)."""
        return np.subtract(self.second, self.first)

    @property
    def length(self) -> float:
        """Length of the chord."""
        return float(np.hypot(*self.chord))

    @property
    def rounding(self) -> float:
        """Round-off of positions, in chord lengths."""
        largest = float(np.abs([self.first, self.second]).max())
        return float(np.finfo(float).eps) * max(1.0, largest / self.length)

    def points(self, t: Array, s: Array) -> Array:
        """Positions, shape (n, 2)."""
        (x, y), (dx, dy) = self.first, self.chord
        return np.stack([x + t * dx - s * dy, y + t * dy + s * dx], axis=-1)

    def values(self, t: Array, s: Array) -> Array:
        """φ - level, shape (n,).

        Raises
        ------
        CurveError
            If φ is not finite somewhere, has another shape, or cannot be evaluated there.
        """
        points = self.points(t, s)
        try:
            return values_of(self.function, points, self.name) - self.level
        except FieldError as error:
            raise CurveError(f"{self.name}: {error} Or choose a smaller reach.") from error

    def derivatives(self, t: Array, s: Array) -> tuple[Array, Array]:
        """Derivatives of φ by t and s, each (n,)."""
        (dx, dy), x = self.chord, self.points(t, s)
        try:
            g = gradient_of(self.function, self.gradient, x, RELATIVE_STEP * self.length, self.name)
        except FieldError as error:
            raise CurveError(f"{self.name}: {error} Or choose a smaller reach.") from error
        return g[:, 0] * dx + g[:, 1] * dy, g[:, 1] * dx - g[:, 0] * dy

    def value_and_slope(self, t: Array, s: Array) -> tuple[Array, Array]:
        """φ - level and its derivative by s, each (n,); without a gradient in one call of φ."""
        if self.gradient is not None:
            return self.values(t, s), self.derivatives(t, s)[1]
        value, above, below = self.values(
            np.tile(t, 3), np.concatenate([s, s + RELATIVE_STEP, s - RELATIVE_STEP])
        ).reshape(3, len(s))
        return value, (above - below) / (2.0 * RELATIVE_STEP)


def values_of(function: Function, points: Array, name: str) -> Array:
    """Values of a function at points (n, 2), checked to be n finite numbers.

    Raises
    ------
    CurveError
        If they are not, or in less than double precision.
    """
    found = np.asarray(function(points))
    if found.dtype.kind == "f" and found.dtype.itemsize < 8:
        raise CurveError(
            f"{name}: the function returned {found.dtype} numbers; expected float64, since an isoline of rounded "
            "values is not smooth. Compute in double precision, or use a field of the values."
        )
    values = found.astype(float)
    _check(values, (len(points),), points, name, "the function")
    return values


def gradient_of(function: Function, gradient: Function | None, points: Array, step: float, name: str) -> Array:
    """Gradients (n, 2) of a function at points, by central differences if there is no function for them.

    Raises
    ------
    CurveError
        If they are not finite or have another shape.
    """
    if gradient is not None:
        result = np.asarray(gradient(points), dtype=float)
        _check(result, points.shape, points, name, "the gradient")
        return result
    shifts = step * np.array([(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])
    east, west, north, south = values_of(function, (points + shifts[:, None, :]).reshape(-1, 2), name).reshape(
        4, len(points)
    )
    return np.stack([east - west, north - south], axis=-1) / (2.0 * step)


def own_gradient(function: Function, gradient: Function | None) -> Function | None:
    """The given gradient, else the function's own method of that name, if it has one."""
    own = getattr(function, "gradient", None) if gradient is None else gradient
    return own if callable(own) else None


def ratio(top: Array, bottom: Array, otherwise: float = np.inf) -> Array:
    """Quotient; where nothing can be divided by, zero if the dividend is zero too, else another number."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(bottom > 0.0, top / bottom, np.where(top == 0.0, 0.0, otherwise))


def _check(values: Array, shape: tuple[int, ...], points: Array, name: str, what: str) -> None:
    if values.shape != shape:
        raise CurveError(
            f"{name}: {what} returned shape {values.shape} for {len(points)} points; expected {shape}. It takes an "
            "array of points (n, 2) and works on all of them at once."
        )
    finite = np.isfinite(values).all(axis=tuple(range(1, values.ndim)))
    if not finite.all():
        bad = int(np.argmin(finite))
        raise CurveError(
            f"{name}: {what} is {values[bad]} at ({points[bad][0]:.6g}, {points[bad][1]:.6g}); expected finite values "
            "wherever the isoline is searched. Choose a smaller reach, or a function that is defined there."
        )
