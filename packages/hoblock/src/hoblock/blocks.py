"""Block structures: vertices, conforming quads, their edges, chains and names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import cast

import numpy as np
from numpy.typing import NDArray

from hoblock import edge_tables as tables
from hoblock import topology_checks as checks
from hoblock.assembly import assemble
from hoblock.curves import Curve
from hoblock.edge_shape import edge_shape
from hoblock.edge_tables import Ends
from hoblock.errors import GradingError, TopologyError
from hoblock.frozen_mappings import FrozenMappings
from hoblock.grading import EdgeGrading, Grading
from hoblock.moved_curves import moved_curves
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]


__all__ = ["BlockStructure"]


@dataclass(frozen=True, eq=False)
class BlockStructure(FrozenMappings):
    """A coarse quad mesh whose edges carry geometry and grading.

    Use :meth:`build` to make one; the constructor takes parts that have been checked.

    Attributes
    ----------
    topology : BlockTopology
        Shared by all structures that differ by motion only.
    vertices : ndarray, shape (n, 2)
    curves : mapping of edge to Curve
        In the direction of the topology's edge. Edges without a curve are straight.
    gradings : tuple of Grading
        One for each edge, in the direction of the topology's edge.
    """

    topology: BlockTopology
    vertices: Array
    curves: Mapping[int, Curve]
    gradings: tuple[Grading | EdgeGrading, ...]

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=float)
        vertices.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "curves", MappingProxyType(dict(self.curves)))

    @staticmethod
    def build(
        vertices: Mapping[str, Sequence[float]] | Array,
        blocks: Mapping[str, Iterable[Sequence[str | int]]] | Iterable[Sequence[str | int]],
        *,
        counts: Mapping[Ends, int] | int = 1,
        edges: Mapping[str, Iterable[Ends]] | None = None,
        curves: Mapping[Ends, Curve] | None = None,
        gradings: Mapping[Ends, Grading | EdgeGrading] | None = None,
        default_count: int = 1,
    ) -> BlockStructure:
        """Build and check a block structure.

        Parameters
        ----------
        vertices : mapping of name to (x, y), or ndarray of shape (n, 2)
            Vertices of an array are named by their index.
        blocks : mapping of group to quads, or quads
            Four vertices each, counter-clockwise; by name, or by index for an array.
        counts : mapping of (vertex, vertex) to int, or int
            Elements along an edge; holds for its whole chain.
        edges : mapping of name to edges, optional
            Named edges, each a pair of vertices in either order.
        curves, gradings : mapping of (vertex, vertex) to Curve or Grading, optional
            In the direction of the pair.
        default_count : int
            For chains that ``counts`` does not mention.

        Returns
        -------
        BlockStructure

        Raises
        ------
        TopologyError
            Unknown vertices, inverted or non-convex blocks, non-conforming blocks, conflicting counts.
        CurveError
            A curve that misses its vertices, or is none.
        """
        names, positions = checks.vertex_table(vertices)
        number = checks.vertex_numbers(names)
        quads, groups = checks.quad_table(blocks if isinstance(blocks, Mapping) else {"blocks": blocks}, number)
        if not isinstance(counts, Mapping):
            counts, default_count = {}, checks.element_count(counts, "counts")
        parts = assemble(
            names,
            positions,
            quads,
            groups,
            edge_groups=tables.paths_by_number(edges or {}, number),
            counts=tables.by_number(counts, number, "counts"),
            curves=tables.by_number(curves or {}, number, "curves"),
            gradings=tables.by_number(gradings or {}, number, "gradings"),
            default_count=default_count,
        )
        return BlockStructure(*parts)

    def moved(self, vertices: Array, curves: Mapping[int, Curve] | None = None) -> BlockStructure:
        """Return the structure with other vertex positions, sharing topology and gradings.

        Parameters
        ----------
        vertices : ndarray, shape (n, 2)
        curves : mapping of edge to Curve, optional
            New geometry of some edges, in the topology's direction; it must meet the new vertices. A curved edge that
            is not listed keeps its shape, its ends displaced with its vertices (linear blending); an arc whose
            vertices have moved along its circle is cut anew from it.

        Raises
        ------
        TopologyError
            If the vertices have another shape, or an edge does not exist.
        CurveError
            If a new curve misses its vertices.
        """
        vertices = np.asarray(vertices, dtype=float)
        if vertices.shape != self.vertices.shape:
            raise TopologyError(f"moved: vertices have shape {vertices.shape}; expected {self.vertices.shape}.")
        pair = self.vertices, vertices
        result = moved_curves(self.topology, self.curves, dict(curves or {}), pair, self.resolved_grading)
        tables.check_curve_ends(self.topology, vertices, curves or {})
        return BlockStructure(self.topology, vertices, result, self.gradings)

    def resolved_grading(self, edge: int) -> Grading:
        """Return the grading of an edge; one that depends on the edge is made for its present shape.

        Raises
        ------
        GradingError
            If it does not fit; the error names the edge.
        """
        grading = self.gradings[edge]
        if not isinstance(grading, EdgeGrading):
            return grading
        first, second = self.vertices[self.topology.edges[edge]]
        shape = edge_shape(first, second, self.curves.get(edge))
        try:
            return grading.resolved(shape, int(self.topology.counts[edge]))
        except GradingError as error:
            raise GradingError(f"edge {self.topology.edge_name(edge)}: {error}") from None

    def edge_points(self, edge: int, t: Array) -> Array:
        """Return the points of an edge at parameters ``t`` in [0, 1], shape (n, 2); straight without a curve."""
        t = np.asarray(t, dtype=float)
        if edge in self.curves:
            return np.asarray(self.curves[edge](t), dtype=float)
        first, second = self.vertices[self.topology.edges[edge]]
        return np.asarray((1.0 - t)[:, None] * first + t[:, None] * second)

    def restricted(self, groups: Iterable[str]) -> BlockStructure:
        """Return the part made of some block groups; edges keep their direction, names and numbers of elements.

        Raises
        ------
        TopologyError
            If a group does not exist.
        """
        return self.part(self.topology.blocks_in(groups))

    def part(self, blocks: Index) -> BlockStructure:
        """Return the part made of some blocks, given by number, ascending, each once; see `restricted`."""
        topology, vertices, edges = self.topology.restricted(blocks)
        new_edge = {int(edge): k for k, edge in enumerate(edges)}
        curves = {new_edge[edge]: curve for edge, curve in self.curves.items() if edge in new_edge}
        return BlockStructure(topology, self.vertices[vertices], curves, tuple(self.gradings[k] for k in edges))

    def with_counts(self, counts: Mapping[Ends, int]) -> BlockStructure:
        """Return the structure with other numbers of elements; each holds for the whole chain of its edge.

        Parameters
        ----------
        counts : mapping of (vertex, vertex) to int
            By the names of the vertices. Chains that are not mentioned keep their number.

        Raises
        ------
        TopologyError
            If an edge does not exist, a number is not a positive integer, or two ask for different numbers of one
            chain; the error names both edges and the chain.
        """
        topology = self.topology
        asked = checks.chain_counts(topology, tables.by_number(counts, topology.vertex, "counts"), None)
        return replace(self, topology=replace(topology, counts=np.where(asked > 0, asked, topology.counts)))

    def with_gradings(self, gradings: Mapping[Ends, Grading | EdgeGrading]) -> BlockStructure:
        """Return the structure with other gradings on some edges.

        Parameters
        ----------
        gradings : mapping of (vertex, vertex) to Grading
            By the names of the vertices, in the direction of the pair.

        Raises
        ------
        TopologyError
            If an edge does not exist or is given twice.
        GradingError
            If a grading is none.
        """
        pairs = tables.by_number(gradings, self.topology.vertex, "gradings")
        graded = tables.directed_gradings(self.topology, pairs)
        return replace(self, gradings=tuple(graded.get(k, old) for k, old in enumerate(self.gradings)))

    def with_curves(self, curves: Mapping[Ends, Curve | None]) -> BlockStructure:
        """Return the structure with another geometry of some edges.

        Parameters
        ----------
        curves : mapping of (vertex, vertex) to Curve or None
            By the names of the vertices, in the direction of the pair; None makes the edge straight.

        Raises
        ------
        TopologyError
            If an edge does not exist or is given twice, or a straight edge makes an angle of 180° or more.
        CurveError
            If a curve misses its vertices, or is none.
        """
        topology = self.topology
        pairs = tables.by_number(curves, topology.vertex, "curves")
        straight = {topology.edge(*pair)[0] for pair, curve in pairs.items() if curve is None}
        curved = tables.directed_curves(topology, {pair: curve for pair, curve in pairs.items() if curve is not None})
        if twice := sorted(straight & curved.keys()):
            raise TopologyError(f"curves: edge {topology.edge_name(twice[0])} is given twice. Remove one.")
        kept = {edge: curve for edge, curve in self.curves.items() if edge not in straight}
        tables.check_curve_ends(topology, self.vertices, curved)
        checks.check_geometry(topology, self.vertices, frozenset(kept | curved))
        return replace(self, curves=kept | curved)

    def with_block_group(self, name: str, blocks: Sequence[int] | Index) -> BlockStructure:
        """Return the structure with one more group of named blocks, replacing one of that name.

        Blocks stay in the other groups they are in; see `without_groups`.

        Raises
        ------
        TopologyError
            If there are no blocks, one does not exist, or one is listed twice.
        """
        return replace(self, topology=self.topology.with_block_group(name, blocks))

    def with_edge_group(self, name: str, edges: Sequence[int] | Sequence[Ends] | Index) -> BlockStructure:
        """Return the structure with one more group of named edges, replacing one of that name.

        Parameters
        ----------
        name : str
        edges : sequence of int, or of (vertex, vertex)
            Edges by number, or each by the names of its vertices in either order.

        Raises
        ------
        TopologyError
            If there are no edges, one does not exist, or one is listed twice.
        """
        pairs = [edge for edge in edges if isinstance(edge, tuple)]
        if not pairs:
            return replace(self, topology=self.topology.with_edge_group(name, cast(Index, edges)))
        numbered = tables.paths_by_number({name: cast(list[Ends], list(edges))}, self.topology.vertex)[name]
        members = tables.edges_between(self.topology, numbered, f"edges.{name}")
        return replace(self, topology=self.topology.with_edge_group(name, members))

    def without_groups(self, *names: str) -> BlockStructure:
        """Return the structure without some names of blocks or edges; the blocks and edges stay.

        Raises
        ------
        TopologyError
            If a name does not exist.
        """
        return replace(self, topology=self.topology.without_groups(*names))

    def shared_edges(self, first: Iterable[str], second: Iterable[str]) -> Index:
        """Return the edges that have a block of one set of groups on one side and of the other on the other."""
        touching = [np.unique(self.topology.block_edges[self.topology.blocks_in(names)]) for names in (first, second)]
        return np.asarray(np.intersect1d(touching[0], touching[1]), dtype=np.int64)
