"""Block vertices on the boundary that slide along it, with their coordinates on the paths they slide on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve
from hoblock.curves.derived import Displaced
from hoblock.errors import MoverError
from hoblock.movers.end_tangents import curve_end_tangents
from hoblock.movers.sliding_path import PathEdge, SlidingPath

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Sliding", "sliding_vertices"]

_SMOOTH = 1.0
"""Largest angle in degrees between the edges at a vertex that can slide from one to the other."""
_STRAIGHT = 1e-12
"""Largest distance of a straight path's vertices from the line through its ends, relative to its length."""
_ON_PATH = 1e-10
"""Distance of a vertex from its path, relative to its length, that is rounding."""


@dataclass(frozen=True, eq=False)
class Sliding:
    """Vertices that slide, each with one coordinate: the arc length on its path.

    Vertices on straight paths, the common case, are treated as arrays; those on curved ones path by path.

    Attributes
    ----------
    vertices : ndarray, shape (k,)
        Ascending.
    paths : tuple of SlidingPath
    rows : tuple of ndarray
        For each path, which of the vertices are on it.
    start : ndarray, shape (k,)
        Coordinates in the reference.
    """

    vertices: Index
    paths: tuple[SlidingPath, ...]
    rows: tuple[Index, ...]
    start: Array
    _points: Array = field(repr=False)
    _tangents: Array = field(repr=False)
    _curved: tuple[int, ...] = field(repr=False)

    @staticmethod
    def of(structure: BlockStructure, vertices: Index, driven: Index) -> Sliding:
        """Find the paths of some boundary vertices.

        Parameters
        ----------
        structure : BlockStructure
        vertices : ndarray
            Ascending.
        driven : ndarray
            Vertices that are driven, none of which can slide.

        Raises
        ------
        MoverError
            If a vertex is inside, driven, or where two sides of the boundary meet at an angle.
        """
        edges_at = _boundary_edges(structure)
        names = structure.topology.vertex_names
        for vertex in vertices.tolist():
            if vertex in driven:
                raise MoverError(f"sliding: vertex '{names[vertex]}' is driven; a vertex can only do one. Remove it.")
            if vertex not in edges_at:
                raise MoverError(
                    f"sliding: vertex '{names[vertex]}' is inside; expected vertices on the boundary. Remove it: inner "
                    "vertices move freely."
                )
            _check_smooth(structure, vertex, edges_at[vertex])
        slides = set(vertices.tolist())
        paths, done = [], set[int]()
        for vertex in vertices.tolist():
            if vertex not in done:
                path = _path(structure, vertex, slides, edges_at)
                paths.append(path)
                done.update(path.vertices)
        rows = tuple(np.flatnonzero(np.isin(vertices, path.vertices)) for path in paths)
        start, tangents = np.zeros(len(vertices)), np.zeros((len(vertices), 2))
        curved = tuple(k for k, path in enumerate(paths) if not _is_straight(structure, path))
        for k, (path, some) in enumerate(zip(paths, rows, strict=True)):
            place = [path.vertices.index(vertex) for vertex in vertices[some].tolist()]
            start[some] = path.starts[place]
            if k in curved:
                tangents[some] = path.derivatives(start[some])[0]
            else:
                whole = structure.vertices[path.vertices[-1]] - structure.vertices[path.vertices[0]]
                tangents[some] = whole / np.hypot(*whole)
        return Sliding(vertices, tuple(paths), rows, start, structure.vertices[vertices], tangents, curved)

    @property
    def curved_edges(self) -> tuple[int, ...]:
        """Edges on paths that are not straight: their geometry changes when their vertices slide."""
        return tuple(sorted(part.edge for k in self._curved for part in self.paths[k].edges))

    def positions(self, s: Array) -> Array:
        """Positions (k, 2) at coordinates (k,)."""
        points = self._points + (s - self.start)[:, None] * self._tangents
        for k in self._curved:
            points[self.rows[k]] = self.paths[k].points(s[self.rows[k]])
        return points

    def derivatives(self, s: Array) -> tuple[Array, Array]:
        """First and second derivatives (k, 2) of the positions by the coordinates."""
        first, second = self._tangents.copy(), np.zeros_like(self._tangents)
        for k in self._curved:
            first[self.rows[k]], second[self.rows[k]] = self.paths[k].derivatives(s[self.rows[k]])
        return first, second

    def coordinates(self, points: Array) -> Array:
        """Coordinates (k,) of the places closest to points (k, 2), each on its vertex's path."""
        s = self.start + ((points - self._points) * self._tangents).sum(axis=1)
        for k in self._curved:
            s[self.rows[k]] = self.paths[k].coordinates(points[self.rows[k]])
        return np.asarray(s)

    def curves(self, vertices: Array) -> Mapping[int, Curve]:
        """New geometry of the edges on curved paths, for positions (n, 2) of all vertices of the structure.

        Where an end of a path is driven away from it, the last edge follows: the gap is blended along it.
        """
        result: dict[int, Curve] = {}
        for k in self._curved:
            path = self.paths[k]
            at = vertices[list(path.vertices)]
            s = path.coordinates(at)
            gap = at - path.points(s)
            gap[np.hypot(gap[:, 0], gap[:, 1]) <= _ON_PATH * path.length] = 0.0
            for place, part in enumerate(path.edges):
                start, stop = float(s[place]), float(s[place + 1])
                if path.closed:  # the coordinate of a vertex is known but for the length of the whole path
                    stop = start + (stop - start) % path.length
                curve: Curve = path.part(place, start, stop)
                if gap[place : place + 2].any():
                    ends = gap[place : place + 2] if part.forward else gap[place : place + 2][::-1]
                    curve = Displaced(curve, *((float(x), float(y)) for x, y in ends))
                result[part.edge] = curve
        return result


def sliding_vertices(structure: BlockStructure, edges: Sequence[int] | Index, driven: Index) -> Index:
    """Vertices that can slide along some boundary edges: those between two of them that meet smoothly.

    Parameters
    ----------
    structure : BlockStructure
    edges : sequence of int
        Edges of the boundary, as of a named group: a side of a box, all walls of a channel.
    driven : ndarray
        Driven vertices, which are left out.

    Returns
    -------
    ndarray
        Ascending. Ends of the sides and vertices where the boundary turns are not among them.
    """
    chosen = {int(edge) for edge in edges}
    found = [
        vertex
        for vertex, at in _boundary_edges(structure).items()
        if len(at) == 2 and chosen.issuperset(at) and vertex not in driven and _turn(structure, vertex, at) <= _SMOOTH
    ]
    return np.array(sorted(found), dtype=np.int64)


def _boundary_edges(structure: BlockStructure) -> dict[int, list[int]]:
    """Edges of the boundary at each of its vertices."""
    topology = structure.topology
    found: dict[int, list[int]] = {}
    for edge in np.flatnonzero(topology.blocks_per_edge == 1).tolist():
        for vertex in topology.edges[edge].tolist():
            found.setdefault(vertex, []).append(edge)
    return found


def _check_smooth(structure: BlockStructure, vertex: int, edges: list[int]) -> None:
    name = structure.topology.vertex_names[vertex]
    if len(edges) != 2:
        raise MoverError(
            f"sliding: {len(edges)} edges of the boundary meet at vertex '{name}'; expected two, between which it can "
            "slide. Remove it."
        )
    angle = _turn(structure, vertex, edges)
    if not angle <= _SMOOTH:
        raise MoverError(
            f"sliding: the boundary turns by {angle:.3g}° at vertex '{name}'; a vertex can slide only where it is "
            f"smooth (within {_SMOOTH:g}°). Remove the vertex, or straighten the curves there."
        )


def _turn(structure: BlockStructure, vertex: int, edges: list[int]) -> float:
    """Angle in degrees by which the boundary turns at a vertex from one of two edges to the other."""
    directions = []
    for edge in edges:
        tangents = curve_end_tangents(structure, edge)
        first = structure.topology.edges[edge, 0] == vertex
        directions.append(tangents[0] if first else -tangents[1])
    (ax, ay), (bx, by) = directions
    return float(np.degrees(np.arctan2(abs(ax * by - ay * bx), -(ax * bx + ay * by))))


def _path(structure: BlockStructure, vertex: int, slides: set[int], edges_at: dict[int, list[int]]) -> SlidingPath:
    """The path through a vertex: edges to both sides up to vertices that do not slide."""
    backward, forward = edges_at[vertex]
    ahead, vertices = _walk(structure, vertex, forward, slides, edges_at)
    if vertices[-1] == vertex:
        edges = ahead
    else:
        behind, before = _walk(structure, vertex, backward, slides, edges_at)
        edges = [*behind[::-1], *ahead]
        vertices = [*before[:0:-1], *vertices]
    parts = tuple(
        PathEdge(
            edge,
            bool(structure.topology.edges[edge, 0] == start),
            structure.vertices[structure.topology.edges[edge]],
            structure.curves.get(edge),
        )
        for edge, start in zip(edges, vertices, strict=False)
    )
    return SlidingPath(parts, tuple(vertices))


def _walk(
    structure: BlockStructure, vertex: int, edge: int, slides: set[int], edges_at: dict[int, list[int]]
) -> tuple[list[int], list[int]]:
    """Edges and vertices met from a vertex along an edge, until one that does not slide or the start again."""
    edges, vertices = [edge], [vertex]
    while True:
        first, second = structure.topology.edges[edge].tolist()
        here = second if first == vertices[-1] else first
        vertices.append(here)
        if here not in slides or here == vertex:
            return edges, vertices
        edge = next(other for other in edges_at[here] if other != edge)
        edges.append(edge)


def _is_straight(structure: BlockStructure, path: SlidingPath) -> bool:
    if path.closed or any(part.curve is not None for part in path.edges):
        return False
    points = structure.vertices[list(path.vertices)] - structure.vertices[path.vertices[0]]
    across = points[:, 0] * points[-1, 1] - points[:, 1] * points[-1, 0]
    return bool((np.abs(across) <= _STRAIGHT * (points[-1] @ points[-1])).all())
