"""Gradings made from gradings: walked from the other end, or a part of one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, overload, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.grading.grading import EdgeGrading, EdgeShape, Grading
from hoblock.grading.listed import Listed

Array = NDArray[np.float64]

__all__ = ["Part", "Reversed", "ReversedEdgeGrading", "restrict", "reverse"]


@runtime_checkable
class _Reversible(Protocol):
    """A grading whose reverse is one of its own kind; reversing that gives the grading itself, to the last bit."""

    def reversed(self) -> Grading: ...


@runtime_checkable
class _Restrictable(Protocol):
    """A grading whose parts are of its own kind."""

    def restricted(self, start: float, stop: float) -> Grading: ...


@dataclass(frozen=True)
class Reversed:
    """A grading walked from the other end. Use `reverse`, which knows simpler forms."""

    grading: Grading

    def __post_init__(self) -> None:
        if isinstance(self.grading, EdgeGrading):
            raise GradingError(
                f"reversed grading: {self.grading} depends on its edge; use reverse(grading), which allows that."
            )

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        return np.asarray(1.0 - self.grading(1.0 - np.asarray(s, dtype=float)))


@dataclass(frozen=True)
class ReversedEdgeGrading:
    """A grading that depends on its edge, walked from the other end."""

    grading: EdgeGrading

    def resolved(self, shape: EdgeShape, count: int) -> Grading:
        """Return the grading of an edge of some shape with ``count`` elements.

        Raises
        ------
        GradingError
            If it does not fit.
        """
        return reverse(self.grading.resolved(_ReversedShape(shape), count))


@dataclass(frozen=True)
class _ReversedShape:
    """An edge as one sees it from its second end."""

    shape: EdgeShape

    @property
    def length(self) -> float:
        return self.shape.length

    @property
    def breaks(self) -> Array:
        return np.asarray(1.0 - self.shape.breaks[::-1])

    def parameters(self, lengths: Array) -> Array:
        return np.asarray(1.0 - self.shape.parameters(self.shape.length - np.asarray(lengths)))


@overload
def reverse(grading: Grading) -> Grading: ...
@overload
def reverse(grading: EdgeGrading) -> EdgeGrading: ...
@overload
def reverse(grading: Grading | EdgeGrading) -> Grading | EdgeGrading: ...


def reverse(grading: Grading | EdgeGrading) -> Grading | EdgeGrading:
    """Return the grading walked from the other end; reversed twice, it equals itself."""
    if isinstance(grading, Reversed | ReversedEdgeGrading):
        return grading.grading
    if isinstance(grading, _Reversible):
        return grading.reversed()
    if isinstance(grading, EdgeGrading):
        return ReversedEdgeGrading(grading)
    return Reversed(grading)


@dataclass(frozen=True)
class Part:
    """A grading between two of its parameters, both scaled to [0, 1]. Use `restrict`, which knows simpler forms.

    A part of a part is kept as a part of the whole.

    Attributes
    ----------
    grading : Grading
    start, stop : float
        Parameters of ``grading``, 0 <= start < stop <= 1. If it has n elements, k/n is corner k.
    """

    grading: Grading
    start: float
    stop: float

    def __post_init__(self) -> None:
        if isinstance(self.grading, EdgeGrading):
            raise GradingError(
                f"part of a grading: {self.grading} depends on its whole edge; use its resolved(shape, count) instead."
            )
        if not 0.0 <= self.start < self.stop <= 1.0:
            raise GradingError(
                f"part of a grading: from {self.start:g} to {self.stop:g}; expected 0 <= start < stop <= 1."
            )
        if isinstance(self.grading, Part):
            whole, width = self.grading, self.grading.stop - self.grading.start
            object.__setattr__(self, "grading", whole.grading)
            object.__setattr__(self, "stop", whole.stop if self.stop == 1.0 else whole.start + width * self.stop)
            object.__setattr__(self, "start", whole.start + width * self.start)

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        s = np.asarray(s, dtype=float)
        first, last = self.grading(np.array([self.start, self.stop]))
        inside = (1.0 - s) * self.start + s * self.stop
        return np.asarray((self.grading(inside) - first) / (last - first))


def restrict(grading: Grading, start: float, stop: float) -> Grading:
    """Return the part of a grading between two of its parameters.

    Parameters
    ----------
    grading : Grading
        One that depends on its edge must be resolved before.
    start, stop : float
        0 <= start < stop <= 1. If the edge has n elements, k/n is corner k.

    Raises
    ------
    GradingError
        If the parameters are none of these, the grading depends on its edge, or a part of a listed one ends between
        corners.
    """
    part = Part(grading, start, stop)
    if (start, stop) == (0.0, 1.0):
        return grading
    if isinstance(grading, Listed):
        return _part_of_list(grading, start, stop)
    if isinstance(grading, Reversed):
        return reverse(restrict(grading.grading, 1.0 - stop, 1.0 - start))
    if isinstance(grading, _Restrictable):
        return grading.restricted(start, stop)
    return part


def _part_of_list(grading: Listed, start: float, stop: float) -> Listed:
    ends = np.array([start, stop]) * grading.count
    corners = np.round(ends).astype(np.int64)
    if np.abs(ends - corners).max() > 1e-9 * grading.count or corners[0] == corners[1]:
        raise GradingError(
            f"part of a grading: from {start:g} to {stop:g} of {grading}; a part of it begins and ends at corners, "
            f"multiples of 1/{grading.count}."
        )
    inside = np.array(grading.positions[corners[0] : corners[1] + 1])
    inside = (inside - inside[0]) / (inside[-1] - inside[0])
    return Listed(tuple(inside.tolist()))
