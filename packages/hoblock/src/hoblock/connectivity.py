"""Numbering of a structure's mesh: vertices, then block edges, then block interiors, each contiguous."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.topology import BlockTopology

Index = NDArray[np.int64]

__all__ = ["Connectivity", "Patch", "connectivity"]


@dataclass(frozen=True, eq=False)
class Patch:
    """Blocks of equal size, whose inner nodes are numbered one after the other.

    Attributes
    ----------
    blocks : ndarray, shape (b,)
    rows, columns : int
        Inner nodes of each block: columns along u (fastest), rows along v.
    start : int
        Number of the first inner node; node (k, j, i) has number ``start + (k rows + j) columns + i``.
    sides : tuple of ndarray
        Nodes of bottom, top (b, columns + 2), left, right (b, rows + 2), corners included.
    """

    blocks: Index
    rows: int
    columns: int
    start: int
    sides: tuple[Index, Index, Index, Index]

    @property
    def stop(self) -> int:
        """Number after that of the last inner node."""
        return self.start + len(self.blocks) * self.rows * self.columns


@dataclass(frozen=True, eq=False)
class Connectivity:
    """Numbers of nodes and elements, from a topology and an order alone.

    Attributes
    ----------
    order : int
    cells : ndarray, shape (e, (p + 1)²)
        Block by block, row by row.
    node_count : int
    cell_starts : ndarray, shape (b + 1,)
        Elements of block k: ``cell_starts[k]`` to ``cell_starts[k + 1]``.
    vertex_nodes : ndarray
        Mesh node of each block vertex.
    edge_offsets : ndarray, shape (m + 1,)
    edge_nodes : ndarray
        Nodes of block edge k, first to second vertex: ``edge_nodes[edge_offsets[k]:edge_offsets[k + 1]]``.
    patches : tuple of Patch
    cell_groups, edge_groups : mapping
        As in `QuadMesh`.
    """

    order: int
    cells: Index
    node_count: int
    cell_starts: Index
    vertex_nodes: Index
    edge_offsets: Index
    edge_nodes: Index
    patches: tuple[Patch, ...]
    cell_groups: Mapping[str, Index]
    edge_groups: Mapping[str, Index]


def connectivity(topology: BlockTopology, order: int) -> Connectivity:
    """Number the nodes and elements of all blocks.

    Numbers inside a block are contiguous and run along its rows, so that a moved block is written as one array.
    """
    columns = topology.counts[topology.block_edges[:, 0]]
    rows = topology.counts[topology.block_edges[:, 3]]
    cell_starts = np.concatenate(([0], np.cumsum(columns * rows)))
    vertex_nodes = np.arange(len(topology.vertex_names))
    offsets, edge_nodes = _edge_nodes(topology, order)
    patches, node_count = _patches(topology, columns * order - 1, rows * order - 1, offsets, edge_nodes)
    cells = np.empty((int(cell_starts[-1]), (order + 1) ** 2), dtype=np.int64)
    for patch in patches:
        _fill_cells(cells, cell_starts, patch, order)
    cells.setflags(write=False)  # meshes share it
    return Connectivity(
        order,
        cells,
        node_count,
        cell_starts,
        vertex_nodes,
        offsets,
        edge_nodes,
        patches,
        {
            name: np.concatenate([np.arange(cell_starts[b], cell_starts[b + 1]) for b in blocks])
            for name, blocks in topology.block_groups.items()
        },
        _edge_groups(topology, columns, rows, cell_starts),
    )


def _edge_nodes(topology: BlockTopology, order: int) -> tuple[Index, Index]:
    """Offsets of the edges and their nodes, both ends included; inner nodes follow those of all vertices."""
    lengths = topology.counts * order + 1
    offsets = np.concatenate(([0], np.cumsum(lengths)))
    edge = np.repeat(np.arange(len(lengths)), lengths)
    first_inner = len(topology.vertex_names) + np.concatenate(([0], np.cumsum(lengths - 2)[:-1]))
    nodes = np.arange(offsets[-1]) - offsets[:-1][edge] + first_inner[edge] - 1
    nodes[offsets[:-1]], nodes[offsets[1:] - 1] = topology.edges.T
    return offsets, nodes


def _patches(
    topology: BlockTopology, columns: Index, rows: Index, offsets: Index, edge_nodes: Index
) -> tuple[tuple[Patch, ...], int]:
    """Gather blocks of equal size, given by their inner nodes, and number these; also the number of all nodes."""
    sizes, kind = np.unique(np.stack([rows, columns], axis=-1), axis=0, return_inverse=True)
    kind = kind.ravel()
    count = len(topology.vertex_names) + int(offsets[-1]) - 2 * len(topology.edges)
    patches = []
    for k, (n, m) in enumerate(sizes.tolist()):
        blocks = np.flatnonzero(kind == k)
        bottom, right, top, left = (offsets[topology.block_edges[blocks, side]] for side in range(4))
        along_u, along_v = np.arange(m + 2), np.arange(n + 2)
        sides = (
            edge_nodes[bottom[:, None] + along_u],
            edge_nodes[top[:, None] + along_u],
            edge_nodes[left[:, None] + along_v],
            edge_nodes[right[:, None] + along_v],
        )
        patches.append(Patch(blocks, n, m, count, sides))
        count = patches[-1].stop
    return tuple(patches), count


def _fill_cells(cells: Index, cell_starts: Index, patch: Patch, order: int) -> None:
    """Write the nodes of all elements of a patch."""
    b, n, m = len(patch.blocks), patch.rows, patch.columns
    grid = np.empty((b, n + 2, m + 2), dtype=np.int64)
    grid[:, 1:-1, 1:-1] = np.arange(patch.start, patch.stop).reshape(b, n, m)
    grid[:, 0], grid[:, -1], grid[:, :, 0], grid[:, :, -1] = patch.sides
    rows, columns = (n + 1) // order, (m + 1) // order
    if b < 32:  # few large blocks: written in place
        for block, numbers in zip(patch.blocks, grid, strict=True):
            elements = cells[cell_starts[block] : cell_starts[block + 1]]
            _copy_windows(numbers[None], elements.reshape(1, rows, columns, order + 1, order + 1))
    else:
        elements = np.empty((b, rows, columns, order + 1, order + 1), dtype=np.int64)
        _copy_windows(grid, elements)
        places = cell_starts[patch.blocks][:, None] + np.arange(rows * columns)
        cells[places.ravel()] = elements.reshape(-1, (order + 1) ** 2)


def _copy_windows(grid: Index, elements: Index) -> None:
    """Copy the nodes of each element from grids (b, rows p + 1, columns p + 1)."""
    size = elements.shape[-1]
    if size > 3:
        windows = np.lib.stride_tricks.sliding_window_view(grid, (size, size), axis=(1, 2))
        elements[...] = windows[:, :: size - 1, :: size - 1]
        return
    rows, columns = elements.shape[1:3]
    for j in range(size):  # small windows are slow to copy; long rows of one local node are not
        for i in range(size):
            stop = j + (rows - 1) * (size - 1) + 1, i + (columns - 1) * (size - 1) + 1
            elements[..., j, i] = grid[:, j : stop[0] : size - 1, i : stop[1] : size - 1]


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
