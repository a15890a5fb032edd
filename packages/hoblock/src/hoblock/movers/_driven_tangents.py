"""Unit end tangents of driven edges: those of the reference, and what becomes of them if nobody gives them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers._roles import VertexRoles
from hoblock.movers.end_tangents import structure_end_tangents
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["check_tangents", "driven_tangents", "turned_tangents"]


def driven_tangents(
    structure: BlockStructure, roles: VertexRoles, edges: Index | None, tangents: Array | None
) -> tuple[Index, Array]:
    """Driven edges and their unit end tangents in the reference, checked.

    Parameters
    ----------
    structure : BlockStructure
    roles : VertexRoles
    edges : ndarray or None
        By default the boundary edges between driven vertices.
    tangents : ndarray, shape (len(edges), 2, 2), or None
        By default those of the edges' curves.
    """
    topology = structure.topology
    outer = np.flatnonzero(topology.blocks_per_edge == 1)
    if edges is None:
        edges = outer[np.isin(topology.edges[outer], roles.driven).all(axis=1)]
    else:
        edges = np.array(edges, dtype=np.int64)
        known = edges.ndim == 1 and not (edges.size and (edges.min() < 0 or edges.max() >= len(topology.edges)))
        if not known or not np.isin(topology.edges[edges], roles.driven).all():
            raise MoverError(
                f"barrier: edges are {edges.tolist()}; expected numbers of edges between driven vertices. "
                "Use topology.edge(first, second)."
            )
    if tangents is None:
        return edges, structure_end_tangents(structure, edges)
    tangents = np.array(tangents, dtype=float)
    check_tangents(tangents, edges, topology)
    return edges, tangents


def turned_tangents(
    structure: BlockStructure, edges: Index, tangents: Array, vertices: Array, velocity: Array
) -> tuple[Array, Array]:
    """End tangents of the driven edges that turn with their chords, and their time derivatives."""
    ends = structure.topology.edges[edges]
    chord, change = (a[ends[:, 1]] - a[ends[:, 0]] for a in (vertices, velocity))
    before = structure.vertices[ends[:, 1]] - structure.vertices[ends[:, 0]]
    z, dz, z0 = ((a[:, 0] + 1j * a[:, 1])[:, None] for a in (chord, change, before))
    start = tangents[..., 0] + 1j * tangents[..., 1]
    t = start * (z / np.abs(z)) / (z0 / np.abs(z0))
    dt = t * (1j * (dz * z.conj()).imag / np.abs(z) ** 2)
    return np.stack([t.real, t.imag], axis=-1), np.stack([dt.real, dt.imag], axis=-1)


def check_tangents(tangents: Array, edges: Index, topology: BlockTopology) -> None:
    """Raise for tangents that do not fit the driven edges."""
    if tangents.shape != (len(edges), 2, 2):
        raise MoverError(f"barrier: tangents have shape {tangents.shape}; expected {(len(edges), 2, 2)}.")
    good = np.isfinite(tangents).all(axis=(1, 2))
    if not good.all():
        k = int(np.argmin(good))
        raise MoverError(
            f"barrier: the tangents of edge {topology.edge_name(int(edges[k]))} are {tangents[k].tolist()}; expected "
            "finite numbers. Nodes at its ends coincide, or are not finite."
        )
