"""Block edges that inherit the shape of a driven edge they face: a long side of one block bends as a whole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.motion.driven_edges import DrivenEdges

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["InheritedShapes", "inherited_shapes"]

_FEW = 2
"""Blocks along a side of a body up to which the edges that face it inherit its shape."""
_CORNER = 30.0
"""Angle in degrees by which the boundary turns at the ends of a side."""


@dataclass(frozen=True, eq=False)
class InheritedShapes:
    """Inner edges with the shape of a driven edge in the same strip of blocks, less the further they are from it.

    Let r(t) = (x(t) - a)/(b - a) be the shape of a driven edge from a to b, points as complex numbers, and Δr its
    change since the reference. An edge from c to d that inherits it is displaced by φ Δr (d - c) from where it would
    lie otherwise, φ = 1 - (distance from the driven edge)/(distance from it to the boundary), both across the strip.

    Attributes
    ----------
    edges : tuple of int
    sources : ndarray
        For each, the place of the driven edge among the driven ones.
    shares : ndarray
        φ.
    reference : tuple of ndarray
        r of each driven edge in the reference.
    """

    edges: tuple[int, ...]
    sources: Index
    shares: Array
    reference: tuple[NDArray[np.complex128], ...]

    def displacements(self, driven: DrivenEdges, positions: Array, vertices: Array) -> list[Array]:
        """Displacements (m - 2, 2) of the inner nodes of the edges from where blending their ends puts them.

        Parameters
        ----------
        driven : DrivenEdges
        positions : ndarray, shape (k, 2)
            Of the driven nodes.
        vertices : ndarray, shape (n, 2)
            Of all block vertices.
        """
        result = []
        for edge, source, share in zip(self.edges, self.sources.tolist(), self.shares.tolist(), strict=True):
            change = _shape(positions[driven.rows[source]]) - self.reference[source]
            first, second = vertices[driven.topology.edges[edge]]
            chord = complex(*(second - first))
            moved = (share * chord) * change[1:-1]
            result.append(np.stack([moved.real, moved.imag], axis=-1))
        return result


def inherited_shapes(
    structure: BlockStructure, driven: DrivenEdges, positions: Array, which: Literal["auto", "all", "none"]
) -> InheritedShapes:
    """Find the edges that inherit the shape of a driven one.

    Parameters
    ----------
    structure : BlockStructure
    driven : DrivenEdges
    positions : ndarray, shape (k, 2)
        Of the driven nodes in the reference.
    which : {"auto", "all", "none"}
        "auto": those in strips that begin on a side of at most two driven edges.
    """
    reference = tuple(_shape(positions[rows]) for rows in driven.rows)
    found: dict[int, tuple[int, float]] = {}
    if which != "none":
        lengths = _side_lengths(structure, driven)
        middles = structure.vertices[structure.topology.edges].mean(axis=1)
        for k, edge in enumerate(driven.edges):
            if which == "all" or lengths[k] <= _FEW:
                for inner, share in _strip(structure, edge, middles):
                    if inner not in driven.edges and found.get(inner, (0, 0.0))[1] < share:
                        found[inner] = k, share
    edges = tuple(sorted(found))
    return InheritedShapes(
        edges,
        np.array([found[edge][0] for edge in edges], dtype=np.int64),
        np.array([found[edge][1] for edge in edges]),
        reference,
    )


def _shape(nodes: Array) -> NDArray[np.complex128]:
    z = nodes[:, 0] + 1j * nodes[:, 1]
    return np.asarray((z - z[0]) / (z[-1] - z[0]))


def _strip(structure: BlockStructure, edge: int, middles: Array) -> list[tuple[int, float]]:
    """Inner edges met across blocks from a boundary edge to the other boundary, each with its φ."""
    topology = structure.topology
    blocks = np.flatnonzero((topology.block_edges == edge).any(axis=1))
    if len(blocks) != 1:
        return []
    met, distance, block, here = [], [0.0], int(blocks[0]), edge
    while True:
        side = int(np.flatnonzero(topology.block_edges[block] == here)[0])
        after = int(topology.block_edges[block, (side + 2) % 4])
        distance.append(distance[-1] + float(np.hypot(*(middles[after] - middles[here]))))
        here = after
        met.append(here)
        others = np.flatnonzero((topology.block_edges == here).any(axis=1))
        others = others[others != block]
        if not len(others) or here == edge:
            break
        block = int(others[0])
    total = distance[-1]
    return [(inner, 1.0 - d / total) for inner, d in zip(met[:-1], distance[1:-1], strict=True)]


def _side_lengths(structure: BlockStructure, driven: DrivenEdges) -> list[int]:
    """Number of driven edges on the side of the body that each driven edge is on."""
    ends = structure.topology.edges[list(driven.edges)]
    label = list(range(len(ends)))
    for vertex in driven.vertices.tolist():
        at = [k for k in range(len(ends)) if vertex in ends[k]]
        if len(at) == 2 and _turn(structure, ends[at], vertex) <= _CORNER:
            old, new = label[at[1]], label[at[0]]
            label = [new if one == old else one for one in label]
    return [label.count(one) for one in label]


def _turn(structure: BlockStructure, ends: Index, vertex: int) -> float:
    """Angle in degrees between the chords of two edges that meet at a vertex."""
    out = [structure.vertices[pair[pair != vertex][0]] - structure.vertices[vertex] for pair in ends]
    (ax, ay), (bx, by) = out
    return float(np.degrees(np.arctan2(abs(ax * by - ay * bx), -(ax * bx + ay * by))))
