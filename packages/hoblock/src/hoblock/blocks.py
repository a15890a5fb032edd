"""Block structures: vertices, conforming quads, their edges, chains and names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from hoblock import topology_checks as checks
from hoblock.curves import Curve, NodalCurve, reverse, with_ends
from hoblock.errors import CurveError, GradingError, TopologyError
from hoblock.grading import Grading, Uniform, node_parameters
from hoblock.grading import Reversed as ReversedGrading
from hoblock.orientation import orient
from hoblock.spelling import did_you_mean
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Thing = TypeVar("Thing")

__all__ = ["BlockStructure"]


@dataclass(frozen=True, eq=False)
class BlockStructure:
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
    gradings: tuple[Grading, ...]

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
        counts: Mapping[tuple[str | int, str | int], int] | int = 1,
        edges: Mapping[str, Iterable[tuple[str | int, str | int]]] | None = None,
        curves: Mapping[tuple[str | int, str | int], Curve] | None = None,
        gradings: Mapping[tuple[str | int, str | int], Grading] | None = None,
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
        number = {name: k for k, name in enumerate(names)}

        def vertex(key: str | int, place: str) -> int:
            name = str(key)
            if name not in number:
                raise TopologyError(f"{place}: no vertex named '{name}'{did_you_mean(name, names)}")
            return number[name]

        grouped = blocks if isinstance(blocks, Mapping) else {"blocks": blocks}
        quads, groups = checks.quad_table(grouped, vertex)
        checks.check_counter_clockwise(quads, groups, names, positions)
        topology_edges, block_edges, chains, rotation = orient(quads, names)
        quads = np.take_along_axis(quads, (np.arange(4) + rotation[:, None]) % 4, axis=1)
        topology = BlockTopology(
            names, quads, topology_edges, block_edges, chains, np.ones(len(chains), dtype=np.int64), groups, {}
        )
        curved = _directed(topology, curves or {}, vertex, "curves", reverse)
        graded = _directed(topology, gradings or {}, vertex, "gradings", ReversedGrading)
        checks.check_geometry(topology, positions, frozenset(curved))
        named = {name: _named(topology, pairs, vertex, f"edges.{name}") for name, pairs in (edges or {}).items()}
        asked = {}
        if isinstance(counts, Mapping):
            for pair, number_of_elements in counts.items():
                first, second = checks.edge_pair(pair, "counts")
                asked[vertex(first, "counts"), vertex(second, "counts")] = number_of_elements
        else:
            default_count = checks.element_count(counts, "counts")
        per_edge = checks.chain_counts(topology, asked, default_count)
        topology = replace(topology, counts=per_edge, edge_groups=named)
        _check_ends(topology, positions, curved)
        gradings_by_edge = tuple(graded.get(k, Uniform()) for k in range(len(topology_edges)))
        return BlockStructure(topology, positions, curved, gradings_by_edge)

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
        replaced = dict(curves or {})
        for edge in replaced:
            if not isinstance(edge, int | np.integer) or not 0 <= edge < len(self.topology.edges):
                raise TopologyError(
                    f"moved: curves has the key {edge!r}; expected edge numbers from 0 to "
                    f"{len(self.topology.edges) - 1}. Use topology.edge(first, second)."
                )
        _check_ends(self.topology, vertices, replaced)
        shift = vertices - self.vertices
        result: dict[int, Curve] = {}
        for edge, curve in self.curves.items():
            first, second = self.topology.edges[edge]
            if edge in replaced:
                continue
            if shift[first].any() or shift[second].any():
                if isinstance(curve, NodalCurve):
                    result[edge] = self._displaced_nodes(edge, curve, shift)
                    continue
                curve = with_ends(curve, (shift[first], shift[second]), (vertices[first], vertices[second]))
            result[edge] = curve
        result.update(replaced)
        return BlockStructure(self.topology, vertices, result, self.gradings)

    def _displaced_nodes(self, edge: int, curve: NodalCurve, shift: Array) -> NodalCurve:
        """Nodes of an edge with the displacement of its ends blended by their parameters."""
        t = node_parameters(self.gradings[edge], curve.count, curve.order)[:, None]
        first, second = self.topology.edges[edge]
        return NodalCurve(curve.points + (1.0 - t) * shift[first] + t * shift[second], curve.order)

    def restricted(self, groups: Iterable[str]) -> BlockStructure:
        """Return the part made of some block groups; edges keep their direction, names and numbers of elements.

        Raises
        ------
        TopologyError
            If a group does not exist.
        """
        topology = self.topology
        blocks = self._blocks_of(groups)
        edges = np.unique(topology.block_edges[blocks])
        vertices = np.unique(topology.quads[blocks])
        new_block, new_edge, new_vertex = (
            np.full(size, -1) for size in (len(topology.quads), len(topology.edges), len(self.vertices))
        )
        new_block[blocks], new_edge[edges], new_vertex[vertices] = (
            np.arange(len(kept)) for kept in (blocks, edges, vertices)
        )

        def kept(groups: Mapping[str, Index], renumber: Index) -> dict[str, Index]:
            inside = {name: renumber[members] for name, members in groups.items()}
            return {name: members[members >= 0] for name, members in inside.items() if (members >= 0).any()}

        part = BlockTopology(
            tuple(topology.vertex_names[v] for v in vertices),
            new_vertex[topology.quads[blocks]],
            new_vertex[topology.edges[edges]],
            new_edge[topology.block_edges[blocks]],
            np.unique(topology.chains[edges], return_inverse=True)[1].astype(np.int64),
            topology.counts[edges],
            kept(topology.block_groups, new_block),
            kept(topology.edge_groups, new_edge),
        )
        curves = {int(new_edge[edge]): curve for edge, curve in self.curves.items() if new_edge[edge] >= 0}
        return BlockStructure(part, self.vertices[vertices], curves, tuple(self.gradings[k] for k in edges))

    def _blocks_of(self, groups: Iterable[str]) -> Index:
        groups = (groups,) if isinstance(groups, str) else groups
        known = self.topology.block_groups
        members = []
        for name in groups:
            if name not in known:
                raise TopologyError(f"no group of blocks named '{name}'{did_you_mean(name, known)}")
            members.append(known[name])
        if not members:
            raise TopologyError(f"no group of blocks was asked for; expected some of: {', '.join(known)}.")
        return np.unique(np.concatenate(members))

    def with_edge_group(self, name: str, edges: Sequence[int] | Index) -> BlockStructure:
        """Return the structure with one more group of named edges, replacing one of that name.

        Raises
        ------
        TopologyError
            If there are no edges, one does not exist, or one is listed twice.
        """
        members = np.array(edges)
        count = len(self.topology.edges)
        whole = members.ndim == 1 and members.size > 0 and np.issubdtype(members.dtype, np.integer)
        if not whole or members.min() < 0 or members.max() >= count or len(np.unique(members)) < len(members):
            raise TopologyError(
                f"edges.{name}: {members.tolist()}; expected numbers of edges from 0 to {count - 1}, at least one, "
                "none twice."
            )
        groups = {**self.topology.edge_groups, name: members.astype(np.int64)}
        return replace(self, topology=replace(self.topology, edge_groups=groups))

    def shared_edges(self, first: Iterable[str], second: Iterable[str]) -> Index:
        """Return the edges that have a block of one set of groups on one side and of the other on the other."""
        touching = [np.unique(self.topology.block_edges[self._blocks_of(names)]) for names in (first, second)]
        return np.asarray(np.intersect1d(touching[0], touching[1]), dtype=np.int64)


def _named(
    topology: BlockTopology,
    pairs: Iterable[tuple[str | int, str | int]],
    vertex: Callable[[str | int, str], int],
    place: str,
) -> Index:
    """Edges between pairs of vertices, each once."""
    ends = [checks.edge_pair(pair, place) for pair in pairs]
    edges = np.array([topology.edge(vertex(a, place), vertex(b, place))[0] for a, b in ends], dtype=np.int64)
    if not edges.size:
        raise TopologyError(f"{place}: no edges; expected at least one pair of vertices. Remove the name.")
    found, uses = np.unique(edges, return_counts=True)
    if (uses > 1).any():
        raise TopologyError(f"{place}: edge {topology.edge_name(int(found[uses > 1][0]))} is listed twice. Remove one.")
    return edges


def _directed(
    topology: BlockTopology,
    pairs: Mapping[tuple[str | int, str | int], Thing],
    vertex: Callable[[str | int, str], int],
    place: str,
    reverse: Callable[[Thing], Thing],
) -> dict[int, Thing]:
    """Attach things given by vertex pairs to directed edges, turning those given the other way round."""
    result: dict[int, Thing] = {}
    for pair, thing in pairs.items():
        first, second = checks.edge_pair(pair, place)
        edge, forward = topology.edge(vertex(first, place), vertex(second, place))
        if not callable(thing):
            error = CurveError if place == "curves" else GradingError
            raise error(f"{place}: edge {topology.edge_name(edge)} has {thing!r}; expected a function of t in [0, 1].")
        if edge in result:
            raise TopologyError(f"{place}: edge {topology.edge_name(edge)} is given twice. Remove one.")
        result[edge] = thing if forward else reverse(thing)
    return result


def _check_ends(topology: BlockTopology, vertices: Array, curves: Mapping[int, Curve]) -> None:
    if not curves:
        return
    allowed = checks.tolerance(vertices)
    for edge, curve in curves.items():
        ends = topology.edges[edge]
        found = curve.points[[0, -1]] if isinstance(curve, NodalCurve) else curve(np.array([0.0, 1.0]))
        names = [topology.vertex_names[v] for v in ends]
        checks.check_ends(found, vertices[ends], names, allowed, f"curve on edge {topology.edge_name(edge)}")
