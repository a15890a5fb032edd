"""What does not change when blocks move: numbering, connectivity and blending weights of the mesh of a structure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.grading import Grading, node_parameters
from hoblock.numbering import number_nodes
from hoblock.scene import HIGHEST_ORDER
from hoblock.topology import BlockTopology
from hoblock.transfinite import TransfiniteWeights

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Batch", "Layout", "layout"]


@dataclass(frozen=True, eq=False)
class Batch:
    """Blocks of equal size: numbers, nodes of bottom, top, left, right, inner nodes (b, n, m), weights."""

    blocks: Index
    sides: tuple[Index, ...]
    inner: Index
    weights: TransfiniteWeights

    def select(self, some: Index) -> Batch:
        """Return the batch of some of its blocks."""
        sides = tuple(nodes[some] for nodes in self.sides)
        return Batch(self.blocks[some], sides, self.inner[some], self.weights.select(some))


@dataclass(frozen=True, eq=False)
class Layout:
    """Everything about a mesh that does not depend on where the blocks are.

    Attributes
    ----------
    order : int
    cells : ndarray, shape (e, (p + 1)²)
    node_count : int
    block_of_cell : ndarray, shape (e,)
    vertex_nodes : ndarray
        Mesh node of each block vertex.
    edge_offsets : ndarray, shape (m + 1,)
    edge_nodes : ndarray
        Nodes of block edge k, first to second vertex: ``edge_nodes[edge_offsets[k]:edge_offsets[k + 1]]``.
    edge_parameters : ndarray
        Their parameters in [0, 1], gradings included.
    cell_groups, edge_groups : mapping
        As in `QuadMesh`.
    """

    order: int
    cells: Index
    node_count: int
    block_of_cell: Index
    vertex_nodes: Index
    edge_offsets: Index
    edge_nodes: Index
    edge_parameters: Array
    edge_of_entry: Index
    batches: tuple[Batch, ...]
    cell_groups: Mapping[str, Index]
    edge_groups: Mapping[str, Index]

    def nodes_of_edge(self, edge: int) -> Index:
        """Nodes of a block edge from its first to its second vertex, shape (n p + 1,)."""
        return self.edge_nodes[self.edge_offsets[edge] : self.edge_offsets[edge + 1]]


def layout(structure: BlockStructure, order: int) -> Layout:
    """Numbering, connectivity and blending weights of a structure; computed once and shared by moved structures.

    Parameters
    ----------
    structure : BlockStructure
    order : int
        Order p of the elements, 1 to 32.

    Raises
    ------
    ValueError
        If the order is none of these.
    GradingError
        If a grading is not strictly increasing for the number of elements of its edge.
    """
    if isinstance(order, bool) or not isinstance(order, int | np.integer):
        raise ValueError(f"order is {order!r}; expected an integer from 1 to {HIGHEST_ORDER}.")
    if not 1 <= order <= HIGHEST_ORDER:
        raise ValueError(f"order is {order}; expected an integer >= 1 and <= {HIGHEST_ORDER}.")
    known = _LAYOUTS.setdefault(structure.topology, {})
    key = (structure.gradings, int(order))
    if key not in known:
        known[key] = _layout(structure.topology, structure.gradings, int(order))
    return known[key]


# A layout lives as long as its topology: long studies over many structures keep none of them.
_LAYOUTS: WeakKeyDictionary[BlockTopology, dict[tuple[tuple[Grading, ...], int], Layout]] = WeakKeyDictionary()


def _layout(topology: BlockTopology, gradings: tuple[Grading, ...], order: int) -> Layout:
    columns = topology.counts[topology.block_edges[:, 0]]
    rows = topology.counts[topology.block_edges[:, 3]]
    cell_starts = np.concatenate(([0], np.cumsum(columns * rows)))
    corners = _element_corners(topology, columns, rows)
    cells, node_count = number_nodes(corners, order)
    block_nodes = [
        _block_grid(cells[cell_starts[b] : cell_starts[b + 1]], int(columns[b]), int(rows[b]), order)
        for b in range(len(columns))
    ]
    edges = _edge_nodes(topology, block_nodes)
    parameters = _edge_parameters(topology, gradings, order)
    vertex_nodes = np.empty(len(topology.vertex_names), dtype=np.int64)
    vertex_nodes[topology.edges] = [(nodes[0], nodes[-1]) for nodes in edges]
    lengths = np.array([len(nodes) for nodes in edges])
    return Layout(
        order,
        cells,
        node_count,
        np.repeat(np.arange(len(columns)), columns * rows),
        vertex_nodes,
        np.concatenate(([0], np.cumsum(lengths))),
        np.concatenate(edges),
        np.concatenate(parameters),
        np.repeat(np.arange(len(edges)), lengths),
        _batches(topology, block_nodes, parameters),
        {
            name: np.concatenate([np.arange(cell_starts[b], cell_starts[b + 1]) for b in blocks])
            for name, blocks in topology.block_groups.items()
        },
        _edge_groups(topology, columns, rows, cell_starts),
    )


def _element_corners(topology: BlockTopology, columns: Index, rows: Index) -> Index:
    """Corner identities (e, 4) of all elements, block by block."""
    count = len(topology.vertex_names)
    starts = count + np.concatenate(([0], np.cumsum(topology.counts - 1)))
    total = int(starts[-1])
    corners = []
    for block, (vertices, sides) in enumerate(zip(topology.quads, topology.block_edges, strict=True)):
        m, n = int(columns[block]), int(rows[block])
        grid = np.empty((n + 1, m + 1), dtype=np.int64)
        grid[0, 0], grid[0, -1], grid[-1, -1], grid[-1, 0] = vertices
        inner = [np.arange(starts[s], starts[s + 1]) for s in sides]
        grid[0, 1:-1], grid[1:-1, -1], grid[-1, 1:-1], grid[1:-1, 0] = inner
        grid[1:-1, 1:-1] = total + np.arange((n - 1) * (m - 1)).reshape(n - 1, m - 1)
        total += (n - 1) * (m - 1)
        corners.append(np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(-1, 4))
    return np.concatenate(corners)


def _block_grid(cells: Index, columns: int, rows: int, order: int) -> Index:
    """Node numbers of a block as a grid, shape (rows p + 1, columns p + 1)."""
    i, j = np.arange(columns * order + 1), np.arange(rows * order + 1)
    ci, cj = np.minimum(i // order, columns - 1), np.minimum(j // order, rows - 1)
    local = (j - cj * order)[:, None] * (order + 1) + (i - ci * order)
    return np.asarray(cells[cj[:, None] * columns + ci, local])


def _edge_nodes(topology: BlockTopology, block_nodes: list[Index]) -> list[Index]:
    edges: list[Index] = [np.zeros(0, dtype=np.int64)] * len(topology.edges)
    for grid, sides in zip(block_nodes, topology.block_edges, strict=True):
        for side, nodes in zip(sides, (grid[0], grid[:, -1], grid[-1], grid[:, 0]), strict=True):
            edges[side] = nodes
    return edges


def _edge_parameters(topology: BlockTopology, gradings: tuple[Grading, ...], order: int) -> list[Array]:
    """Parameters of the nodes of every edge; edges of equal grading and count share them."""
    known: dict[tuple[Grading, int], Array] = {}
    for edge, key in enumerate(zip(gradings, topology.counts.tolist(), strict=True)):
        if key not in known:
            known[key] = node_parameters(*key, order, f"edge {topology.edge_name(edge)}")
    return [known[key] for key in zip(gradings, topology.counts.tolist(), strict=True)]


def _batches(topology: BlockTopology, block_nodes: list[Index], parameters: list[Array]) -> tuple[Batch, ...]:
    groups: dict[tuple[int, int, bool], list[int]] = {}
    for block, sides in enumerate(topology.block_edges):
        bottom, right, top, left = (parameters[s] for s in sides)
        equal = _same(bottom, top) and _same(left, right)
        groups.setdefault((*block_nodes[block].shape, equal), []).append(block)
    batches = []
    for blocks in groups.values():
        sides = topology.block_edges[blocks]
        bottom, right, top, left = (np.stack([parameters[s] for s in sides[:, k]]) for k in range(4))
        weights = TransfiniteWeights.from_parameters(bottom, top, left, right)
        nodes = np.stack([block_nodes[b] for b in blocks])
        outer = tuple(side.copy() for side in (nodes[:, 0], nodes[:, -1], nodes[:, :, 0], nodes[:, :, -1]))
        inner = np.ascontiguousarray(nodes[:, 1:-1, 1:-1])
        batches.append(Batch(np.array(blocks), outer, inner, weights))
    return tuple(batches)


def _same(first: Array, second: Array) -> bool:
    return first is second or np.array_equal(first, second)


def _edge_groups(topology: BlockTopology, columns: Index, rows: Index, cell_starts: Index) -> dict[str, Index]:
    flat = topology.block_edges.ravel()
    place = np.empty(len(topology.edges), dtype=np.int64)  # first of the block sides on each edge
    place[flat[::-1]] = np.arange(len(flat))[::-1]

    def sides_of(edge: int) -> Index:
        block, side = divmod(int(place[edge]), 4)
        cells = np.arange(cell_starts[block], cell_starts[block + 1]).reshape(rows[block], columns[block])
        along = (cells[0], cells[:, -1], cells[-1], cells[:, 0])[side]
        return np.stack([along, np.full(len(along), side)], axis=-1)

    return {
        name: np.concatenate([sides_of(int(edge)) for edge in edges]) for name, edges in topology.edge_groups.items()
    }
