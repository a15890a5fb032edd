"""Paths on the boundary along which block vertices slide: one or several block edges, joined smoothly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.curves import Curve
from hoblock.curves.arc_length import LengthTable, length_table

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["PathEdge", "PathPart", "SlidingPath"]

_DIFFERENCE = 2e-3
"""Half width of difference formulas of order four, as a fraction of the shortest edge: errors of about 1e-11."""
_FEWEST, _MOST = 32, 2048
"""Numbers of pieces of a spline that stands for an edge."""
_SAME = 1e-13
"""Distance of the spline from the curve, relative to its length."""
_SAMPLES = 32
"""Samples of each edge from which the coordinate of a place is sought."""


@dataclass(frozen=True, eq=False)
class PathEdge:
    """A block edge as a part of a path.

    Attributes
    ----------
    edge : int
    forward : bool
        Whether the path runs from the edge's first to its second vertex.
    ends : ndarray, shape (2, 2)
        Positions of the edge's vertices.
    curve : Curve or None
        None for a straight edge.
    """

    edge: int
    forward: bool
    ends: Array
    curve: Curve | None

    @cached_property
    def _table(self) -> LengthTable | None:
        return None if self.curve is None else length_table(self.curve)

    @property
    def length(self) -> float:
        """Arc length."""
        return float(np.hypot(*(self.ends[1] - self.ends[0]))) if self._table is None else self._table.length

    @cached_property
    def _spline(self) -> Any:
        """Points by arc length, to round-off, as splines of degree seven; None if the curve is not smooth."""
        from scipy.interpolate import make_interp_spline

        count = _FEWEST
        while count <= _MOST:
            s = np.linspace(0.0, self.length, count + 1)
            spline = make_interp_spline(s, self._exact(s), k=7)
            between = s[:-1] + 0.37 * self.length / count
            if np.abs(spline(between) - self._exact(between)).max() <= _SAME * self.length:
                return spline
            count *= 2
        return None

    def points(self, lengths: Array) -> Array:
        """Points at arc lengths from where the path enters the edge."""
        return self._exact(lengths) if self._table is None or self._spline is None else self._spline(lengths)

    def derivatives(self, lengths: Array) -> tuple[Array, Array] | None:
        """First and second derivatives of the points by the arc length; None if the curve is not smooth."""
        if self._table is None:
            along = (self.ends[1] - self.ends[0]) / self.length
            tangent = along if self.forward else -along
            return np.tile(tangent, (len(lengths), 1)), np.zeros((len(lengths), 2))
        if self._spline is None:
            return None
        return self._spline(lengths, 1), self._spline(lengths, 2)

    def _exact(self, lengths: Array) -> Array:
        from_first = lengths if self.forward else self.length - lengths
        if self._table is None or self.curve is None:
            t = (from_first / self.length)[:, None]
            return np.asarray((1.0 - t) * self.ends[0] + t * self.ends[1])
        return np.asarray(self.curve(self._table.parameters(from_first)))

    def lengths(self, t: Array) -> Array:
        """Arc lengths from the edge's first vertex at its parameters, as fractions of its length."""
        return np.asarray(t) if self._table is None else self._table.lengths(t) / self.length


@dataclass(frozen=True, eq=False)
class SlidingPath:
    """A smooth path of block edges with the arc length s as its coordinate.

    Attributes
    ----------
    edges : tuple of PathEdge
        In the order of the path.
    vertices : tuple of int
        Before, between and after the edges; a closed path begins and ends with the same one.
    """

    edges: tuple[PathEdge, ...]
    vertices: tuple[int, ...]

    @property
    def closed(self) -> bool:
        """Whether the path ends where it begins."""
        return self.vertices[0] == self.vertices[-1]

    @cached_property
    def starts(self) -> Array:
        """Coordinates of the vertices in the reference."""
        return np.concatenate(([0.0], np.cumsum([edge.length for edge in self.edges])))

    @property
    def length(self) -> float:
        """Arc length."""
        return float(self.starts[-1])

    def points(self, s: Array) -> Array:
        """Points (k, 2) at coordinates (k,); beyond the ends of an open path those of its tangents there."""
        inside, edge = self._places(s)
        result = np.empty((len(s), 2))
        for k in set(edge.tolist()):
            here = edge == k
            result[here] = self.edges[k].points(inside[here] - self.starts[k])
        if not self.closed and (beyond := s - inside).any():
            result += beyond[:, None] * self.derivatives(inside)[0]
        return result

    def derivatives(self, s: Array) -> tuple[Array, Array]:
        """First and second derivatives (k, 2) of the points by the coordinate."""
        inside, edge = self._places(s)
        first, second = np.empty((len(s), 2)), np.empty((len(s), 2))
        for k in set(edge.tolist()):
            here = edge == k
            found = self.edges[k].derivatives(inside[here] - self.starts[k])
            first[here], second[here] = self._differences(s[here]) if found is None else found
        return first, second

    def _places(self, s: Array) -> tuple[Array, Index]:
        """Coordinates within the path, and the edges they are on."""
        inside = s % self.length if self.closed else np.clip(s, 0.0, self.length)
        return inside, np.clip(np.searchsorted(self.starts, inside, side="right") - 1, 0, len(self.edges) - 1)

    def _differences(self, s: Array) -> tuple[Array, Array]:
        """Derivatives by differences of order four, for curves that no spline stands for."""
        h = _DIFFERENCE * float(np.diff(self.starts).min())
        at = s if self.closed else np.clip(s, 2.0 * h, self.length - 2.0 * h)
        low2, low, mid, high, high2 = self.points(np.concatenate([at + k * h for k in range(-2, 3)])).reshape(5, -1, 2)
        first = (8.0 * (high - low) - (high2 - low2)) / (12.0 * h)
        second = (16.0 * (high + low) - (high2 + low2) - 30.0 * mid) / (12.0 * h * h)
        return first, second

    @cached_property
    def _samples(self) -> tuple[Array, Array]:
        s = np.concatenate(
            [
                np.linspace(a, b, _SAMPLES, endpoint=False)
                for a, b in zip(self.starts[:-1], self.starts[1:], strict=True)
            ]
            + [self.starts[-1:]]
        )
        return s, self.points(s)

    def coordinates(self, points: Array) -> Array:
        """Coordinates of the places of the path closest to points (k, 2), by Newton's method from the best sample."""
        s, samples = self._samples
        distance = np.hypot(*(points[:, None] - samples[None]).transpose(2, 0, 1))
        found = s[distance.argmin(axis=1)]
        for _ in range(8):
            first, second = self.derivatives(found)
            gap = self.points(found) - points
            slope = (first * first).sum(axis=1) + np.maximum((gap * second).sum(axis=1), -0.5)
            step = (gap * first).sum(axis=1) / slope
            found = found - step
            if np.abs(step).max(initial=0.0) <= 1e-13 * self.length:
                break
        return np.asarray(found)

    def part(self, place: int, first: float, second: float) -> PathPart:
        """The geometry of an edge of the path, by its place, whose ends have slid to coordinates of the path.

        ``first`` belongs to the vertex at which the path enters the edge.
        """
        return PathPart(self, self.edges[place], first, second)


@dataclass(frozen=True, eq=False)
class PathPart:
    """A curve on a path between two of its coordinates, its points spread as on the edge it takes the place of.

    Parameters
    ----------
    path : SlidingPath
    edge : PathEdge
        What tells the direction and how arc length grows with the parameter.
    start, stop : float
        Coordinates where the path enters and leaves the part.
    """

    path: SlidingPath
    edge: PathEdge
    start: float
    stop: float

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        share = self.edge.lengths(np.asarray(t, dtype=float))
        if not self.edge.forward:
            share = 1.0 - share
        return self.path.points(self.start + share * (self.stop - self.start))
