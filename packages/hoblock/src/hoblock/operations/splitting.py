"""Chains of blocks cut in two, so that the blocks still conform."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, NodalCurve, piece, with_ends
from hoblock.curves.curve import breaks_of
from hoblock.edge_tables import Ends
from hoblock.errors import TopologyError
from hoblock.grading import Pieces, reverse
from hoblock.operations.grading_cuts import AfterElements, AtParameter, Cut, GradingCut
from hoblock.operations.isolines import isoline_curve, isoline_grading, resolved_isoline_grading
from hoblock.operations.structure_tables import Quad, StructureTables
from hoblock.topology_checks import edge_pair, element_count

Array = NDArray[np.float64]

__all__ = ["split"]


def split(
    structure: BlockStructure,
    edge: Ends,
    *,
    after: int | None = None,
    at: float | None = None,
    counts: tuple[int, int] | None = None,
) -> BlockStructure:
    """Cut every block along the chain of an edge in two, so that the blocks still conform.

    Parameters
    ----------
    structure : BlockStructure
    edge : (str, str)
        Its vertices; places and numbers count from the first.
    after : int, optional
        Cut after that many elements. The mesh remains as it is, element for element, where the gradings of opposite
        edges are equal; gradings that depend on their edge are, on the edges cut, replaced by what they give now.
    at : float, optional
        Cut at that parameter, in (0, 1), of every edge in the chain, its curve's parameter t. ``Pieces()`` is kept on
        parts with at least as many elements as pieces.
    counts : (int, int), optional
        With ``at``: elements of the two parts. Otherwise the present number is shared out as the grading of ``edge``
        places them.

    Returns
    -------
    BlockStructure
        New vertices are named after their edges, ``a-b:1``. Parts belong to the groups of what they are part of; the
        new edges inside belong to none and carry the transfinite line between their neighbours, with their grading.

    Raises
    ------
    TopologyError
        If the edge does not exist, or it cannot be cut there.
    """
    topology = structure.topology
    first, second = (topology.vertex(name, "split") for name in edge_pair(edge, "split"))
    number, forward = topology.edge(first, second)
    count = int(topology.counts[number])
    cut = _cut(after, at, counts, count, f"split {edge[0]}–{edge[1]}")
    cut = cut if forward else cut.reversed(count)
    if isinstance(cut, AtParameter):
        cut = cut.with_counts_of(cut.of(structure.resolved_grading(number), count))
    return _ChainCut(structure, int(topology.chains[number]), cut).made()


def _cut(after: int | None, at: float | None, counts: tuple[int, int] | None, count: int, place: str) -> Cut:
    if (after is None) == (at is None):
        raise TopologyError(f"{place}: give either after=… (elements) or at=… (parameter), one of them.")
    if after is not None:
        if counts is not None:
            raise TopologyError(f"{place}: counts go with at=…; after={after} keeps the elements as they are.")
        if isinstance(after, bool) or not isinstance(after, int | np.integer) or not 0 < after < count:
            expected = f"a whole number from 1 to {count - 1}" if count > 1 else "at least 2 to cut between"
            raise TopologyError(
                f"{place}: after={after!r}, the edge has {count} element{'s' * (count != 1)}; expected {expected}. "
                "Give the edge more elements (with_counts), or cut at=…."
            )
        return AfterElements(int(after))
    if isinstance(at, bool) or not isinstance(at, int | float | np.number) or not 0.0 < at < 1.0:
        raise TopologyError(f"{place}: at={at!r}; expected a parameter between 0 and 1.")
    if counts is None:
        return AtParameter(float(at))
    if isinstance(counts, int) or len(counts) != 2:
        raise TopologyError(f"{place}: counts={counts!r}; expected the elements of the two parts.")
    return AtParameter(float(at), (element_count(counts[0], place), element_count(counts[1], place)))


@dataclass(frozen=True)
class _CutEdge:
    """A vertex on an edge of the chain, and where it is along the edge."""

    vertex: int
    place: float


class _ChainCut:
    """One chain of a structure being cut."""

    def __init__(self, structure: BlockStructure, chain: int, cut: Cut) -> None:
        self._structure, self._cut, self._chain = structure, cut, chain
        self._tables = StructureTables.of(structure)

    def made(self) -> BlockStructure:
        """Cut edges, then blocks, and put the structure together."""
        topology, tables = self._structure.topology, self._tables
        cuts = {int(edge): self._cut_edge(int(edge)) for edge in np.flatnonzero(topology.chains == self._chain)}
        for block, (bottom, right, top, left) in enumerate(topology.block_edges.tolist()):
            across_u, across_v = bottom in cuts, left in cuts
            a, b, c, d = topology.quads[block].tolist()
            if across_u and across_v:
                sides = (cuts[bottom], cuts[right], cuts[top], cuts[left])
                tables.pieces[block] = self._quartered((a, b, c, d), (bottom, right, top, left), sides)
            elif across_u:
                m, n = cuts[bottom], cuts[top]
                self._line((left, right), m, n)
                tables.pieces[block] = [(a, m.vertex, n.vertex, d), (m.vertex, b, c, n.vertex)]
            elif across_v:
                m, n = cuts[left], cuts[right]
                self._line((bottom, top), m, n)
                tables.pieces[block] = [(a, b, n.vertex, m.vertex), (m.vertex, n.vertex, c, d)]
        return tables.structure()

    def _cut_edge(self, edge: int) -> _CutEdge:
        structure, tables = self._structure, self._tables
        first, second = structure.topology.edges[edge].tolist()
        grading = self._cut.of(structure.resolved_grading(edge), int(structure.topology.counts[edge]))
        vertex = tables.add_vertex(tables.name_between(first, second), self._position(edge, grading))
        curve = structure.curves.get(edge)
        # Elements that are shared out anew must meet the kinks of each part again.
        kinks = isinstance(self._cut, AtParameter) and structure.gradings[edge] in (Pieces(), reverse(Pieces()))
        self._add_parts(curve, (first, vertex, second), grading, kinks=kinks)
        tables.replace_edge((first, second), [(first, vertex), (vertex, second)])
        return _CutEdge(vertex, grading.place)

    def _position(self, edge: int, grading: GradingCut) -> Array:
        nodal = isinstance(self._structure.curves.get(edge), NodalCurve)
        place = np.array([grading.nodal_place if nodal else grading.place])
        return np.asarray(self._structure.edge_points(edge, place)[0])

    def _add_parts(
        self, curve: Curve | None, vertices: tuple[int, int, int], grading: GradingCut, *, kinks: bool = False
    ) -> None:
        place = grading.nodal_place if isinstance(curve, NodalCurve) else grading.place
        bounds = ((0.0, place), (place, 1.0))
        for k in range(2):
            first, second = vertices[k], vertices[k + 1]
            ends = self._tables.vertices[first], self._tables.vertices[second]
            part = None if curve is None else _meeting(piece(curve, *bounds[k]), ends)
            fits = kinks and grading.counts[k] > len(breaks_of(part))
            self._tables.add_edge((first, second), grading.counts[k], part, Pieces() if fits else grading.parts[k])

    def _line(self, sides: tuple[int, int], start: _CutEdge, stop: _CutEdge) -> None:
        """Add the edge across a block from one cut edge to the opposite one, between two sides."""
        grading = isoline_grading(self._structure, sides, (start.place, stop.place))
        count = int(self._structure.topology.counts[sides[0]])
        pair = (start.vertex, stop.vertex)
        self._tables.add_edge(pair, count, self._isoline(sides, start, stop), grading)

    def _quartered(
        self,
        quad: Quad,
        edges: tuple[int, int, int, int],
        cuts: tuple[_CutEdge, _CutEdge, _CutEdge, _CutEdge],
    ) -> list[Quad]:
        """Cut a block that the chain crosses twice into four."""
        structure, tables = self._structure, self._tables
        (a, b, c, d), (bottom, right, top, left) = quad, edges
        count = int(structure.topology.counts[bottom])
        south, east, north, west = cuts
        lines = (((left, right), south, north), ((bottom, top), west, east))
        gradings = [resolved_isoline_grading(structure, sides, (m.place, n.place)) for sides, m, n in lines]
        halves = [self._cut.of(grading, count) for grading in gradings]
        curves = [self._isoline(*line) for line in lines]
        if curves[0] is None:
            south_end, north_end = (tables.vertices[cut.vertex] for cut in (south, north))
            center = (1.0 - halves[0].place) * south_end + halves[0].place * north_end
        else:
            nodal = isinstance(curves[0], NodalCurve)
            center = curves[0](np.array([halves[0].nodal_place if nodal else halves[0].place]))[0]
        vertex = tables.add_vertex(tables.name_between(a, c), center)
        for (_, m, n), curve, half in zip(lines, curves, halves, strict=True):
            self._add_parts(curve, (m.vertex, vertex, n.vertex), half)
        s, e, t, w = (cut.vertex for cut in cuts)
        return [(a, s, vertex, w), (s, b, e, vertex), (w, vertex, t, d), (vertex, e, c, t)]

    def _isoline(self, sides: tuple[int, int], start: _CutEdge, stop: _CutEdge) -> Curve | None:
        ends = (self._tables.vertices[start.vertex], self._tables.vertices[stop.vertex])
        return isoline_curve(self._structure, sides, (start.place, stop.place), ends)


def _meeting(curve: Curve, ends: tuple[Array, Array]) -> Curve:
    """Return a curve that meets its ends: lines across a block with differently graded sides miss by a little."""
    found = curve.points[[0, -1]] if isinstance(curve, NodalCurve) else curve(np.array([0.0, 1.0]))
    first, second = ends[0] - found[0], ends[1] - found[1]
    if max(np.abs(first).max(), np.abs(second).max()) <= 1e-14 * np.abs(ends).max():
        return curve
    if isinstance(curve, NodalCurve):
        t = np.linspace(0.0, 1.0, len(curve.points))[:, None]
        return NodalCurve(curve.points + (1.0 - t) * first + t * second, curve.order)
    return with_ends(curve, (first, second), ends)
