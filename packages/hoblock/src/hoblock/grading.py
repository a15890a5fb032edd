"""Gradings: how element corners are distributed along a block edge, maps of [0, 1] onto itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.reference import gauss_lobatto

Array = NDArray[np.float64]

__all__ = ["Cubic", "Exponential", "Grading", "Quadratic", "Reversed", "Uniform", "element_corners", "node_parameters"]


class Grading(Protocol):
    """A strictly increasing map of [0, 1] onto [0, 1]; hashable, so that layouts can be shared."""

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``, same shape."""
        ...

    def __hash__(self) -> int:
        """Equal gradings have equal hashes."""
        ...


@dataclass(frozen=True)
class Uniform:
    """Elements of equal parameter length."""

    def __call__(self, s: Array) -> Array:
        """Return ``s``."""
        return np.asarray(s, dtype=float)


@dataclass(frozen=True)
class Quadratic:
    """The paper's quadratic grading (Fig. 3a): r + m (r² - 1)/2 on [-1, 1], m in (-1, 1).

    Positive m makes the elements near the *first* vertex small.
    """

    m: float

    def __post_init__(self) -> None:
        if not -1.0 < self.m < 1.0:
            raise GradingError(f"quadratic grading: m is {self.m:g}; expected a number in (-1, 1).")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        r = 2.0 * np.asarray(s, dtype=float) - 1.0
        return np.asarray((r + self.m * (r * r - 1.0) / 2.0 + 1.0) / 2.0)


@dataclass(frozen=True)
class Cubic:
    """The paper's cubic grading (Fig. 3b): (1 + m/2) r - (m/2) r³ on [-1, 1], m in [0, 1).

    Makes the elements at both ends small.
    """

    m: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.m < 1.0:
            raise GradingError(f"cubic grading: m is {self.m:g}; expected a number in [0, 1).")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        r = 2.0 * np.asarray(s, dtype=float) - 1.0
        return np.asarray(((1.0 + self.m / 2.0) * r - self.m / 2.0 * r**3 + 1.0) / 2.0)


@dataclass(frozen=True)
class Exponential:
    """s ↦ (exp(a s) - 1)/(exp(a) - 1): sizes grow by a constant ratio, dense at the first vertex for a > 0."""

    a: float

    def __post_init__(self) -> None:
        if not abs(self.a) <= 50.0:
            raise GradingError(f"exponential grading: a is {self.a:g}; expected a number in [-50, 50].")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        s = np.asarray(s, dtype=float)
        if abs(self.a) < 1e-8:
            return s + self.a * s * (s - 1.0) / 2.0
        return np.asarray(np.expm1(self.a * s) / np.expm1(self.a))


@dataclass(frozen=True)
class Reversed:
    """A grading walked from the other end."""

    grading: Grading

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        return np.asarray(1.0 - self.grading(1.0 - np.asarray(s, dtype=float)))


def element_corners(grading: Grading, count: int, place: str = "grading") -> Array:
    """Positions of the ``count + 1`` element corners along an edge, from exactly 0 to exactly 1.

    Raises
    ------
    GradingError
        If the positions are not strictly increasing or the ends are not 0 and 1.
    """
    corners = np.array(grading(np.linspace(0.0, 1.0, count + 1)), dtype=float)
    if abs(corners[0]) > 1e-12 or abs(corners[-1] - 1.0) > 1e-12:
        raise GradingError(f"{place}: {grading} maps 0 and 1 to {corners[0]:g} and {corners[-1]:g}; must keep both.")
    corners[0], corners[-1] = 0.0, 1.0
    if not np.all(np.diff(corners) > 0.0):
        k = int(np.argmin(np.diff(corners)))
        raise GradingError(
            f"{place}: {grading} is not strictly increasing: corner {k} of {count} at {corners[k]:g}, "
            f"the next at {corners[k + 1]:g}. Weaken the grading."
        )
    return corners


def node_parameters(grading: Grading, count: int, order: int, place: str = "grading") -> Array:
    """Parameters of an edge's nodes, shape (count order + 1,).

    Element corners by the grading, the GLL nodes inside an element scaled to it.

    Raises
    ------
    GradingError
        As `element_corners`.
    """
    corners = element_corners(grading, count, place)
    inner = (gauss_lobatto(order)[:-1] + 1.0) / 2.0
    nodes = corners[:-1, None] + np.diff(corners)[:, None] * inner
    return np.append(nodes.ravel(), 1.0)
