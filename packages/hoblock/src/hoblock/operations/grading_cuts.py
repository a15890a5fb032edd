"""Gradings cut in two where their edge is cut: after some elements, or at a place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.grading import Grading, Listed, Reversed, element_corners, restrict

Array = NDArray[np.float64]

__all__ = ["AfterElements", "AtParameter", "Cut", "GradingCut"]


@dataclass(frozen=True)
class GradingCut:
    """A grading cut in two.

    Attributes
    ----------
    place : float
        Parameter of the edge's curve.
    nodal_place : float
        The same for a curve given by nodes, whose elements have equal parameter lengths.
    counts : (int, int)
        Elements of the two parts.
    parts : (Grading, Grading)
    """

    place: float
    nodal_place: float
    counts: tuple[int, int]
    parts: tuple[Grading, Grading]


@dataclass(frozen=True)
class AfterElements:
    """Cut edges after some of their elements, which all remain as they are."""

    number: int

    def reversed(self, count: int) -> AfterElements:
        """Return the same cut as seen from the other end of an edge with ``count`` elements."""
        return AfterElements(count - self.number)

    def of(self, grading: Grading, count: int) -> GradingCut:
        """Cut the grading of an edge with ``count`` elements."""
        k = self.number
        place = float(element_corners(grading, count)[k])
        parts = restrict(grading, 0.0, k / count), restrict(grading, k / count, 1.0)
        return GradingCut(place, k / count, (k, count - k), parts)


@dataclass(frozen=True)
class AtParameter:
    """Cut edges at a parameter; the parts have given numbers of elements, or share the present one."""

    place: float
    counts: tuple[int, int] | None = None

    def reversed(self, count: int) -> AtParameter:
        """Return the same cut as seen from the other end of an edge with ``count`` elements."""
        del count
        return AtParameter(1.0 - self.place, self.counts and (self.counts[1], self.counts[0]))

    def of(self, grading: Grading, count: int) -> GradingCut:
        """Cut the grading of an edge with ``count`` elements; sizes of elements remain in proportion."""
        listed = isinstance(grading.grading if isinstance(grading, Reversed) else grading, Listed)
        smooth = _Interpolated(tuple(element_corners(grading, count).tolist())) if listed else grading
        s = _inverse(smooth, self.place)
        counts = self.counts or _shared_out(s, count)
        if not listed:
            parts = restrict(smooth, 0.0, s), restrict(smooth, s, 1.0)
            return GradingCut(self.place, self.place, counts, parts)
        ends = (0.0, s), (s, 1.0)
        corners = [smooth(np.linspace(*end, number + 1)) for end, number in zip(ends, counts, strict=True)]
        return GradingCut(self.place, self.place, counts, (_list(corners[0]), _list(corners[1])))

    def with_counts_of(self, cut: GradingCut) -> AtParameter:
        """Return the same cut with numbers of elements settled on one edge of the chain."""
        return AtParameter(self.place, cut.counts)


Cut = AfterElements | AtParameter


@dataclass(frozen=True)
class _Interpolated:
    """Monotone interpolation of listed corners, so that a list can be cut between them."""

    corners: tuple[float, ...]

    def __call__(self, s: Array) -> Array:
        from scipy.interpolate import PchipInterpolator

        if len(self.corners) == 2:
            return np.asarray(s, dtype=float)
        return np.asarray(PchipInterpolator(np.linspace(0.0, 1.0, len(self.corners)), self.corners)(s))


def _inverse(grading: Grading, place: float) -> float:
    """Parameter at which a grading reaches a place: bisection, safe for anything that increases."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if float(grading(np.array([middle]))[0]) < place:
            low = middle
        else:
            high = middle
    return high


def _shared_out(s: float, count: int) -> tuple[int, int]:
    """Elements before and after the parameter ``s`` of a grading, at least one each."""
    total = max(count, 2)
    first = min(max(round(s * count), 1), total - 1)
    return first, total - first


def _list(corners: Array) -> Listed:
    scaled = (corners - corners[0]) / (corners[-1] - corners[0])
    return Listed((0.0, *scaled[1:-1].tolist(), 1.0))
