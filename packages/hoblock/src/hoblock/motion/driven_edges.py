"""Block edges whose nodes are given: the interface of a simulation, or a boundary that moves as prescribed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, NodalCurve
from hoblock.errors import MoverError
from hoblock.layout import layout
from hoblock.movers.end_tangents import nodal_end_tangents
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["DrivenEdges", "driven_edges"]


@dataclass(frozen=True, eq=False)
class DrivenEdges:
    """Block edges whose nodes are given, and those nodes.

    Attributes
    ----------
    topology : BlockTopology
    order : int
    edges : tuple of int
    nodes : ndarray, shape (k,)
        Mesh nodes on the edges, ascending.
    rows : tuple of ndarray
        For each edge, the rows of ``nodes`` along it.
    vertices : ndarray
        Block vertices on the edges, ascending.
    vertex_rows : ndarray
        Their rows in ``nodes``.
    """

    topology: BlockTopology
    order: int
    edges: tuple[int, ...]
    nodes: Index
    rows: tuple[Index, ...]
    vertices: Index
    vertex_rows: Index

    def curves(self, positions: Array) -> Mapping[int, Curve]:
        """The edges' geometry for positions (k, 2) of the nodes."""
        return {edge: NodalCurve(positions[rows], self.order) for edge, rows in zip(self.edges, self.rows, strict=True)}

    def end_rows(self, edges: Sequence[int] | Index) -> Index:
        """Rows of ``nodes`` in the first and in the last element of some of the edges, shape (m, 2 (p + 1)).

        Raises
        ------
        MoverError
            If one of the edges is not driven.
        """
        place = {edge: k for k, edge in enumerate(self.edges)}
        for edge in edges:
            if int(edge) not in place:
                raise MoverError(
                    f"motion: the mover takes the end tangents of edge {self.topology.edge_name(int(edge))}, which is "
                    "not driven; expected driven edges only. Give the mover the driven edges."
                )
        some = (self.rows[place[int(edge)]] for edge in edges)
        ends = [np.concatenate([rows[: self.order + 1], rows[-self.order - 1 :]]) for rows in some]
        return np.array(ends, dtype=np.int64).reshape(-1, 2 * (self.order + 1))

    def tangents(self, positions: Array, end_rows: Index) -> Array:
        """Unit end tangents (m, 2, 2) of the edges of ``end_rows`` for positions (k, 2) of all driven nodes."""
        return nodal_end_tangents(positions[end_rows], self.order)


def driven_edges(structure: BlockStructure, order: int, edges: Sequence[int] | Index) -> DrivenEdges:
    """Collect the nodes and vertices of some block edges.

    Parameters
    ----------
    structure : BlockStructure
    order : int
        Order p of the elements.
    edges : sequence of int
        Numbers of edges, each once.

    Raises
    ------
    MoverError
        If there is no such edge, or one is given twice.
    """
    count = len(structure.topology.edges)
    numbers = [int(edge) for edge in edges]
    if any(not 0 <= edge < count for edge in numbers) or len(set(numbers)) < len(numbers):
        raise MoverError(
            f"driven edges: {numbers}; expected numbers of edges from 0 to {count - 1}, each once. "
            "Use topology.edge(first, second) or topology.edge_groups."
        )
    plan = layout(structure, order)
    along = [plan.nodes_of_edge(edge) for edge in numbers]
    nodes = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *along]))
    vertices = np.unique(structure.topology.edges[numbers])
    return DrivenEdges(
        structure.topology,
        order,
        tuple(numbers),
        nodes,
        tuple(np.searchsorted(nodes, line) for line in along),
        vertices,
        np.searchsorted(nodes, plan.vertex_nodes[vertices]),
    )
