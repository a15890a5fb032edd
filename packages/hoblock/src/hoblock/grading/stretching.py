"""Gradings whose elements grow by a constant ratio."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.grading.grading import EdgeShape

Array = NDArray[np.float64]

__all__ = ["Exponential", "Geometric"]

_STRONGEST = 50.0


@dataclass(frozen=True)
class Exponential:
    """s ↦ (exp(a s) - 1)/(exp(a) - 1): sizes grow by a constant ratio, dense at the first vertex for a > 0."""

    a: float

    def __post_init__(self) -> None:
        if not abs(self.a) <= _STRONGEST:
            raise GradingError(f"exponential grading: a is {self.a:g}; expected a number in [-50, 50].")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        s = np.asarray(s, dtype=float)
        if abs(self.a) < 1e-8:
            return s + self.a * s * (s - 1.0) / 2.0
        return np.asarray(np.expm1(self.a * s) / np.expm1(self.a))

    def reversed(self) -> Exponential:
        """Return the grading walked from the other end."""
        return Exponential(-self.a)

    def restricted(self, start: float, stop: float) -> Exponential:
        """Return the grading between two parameters, which is one of the same kind."""
        return Exponential(self.a * (stop - start))


@dataclass(frozen=True, kw_only=True)
class Geometric:
    """Sizes that grow by a constant ratio, given by exactly one of two numbers.

    Depends on the number n of elements: growth = total^(1/(n - 1)). On an edge it is an `Exponential` with
    a = n log(growth).

    Attributes
    ----------
    total : float, optional
        Size of the last element over that of the first. OpenFOAM's ``simpleGrading``.
    growth : float, optional
        Size of an element over that of the one before. Gmsh's ``Progression``.
    """

    total: float | None = None
    growth: float | None = None

    def __post_init__(self) -> None:
        if (self.total is None) == (self.growth is None):
            got = "neither total nor growth" if self.total is None else "both total and growth"
            raise GradingError(
                f"geometric grading: got {got}; expected exactly one of them: total is the last size over the first, "
                "growth the ratio of neighbours (Gmsh's Progression)."
            )
        name, value = ("growth", self.growth) if self.total is None else ("total", self.total)
        if value is None or not 0.0 < value < math.inf:
            raise GradingError(
                f"geometric grading: {name} is {value}; expected a positive number, above 1 for small elements at "
                "the first vertex, below 1 for small ones at the second."
            )

    def resolved(self, shape: EdgeShape, count: int) -> Exponential:
        """Return the grading of an edge with ``count`` elements; its shape does not matter.

        Raises
        ------
        GradingError
            If the smallest element were less than about exp(-50) of the edge.
        """
        if self.growth is not None:
            a = count * math.log(self.growth)
        elif self.total is not None and count > 1:
            a = count / (count - 1) * math.log(self.total)
        else:
            a = 0.0
        if abs(a) > _STRONGEST:
            most = math.floor(1e4 * math.exp(_STRONGEST / count)) / 1e4
            least = math.ceil(1e4 / most) / 1e4
            raise GradingError(
                f"geometric grading: {count} elements growing by {math.exp(a / count):.6g} differ by a factor of "
                f"{math.exp(abs(a) * (count - 1) / count):.2g}; take a growth between {least:g} and {most:g}, or fewer "
                "elements."
            )
        return Exponential(a)
