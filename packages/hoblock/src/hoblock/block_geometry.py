"""The sides of a block as curves, and what can be wrong with them: angles, crossings, folds of the map between them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.transfinite import reference_positions

Array = NDArray[np.float64]

__all__ = ["BlockGeometry", "Crossing"]

_PIECES = (127, 131, 137, 139)
"""Pieces of each sampled side; primes, since a crossing right at a sample of both sides would not be seen."""
_STEP = 1e-4
"""Step in the parameter for one-sided differences at the ends of a side."""

# Sides are bottom, right, top, left, directed along increasing coordinates. A corner lies between the next side,
# counter-clockwise, and the one before: (side, whether the corner is the end of that side).
_CORNERS = (((0, False), (3, False)), ((1, False), (0, True)), ((2, True), (1, True)), ((3, True), (2, False)))


@dataclass(frozen=True)
class Crossing:
    """Two sides of a block that cross, or one that crosses itself, and where."""

    first: int
    second: int
    place: tuple[float, float]


class BlockGeometry:
    """The geometry of a block, relative to its first corner and scaled to about one.

    Parameters
    ----------
    structure : BlockStructure
    block : int
    """

    def __init__(self, structure: BlockStructure, block: int) -> None:
        self.structure = structure
        self.edges = [int(edge) for edge in structure.topology.block_edges[block]]
        self.vertices = [int(vertex) for vertex in structure.topology.quads[block]]
        corners = structure.vertices[self.vertices]
        self._origin = corners[0]
        size = float(np.ptp(corners, axis=0).max())
        self._scale = float(np.ldexp(1.0, np.frexp(size)[1])) if np.isfinite(size) else 1.0
        self.corners = self._scaled(corners)
        self.sampled = [self.side(k, np.linspace(0.0, 1.0, pieces + 1)) for k, pieces in enumerate(_PIECES)]

    def _scaled(self, points: Array) -> Array:
        return np.asarray((points - self._origin) / self._scale)

    def side(self, side: int, t: Array) -> Array:
        """Scaled points (n, 2) of a side at parameters in [0, 1]."""
        edge = self.edges[side]
        curve = self.structure.curves.get(edge)
        if curve is not None:
            return self._scaled(np.asarray(curve(np.asarray(t, dtype=float)), dtype=float))
        first, second = self._scaled(self.structure.vertices[self.structure.topology.edges[edge]])
        return np.asarray(first + np.asarray(t)[:, None] * (second - first))

    def side_name(self, side: int) -> str:
        """Name of the edge on a side."""
        return self.structure.topology.edge_name(self.edges[side])

    def corner_name(self, corner: int) -> str:
        """Name of the vertex at a corner."""
        return self.structure.topology.vertex_names[self.vertices[corner]]

    def corner_sides(self, corner: int) -> tuple[int, int]:
        """The sides that meet at a corner: the next and the one before, counter-clockwise."""
        (following, _), (before, _) = _CORNERS[corner]
        return following, before

    @property
    def curved(self) -> list[int]:
        """Sides with a curve."""
        return [k for k in range(4) if self.edges[k] in self.structure.curves]

    @property
    def area(self) -> float:
        """Scaled area enclosed by the sides, positive if they run counter-clockwise."""
        bottom, right, top, left = self.sampled
        x, y = (np.concatenate([bottom, right, top[::-1], left[::-1]]) - bottom[0]).T
        return float(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum())

    def angles(self) -> Array:
        """Angles in degrees, in [0, 360), between the tangents of the sides at the four corners."""
        result = np.empty(4)
        for corner, (following, before) in enumerate(_CORNERS):
            e, f = self._leaving(*following), self._leaving(*before)
            result[corner] = np.degrees(np.arctan2(e[0] * f[1] - e[1] * f[0], e @ f)) % 360.0
        return result

    def _leaving(self, side: int, at_end: bool) -> Array:
        t = np.array([0.0, _STEP, 2.0 * _STEP])
        points = self.side(side, 1.0 - t if at_end else t)
        return np.asarray(-3.0 * points[0] + 4.0 * points[1] - points[2])

    def lengths(self) -> Array:
        """Scaled lengths of the sampled sides."""
        return np.array([np.hypot(*np.diff(side, axis=0).T).sum() for side in self.sampled])

    def crossing(self) -> Crossing | None:
        """The first crossing of two sides, opposite ones first, or of a side with itself; None if there is none."""
        pairs = sorted(combinations(range(4), 2), key=lambda pair: pair[1] - pair[0] != 2)
        for first, second in [*pairs, *((k, k) for k in range(4))]:
            place = self._crossing(first, second)
            if place is not None:
                x, y = (self._origin + self._scale * place).tolist()
                return Crossing(first, second, (x, y))
        return None

    def _crossing(self, first: int, second: int) -> Array | None:
        p, q = self.sampled[first], self.sampled[second]
        places = _segment_crossings(p, q, neighbours=first == second)
        ends = self.corners[:, None]
        size = float(np.ptp(self.corners, axis=0).max())
        away = (np.hypot(*(places - ends).transpose(2, 0, 1)) > 1e-6 * size).all(axis=0)
        return places[away][0] if away.any() else None

    def folds(self) -> bool:
        """Whether the smooth transfinite map of the block, without gradings, turns over somewhere."""
        t = np.linspace(0.0, 1.0, 65)
        return _turned(self._map((t, t), (t, t)))

    def folds_within(self, bottom: Array, top: Array, left: Array, right: Array) -> bool:
        """Whether the smooth graded map turns over in an element between parameters (2,) on the four sides."""
        s = np.linspace(0.0, 1.0, 33)
        b, t, le, r = (ends[0] + s * (ends[1] - ends[0]) for ends in (bottom, top, left, right))
        return _turned(self._map((b, t), (le, r)))

    def _map(self, along_u: tuple[Array, Array], along_v: tuple[Array, Array]) -> Array:
        """Points (n, m, 2) of the transfinite map at parameters of the nodes on bottom, top and on left, right."""
        u, v = (w[0][..., None] for w in reference_positions(*(w[None] for w in (*along_u, *along_v))))
        B, T = self.side(0, along_u[0])[None], self.side(2, along_u[1])[None]
        L, R = self.side(3, along_v[0])[:, None], self.side(1, along_v[1])[:, None]
        a, b, c, d = self.corners
        corners = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
        return np.asarray((1 - v) * B + v * T + (1 - u) * L + u * R - corners)


def _segment_crossings(p: Array, q: Array, *, neighbours: bool) -> Array:
    """Places (k, 2) where two polylines cross; of one polyline with itself, segments next to each other left out."""
    a, b, c, d = p[:-1, None], p[1:, None], q[None, :-1], q[None, 1:]

    def side_of(start: Array, end: Array, point: Array) -> Array:
        along, to = end - start, point - start
        return np.asarray(along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0])

    from_c, from_d = side_of(a, b, c), side_of(a, b, d)
    crossing = (from_c * from_d < 0.0) & (side_of(c, d, a) * side_of(c, d, b) < 0.0)
    if neighbours:
        number = np.arange(len(crossing))
        crossing &= np.abs(number[:, None] - number) > 1
    i, j = np.nonzero(crossing)
    ratio = (from_c[i, j] / (from_c[i, j] - from_d[i, j]))[:, None]
    return np.asarray(q[j] + ratio * (q[j + 1] - q[j]))


def _turned(points: Array) -> bool:
    """Whether a corner of a cell of a grid of points (n, m, 2) is turned over."""
    along_u, along_v = np.diff(points, axis=1), np.diff(points, axis=0)
    for e in (along_u[:-1], along_u[1:]):
        for f in (along_v[:, :-1], along_v[:, 1:]):
            if not (e[..., 0] * f[..., 1] - e[..., 1] * f[..., 0] > 0.0).all():
                return True
    return False
