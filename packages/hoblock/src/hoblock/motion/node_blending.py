"""How all nodes follow the block vertices and the edges that are given node by node: one sparse matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.layout import Batch, Layout
from hoblock.topology import BlockTopology
from hoblock.transfinite import reference_positions

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["NodeBlending", "node_blending"]


@dataclass(frozen=True, eq=False)
class NodeBlending:
    """The transfinite map of all blocks as one matrix, for edges that blend the displacements of their ends linearly.

    Attributes
    ----------
    nodes : ndarray
        Nodes that can move, ascending.
    vertices : ndarray
        Vertices that can move, ascending: the first columns.
    given : ndarray
        Inner nodes of the edges given node by node, edge after edge: the other columns.
    matrix : sparse matrix, shape (len(nodes), len(vertices) + len(given))
        All nodes have a row, perhaps an empty one, where more than half of them can move.
    """

    nodes: Index
    vertices: Index
    given: Index
    matrix: Any

    def moved(self, points: Array, of_vertices: Array, of_given: Array) -> Array:
        """Points (n, 2) of all nodes from those of the reference and displacements of ``vertices`` and ``given``."""
        displacement = self.matrix @ np.concatenate([of_vertices, of_given])
        if len(displacement) == len(points):
            displacement += points
            return np.asarray(displacement)
        result = np.array(points)
        result[self.nodes] += displacement
        return result


def node_blending(plan: Layout, topology: BlockTopology, vertices: Index, given: Sequence[int]) -> NodeBlending:
    """Make the matrix.

    Parameters
    ----------
    plan : Layout
    topology : BlockTopology
    vertices : ndarray
        Vertices that can move, ascending.
    given : sequence of int
        Edges given node by node.
    """
    from scipy.sparse import csr_matrix

    inner = [plan.nodes_of_edge(edge)[1:-1] for edge in given]
    nodes_given = np.concatenate([np.zeros(0, dtype=np.int64), *inner])
    count = len(topology.vertex_names)
    edges = _edge_blending(plan, topology, given, nodes_given)
    inside = [_inner_blending(plan, batch) for batch in plan.batches if batch.patch.stop > batch.patch.start]
    everything = edges
    if inside:
        row, column, value = (np.concatenate([part[k] for part in inside]) for k in range(3))
        everything = edges + csr_matrix((value, (row, column)), shape=(plan.node_count,) * 2) @ edges
    columns = np.concatenate([vertices, np.arange(count, count + len(nodes_given))])
    matrix = everything.tocsc()[:, columns].tocsr()
    matrix.eliminate_zeros()
    nodes = np.flatnonzero(np.diff(matrix.indptr))
    part = matrix if 2 * len(nodes) > plan.node_count else matrix[nodes]
    return NodeBlending(nodes, vertices, nodes_given, part)


def _edge_blending(plan: Layout, topology: BlockTopology, given: Sequence[int], nodes_given: Index) -> Any:
    """Displacements of all nodes on edges by those of all vertices and the given nodes; rows of others are empty."""
    from scipy.sparse import csr_matrix

    lengths = np.diff(plan.edge_offsets)
    edge = np.repeat(np.arange(len(lengths)), lengths)
    ends = np.zeros(len(edge), dtype=bool)
    ends[plan.edge_offsets[:-1]] = ends[plan.edge_offsets[1:] - 1] = True
    blended = ~ends & ~np.isin(edge, np.array(given, dtype=np.int64))
    row, t = plan.edge_nodes[blended], plan.edge_parameters[blended]
    first, second = topology.edges[edge[blended]].T
    count = len(topology.vertex_names)
    rows = np.concatenate([plan.vertex_nodes, row, row, nodes_given])
    columns = np.concatenate([np.arange(count), first, second, count + np.arange(len(nodes_given))])
    values = np.concatenate([np.ones(count), 1.0 - t, t, np.ones(len(nodes_given))])
    return csr_matrix((values, (rows, columns)), shape=(plan.node_count, count + len(nodes_given)))


def _inner_blending(plan: Layout, batch: Batch) -> tuple[Index, Index, Array]:
    """Rows, columns and values of the inner nodes of a batch by the nodes on its edges."""
    weights, patch = batch.weights, batch.patch
    u, v = reference_positions(weights.bottom, weights.top, weights.left, weights.right)
    bottom, top, left, right = (side[batch.members] for side in patch.sides)
    size = patch.rows * patch.columns
    nodes = (patch.start + batch.members[:, None] * size + np.arange(size)).reshape(u.shape)
    parts = [
        (bottom[:, None, 1:-1], 1.0 - v),
        (top[:, None, 1:-1], v),
        (left[:, 1:-1, None], 1.0 - u),
        (right[:, 1:-1, None], u),
        (bottom[:, :1, None], -(1.0 - u) * (1.0 - v)),
        (bottom[:, -1:, None], -u * (1.0 - v)),
        (top[:, -1:, None], -u * v),
        (top[:, :1, None], -(1.0 - u) * v),
    ]
    columns = [np.broadcast_to(column, u.shape).ravel() for column, _ in parts]
    values = [value.ravel() for _, value in parts]
    return np.tile(nodes.ravel(), len(parts)), np.concatenate(columns), np.concatenate(values)
