"""The topology of a block structure: quads, directed edges, chains, element counts and names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import TopologyError
from hoblock.frozen_mappings import FrozenMappings
from hoblock.spelling import did_you_mean

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BlockTopology", "connected"]


@dataclass(frozen=True, eq=False)
class BlockTopology(FrozenMappings):
    """What does not change when blocks move: quads, directed edges, chains, element counts, names.

    Attributes
    ----------
    vertex_names : tuple of str
    quads : ndarray, shape (b, 4)
        Vertices of each block, counter-clockwise, from the vertex both of whose edges leave it.
    edges : ndarray, shape (m, 2)
        First and second vertex of each block edge; opposite edges of a block are parallel.
    block_edges : ndarray, shape (b, 4)
        Edges of each block: bottom, right, top, left (sides 0 to 3).
    chains : ndarray, shape (m,)
        Chain of each edge.
    counts : ndarray, shape (m,)
        Number of elements along each edge, equal in a chain.
    block_groups, edge_groups : mapping of str to ndarray
        Named blocks and named edges.
    """

    vertex_names: tuple[str, ...]
    quads: Index
    edges: Index
    block_edges: Index
    chains: Index
    counts: Index
    block_groups: Mapping[str, Index]
    edge_groups: Mapping[str, Index]
    _edge_of: Mapping[tuple[int, int], int] = field(init=False, repr=False)
    _vertex_of: Mapping[str, int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for array in (self.quads, self.edges, self.block_edges, self.chains, self.counts):
            array.setflags(write=False)
        for groups in (self.block_groups, self.edge_groups):
            for array in groups.values():
                array.setflags(write=False)
        lookup = {(a, b): k for k, (a, b) in enumerate(self.edges.tolist())}
        object.__setattr__(self, "_edge_of", MappingProxyType(lookup))
        object.__setattr__(self, "_vertex_of", MappingProxyType({name: k for k, name in enumerate(self.vertex_names)}))

    @property
    def blocks_per_edge(self) -> Index:
        """Number of blocks at each edge: 1 on the boundary, 2 inside."""
        return np.bincount(self.block_edges.ravel(), minlength=len(self.edges))

    @property
    def boundary_vertices(self) -> Index:
        """Vertices on the boundary, ascending."""
        return np.unique(self.edges[self.blocks_per_edge == 1])

    @property
    def opposite_edges(self) -> Index:
        """Pairs of edges that face each other across a block, shape (2 b, 2): bottom and top, left and right."""
        return np.concatenate([self.block_edges[:, [0, 2]], self.block_edges[:, [3, 1]]])

    def vertex(self, name: str | int, place: str = "") -> int:
        """Return the index of a vertex by name; ``place`` begins the message if there is none.

        Raises
        ------
        TopologyError
            If there is no such vertex.
        """
        if str(name) not in self._vertex_of:
            where = f"{place}: " if place else ""
            raise TopologyError(f"{where}no vertex named '{name}'{did_you_mean(str(name), self.vertex_names)}")
        return self._vertex_of[str(name)]

    def find_edge(self, first: int, second: int) -> int | None:
        """Return the edge between two vertices, in either direction, or None."""
        found = self._edge_of.get((first, second))
        return self._edge_of.get((second, first)) if found is None else found

    def edge(self, first: int, second: int) -> tuple[int, bool]:
        """Return the edge between two vertices and whether it runs from ``first`` to ``second``.

        Raises
        ------
        TopologyError
            If no block has that edge.
        """
        if (first, second) in self._edge_of:
            return self._edge_of[first, second], True
        if (second, first) in self._edge_of:
            return self._edge_of[second, first], False
        names = self.vertex_names
        raise TopologyError(
            f"no block edge joins '{names[first]}' and '{names[second]}'. Name two corners of one side of a block."
        )

    def block(self, key: int | str) -> int:
        """Return the number of a block: given itself, or as the name of a group of this block alone.

        Raises
        ------
        TopologyError
            If there is no such block, or the group has several.
        """
        count = len(self.quads)
        if isinstance(key, str):
            members = self.blocks_in(key)
            if len(members) > 1:
                raise TopologyError(
                    f"the group '{key}' has {len(members)} blocks, {', '.join(map(str, members))}; give one by number."
                )
            return int(members[0])
        if isinstance(key, bool) or not isinstance(key, int | np.integer) or not 0 <= key < count:
            raise TopologyError(f"no block {key!r}; expected a number from 0 to {count - 1}, or the name of a group.")
        return int(key)

    def blocks_in(self, groups: Iterable[str] | str) -> Index:
        """Return the blocks of one group or of several, ascending, each once.

        Raises
        ------
        TopologyError
            If a group does not exist, or none is given.
        """
        members = []
        for name in (groups,) if isinstance(groups, str) else groups:
            if name not in self.block_groups:
                raise TopologyError(f"no group of blocks named '{name}'{did_you_mean(name, self.block_groups)}")
            members.append(self.block_groups[name])
        if not members:
            raise TopologyError(f"no group of blocks was asked for; expected some of: {', '.join(self.block_groups)}.")
        return np.unique(np.concatenate(members))

    def restricted(self, blocks: Index) -> tuple[BlockTopology, Index, Index]:
        """Return the topology of some blocks, with their vertices and edges as numbered here.

        Edges keep their direction, names and numbers of elements. A chain that falls apart becomes several.

        Parameters
        ----------
        blocks : ndarray
            Ascending, each once.
        """
        edges, vertices = np.unique(self.block_edges[blocks]), np.unique(self.quads[blocks])
        new_block, new_edge, new_vertex = (
            np.full(size, -1) for size in (len(self.quads), len(self.edges), len(self.vertex_names))
        )
        new_block[blocks], new_edge[edges], new_vertex[vertices] = (
            np.arange(len(kept)) for kept in (blocks, edges, vertices)
        )
        part = BlockTopology(
            tuple(self.vertex_names[v] for v in vertices),
            new_vertex[self.quads[blocks]],
            new_vertex[self.edges[edges]],
            new_edge[self.block_edges[blocks]],
            np.zeros(len(edges), dtype=np.int64),
            self.counts[edges],
            _inside(self.block_groups, new_block),
            _inside(self.edge_groups, new_edge),
        )
        return replace(part, chains=connected(len(edges), part.opposite_edges)), vertices, edges

    def with_block_group(self, name: str, blocks: Sequence[int] | Index) -> BlockTopology:
        """Return the topology with one more group of named blocks; see `BlockStructure.with_block_group`."""
        members = _members(blocks, len(self.quads), f"blocks.{name}", "blocks")
        return replace(self, block_groups={**self.block_groups, name: members})

    def with_edge_group(self, name: str, edges: Sequence[int] | Index) -> BlockTopology:
        """Return the topology with one more group of named edges; see `BlockStructure.with_edge_group`."""
        members = _members(edges, len(self.edges), f"edges.{name}", "edges")
        return replace(self, edge_groups={**self.edge_groups, name: members})

    def without_groups(self, *names: str) -> BlockTopology:
        """Return the topology without some names; see `BlockStructure.without_groups`."""
        known = (*self.block_groups, *self.edge_groups)
        for name in names:
            if name not in known:
                raise TopologyError(f"no group of blocks or edges named '{name}'{did_you_mean(name, known)}")
        blocks, edges = (
            {name: members for name, members in groups.items() if name not in names}
            for groups in (self.block_groups, self.edge_groups)
        )
        return replace(self, block_groups=blocks, edge_groups=edges)

    def edge_name(self, edge: int) -> str:
        """Return 'first–second' with the names of the edge's vertices."""
        first, second = self.edges[edge]
        return f"{self.vertex_names[first]}–{self.vertex_names[second]}"

    def block_name(self, block: int) -> str:
        """Return the block's place and vertices for messages, as in 'blocks.fluid[3] (a, b, c, d)'."""
        corners = ", ".join(self.vertex_names[v] for v in self.quads[block])
        for name, members in self.block_groups.items():
            if block in members:
                return f"blocks.{name}[{int(np.flatnonzero(members == block)[0])}] ({corners})"
        return f"block {block} ({corners})"


def _members(members: Sequence[int] | Index, count: int, place: str, things: str) -> Index:
    """Numbers of blocks or edges: at least one, of ``count`` there are, none twice."""
    found = np.array(members)
    whole = found.ndim == 1 and found.size > 0 and np.issubdtype(found.dtype, np.integer)
    if not whole or found.min() < 0 or found.max() >= count or len(np.unique(found)) < len(found):
        raise TopologyError(
            f"{place}: {found.tolist()}; expected numbers of {things} from 0 to {count - 1}, at least one, none twice."
        )
    return found.astype(np.int64)


def _inside(groups: Mapping[str, Index], renumber: Index) -> dict[str, Index]:
    """Members that are left, renumbered; groups without any are left out."""
    renumbered = {name: renumber[members] for name, members in groups.items()}
    return {name: members[members >= 0] for name, members in renumbered.items() if (members >= 0).any()}


def connected(count: int, pairs: Index) -> Index:
    """Classes of ``count`` things of which pairs (n, 2) belong together, numbered by first appearance.

    Parameters
    ----------
    count : int
    pairs : ndarray, shape (n, 2)

    Returns
    -------
    ndarray, shape (count,)
    """
    label = np.arange(count)
    first, second = pairs.T
    while (label[first] != label[second]).any():
        # Classes that touch are joined at their representatives, which are then looked up until they are the last.
        low = np.minimum(label[first], label[second])
        np.minimum.at(label, label[first], low)
        np.minimum.at(label, label[second], low)
        while not np.array_equal(label, label[label]):
            label = label[label]
    return np.asarray(np.unique(label, return_inverse=True)[1], dtype=np.int64)
