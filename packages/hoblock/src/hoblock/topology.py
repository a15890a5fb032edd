"""The topology of a block structure: quads, directed edges, chains, element counts and names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import TopologyError
from hoblock.spelling import did_you_mean

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BlockTopology"]


@dataclass(frozen=True, eq=False)
class BlockTopology:
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

    def vertex(self, name: str) -> int:
        """Return the index of a vertex by name.

        Raises
        ------
        TopologyError
            If there is no such vertex.
        """
        if name not in self._vertex_of:
            raise TopologyError(f"no vertex named '{name}'{did_you_mean(name, self.vertex_names)}")
        return self._vertex_of[name]

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
