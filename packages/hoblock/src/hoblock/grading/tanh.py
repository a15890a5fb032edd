"""Vinokur's hyperbolic tangent gradings, one- and two-sided."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.grading.ends import Ends, check_ends, opposite
from hoblock.grading.grading import EdgeShape
from hoblock.grading.listed import Listed

Array = NDArray[np.float64]

__all__ = ["Tanh", "TanhSpacing"]

_STRONGEST = 30.0
_LARGEST_DELTA = 600.0  # beyond it, sinh overflows


@dataclass(frozen=True)
class Tanh:
    """Hyperbolic tangent of some strength δ: smooth, with sizes near the dense ends about δ/sinh(δ) of the even ones.

    ``"first"``: 1 + tanh(δ (s - 1)/2)/tanh(δ/2); ``"both"``: (1 + tanh(δ (s - 1/2))/tanh(δ/2))/2.

    Attributes
    ----------
    strength : float
        δ in [0, 30]; 0 is uniform.
    ends : {"first", "second", "both"}
        Where the elements are small.

    References
    ----------
    M. Vinokur, J. Comput. Phys. 50 (1983) 215, doi:10.1016/0021-9991(83)90065-7.
    """

    strength: float
    ends: Ends = "first"

    def __post_init__(self) -> None:
        check_ends(self.ends, "tanh grading")
        if not 0.0 <= self.strength <= _STRONGEST:
            raise GradingError(f"tanh grading: strength is {self.strength:g}; expected a number in [0, 30].")

    @staticmethod
    def spacing(
        first: float | None = None, second: float | None = None, unit: Literal["length", "fraction"] = "length"
    ) -> TanhSpacing:
        """Return the grading whose elements at one or both ends have given sizes; see `TanhSpacing`."""
        return TanhSpacing(first, second, unit)

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        s = np.asarray(s, dtype=float)
        if self.ends == "both":
            return _two_sided(s, self.strength)
        return _one_sided(s, self.strength) if self.ends == "first" else 1.0 - _one_sided(1.0 - s, self.strength)

    def reversed(self) -> Tanh:
        """Return the grading walked from the other end."""
        return Tanh(self.strength, opposite(self.ends))


@dataclass(frozen=True)
class TanhSpacing:
    """A hyperbolic tangent grading whose elements at one or both ends have exactly given sizes, whatever the edge.

    Vinokur's functions, with the parameters solved for the sizes of the first and the last *element* instead of the
    slopes at the ends. Sizes above the even one are met as well, by the tangent in the place of its hyperbolic brother.

    Attributes
    ----------
    first, second : float, optional
        Size of the element at the first, at the second vertex; at least one of them.
    unit : {"length", "fraction"}
        Whether these are arc lengths in the units of the coordinates, kept when the edge changes its length, or
        fractions of the edge's arc length.

    References
    ----------
    M. Vinokur, J. Comput. Phys. 50 (1983) 215, doi:10.1016/0021-9991(83)90065-7.
    """

    first: float | None = None
    second: float | None = None
    unit: Literal["length", "fraction"] = "length"

    def __post_init__(self) -> None:
        if self.unit not in ("length", "fraction"):
            raise GradingError(f"tanh spacing: unit is {self.unit!r}; expected 'length' or 'fraction'.")
        if self.first is None and self.second is None:
            raise GradingError("tanh spacing: neither first nor second is given; expected the size of an end element.")
        most = 1.0 if self.unit == "fraction" else math.inf
        for name, size in (("first", self.first), ("second", self.second)):
            if size is not None and not 0.0 < size < most:
                expected = "a positive length" if self.unit == "length" else "a fraction in (0, 1)"
                raise GradingError(f"tanh spacing: {name} is {size:g}; expected {expected}.")

    def resolved(self, shape: EdgeShape, count: int) -> Listed:
        """Return the grading of an edge of some shape with ``count`` elements.

        Raises
        ------
        GradingError
            If the sizes leave no room for the other elements, or there are none.
        """
        length = shape.length
        scale = length if self.unit == "length" else 1.0
        first, second = (None if size is None else size / scale for size in (self.first, self.second))
        self._check(length, count, (first or 0.0) + (second or 0.0))
        if first is not None and second is not None:
            fractions = _with_both(first, second, count)
        elif first is not None:
            fractions = _with_one(first, count)
        else:
            fractions = 1.0 - _with_one(second or 0.0, count)[::-1]
        return Listed.at_lengths(shape, fractions * length)

    def reversed(self) -> TanhSpacing:
        """Return the grading walked from the other end."""
        return TanhSpacing(self.second, self.first, self.unit)

    def _check(self, length: float, count: int, taken: float) -> None:
        given = 2 - (self.first is None) - (self.second is None)
        sizes = " and ".join(f"{size:g}" for size in (self.first, self.second) if size is not None)
        if count <= given:
            raise GradingError(
                f"tanh spacing: {count} element{'s' * (count != 1)} with end sizes {sizes}; take at least {given + 1} "
                "elements."
            )
        if not taken < 1.0:
            edge = f" of length {length:.6g}" if self.unit == "length" else ""
            raise GradingError(
                f"tanh spacing: the end sizes {sizes} leave nothing of an edge{edge} to the other elements; take "
                "smaller ones."
            )


def _one_sided(s: Array, delta: float) -> Array:
    """1 + tanh(δ (s - 1)/2)/tanh(δ/2) without cancellation; a tangent of -δ for δ in (-π, 0)."""
    if abs(delta) < 1e-8:
        return s
    sine, cosine = (np.sinh, np.cosh) if delta > 0.0 else (np.sin, np.cos)
    return np.asarray(sine(delta * s / 2.0) / (cosine(delta * (1.0 - s) / 2.0) * sine(delta / 2.0)))


def _two_sided(s: Array, delta: float) -> Array:
    """(1 + tanh(δ (s - 1/2))/tanh(δ/2))/2 without cancellation at 0; a tangent of -δ for δ in (-π, 0)."""
    if abs(delta) < 1e-8:
        return s
    sine, cosine = (np.sinh, np.cosh) if delta > 0.0 else (np.sin, np.cos)
    return np.asarray(sine(delta * s) / (2.0 * sine(delta / 2.0) * cosine(delta * (s - 0.5))))


def _with_one(first: float, count: int) -> Array:
    """Inner corners, the first at ``first``."""
    delta = _strength(_one_sided, first, count)
    corners = _one_sided(np.arange(1, count) / count, delta)
    corners[0] = first
    return corners


def _with_both(first: float, second: float, count: int) -> Array:
    """Inner corners, the first at ``first``, the last at ``1 - second``.

    Vinokur's s = u/(A + (1 - A) u), u two-sided and symmetric: with u₁ = u(1/n), the first and the last size are
    u₁/(A + (1 - A) u₁) and A u₁/(1 - (1 - A) u₁). Solved for A and u₁ this reads as below.
    """
    odds = math.sqrt(first / (1.0 - first) * second / (1.0 - second))
    a = math.sqrt((1.0 - first) / first * second / (1.0 - second))
    delta = _strength(_two_sided, odds / (1.0 + odds), count)
    u = _two_sided(np.arange(1, count) / count, delta)
    corners = u / (a + (1.0 - a) * u)
    corners[0], corners[-1] = first, 1.0 - second
    return np.asarray(corners)


def _strength(shape: Callable[[Array, float], Array], size: float, count: int) -> float:
    """δ for which the first of ``count`` elements has a size; it falls from its limit at -π to 0 at infinity."""
    s = np.array(1.0 / count)
    low, high = -math.pi * (1.0 - 1e-15), _LARGEST_DELTA
    if float(shape(s, high)) >= size:
        raise GradingError(f"tanh spacing: an end size is {size:.3g} of the edge; too small. Take a larger one.")
    while high - low > 4e-16 * max(abs(low), abs(high)):
        middle = (low + high) / 2.0
        if not low < middle < high:
            break
        low, high = (middle, high) if float(shape(s, middle)) > size else (low, middle)
    return high
