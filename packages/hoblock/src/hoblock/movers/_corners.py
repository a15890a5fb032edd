"""The corners of blocks that moving vertices touch, as functions of the vertices; sums over them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.movers.end_tangents import structure_end_tangents

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BlockCorners", "EdgeVectors", "VertexSums", "block_corners", "edge_vectors"]

_AT, _NEXT, _BEFORE = 0, 1, 2
_ROWS = ((0, _AT, -1.0), (0, _NEXT, 1.0), (1, _AT, -1.0), (1, _BEFORE, 1.0))
"""Edge vector (0 is e, 1 is f), the vertex of the corner it depends on, and how."""


@dataclass(frozen=True, eq=False)
class VertexSums:
    """Sums over corners or edges, whose vectors depend linearly on the positions of k movable vertices.

    Attributes
    ----------
    size : int
        2 k: x and y of each movable vertex.
    gather : sparse matrix, shape (2 k, r C)
        Sums gradients by the r components of C things into those by the movable vertices.
    spread : sparse matrix, shape (r C, 2 k)
        Its transpose: vectors by positions.
    scatter : sparse matrix, shape (q, r² C)
        Sums Hessians into the entries of the Hessian by the movable vertices that can differ from zero.
    pattern : ndarray, shape (q,)
        Their places in it, row after row, ascending.
    """

    size: int
    gather: Any
    spread: Any
    scatter: Any
    pattern: Index

    def gradient(self, of_each: Array) -> Array:
        """Sum of gradients (r, C), shape (2 k,)."""
        return np.asarray(self.gather @ of_each.reshape(-1))

    def vectors(self, positions: Array) -> Array:
        """Share (r C,) of positions (2 k,) of the movable vertices in the vectors."""
        return np.asarray(self.spread @ positions)

    def dense(self, of_each: Array) -> Array:
        """Sum of Hessians (r, r, C), shape (2 k, 2 k)."""
        result = np.zeros(self.size * self.size)
        result[self.pattern] = self.scatter @ of_each.reshape(-1)
        return result.reshape(self.size, self.size)

    def sparse(self, of_each: Array) -> Any:
        """The same as a sparse matrix."""
        from scipy.sparse import csr_matrix

        rows, columns = np.divmod(self.pattern, self.size)
        starts = np.searchsorted(rows, np.arange(self.size + 1))
        return csr_matrix((self.scatter @ of_each.reshape(-1), columns, starts), shape=(self.size, self.size))


@dataclass(frozen=True, eq=False)
class BlockCorners:
    """Corners z = (e, f), e = x_next - x_at + offset, f likewise.

    Attributes
    ----------
    blocks : ndarray, shape (C,)
    vertices : ndarray, shape (C, 3)
        Vertex at the corner, the next one of its block and the one before.
    driven : ndarray, shape (k, 4)
        Edge vectors along driven edges: corner, 0 for e or 1 for f, place of the edge among the driven ones, and 0 or 1
        if the corner is at the edge's first or second vertex.
    offset : ndarray, shape (4, C)
        Tangents of curved edges, as long as the chord, less the chord; in the reference. Kept as they are by edges that
        are not driven, whose shape is blended linearly.
    sums : VertexSums
    """

    blocks: Index
    vertices: Index
    driven: Index
    offset: Array
    sums: VertexSums

    @property
    def count(self) -> int:
        """Number of corners."""
        return len(self.blocks)

    def vectors(self, positions: Array, tangents: Array | None, reference: Array) -> Array:
        """Corners z (4, C) of all vertices' positions (n, 2).

        Parameters
        ----------
        positions : ndarray, shape (n, 2)
        tangents : ndarray, shape (m, 2, 2), or None
            Unit end tangents of the driven edges. None: they turn with the chords of their edges.
        reference : ndarray, shape (n, 2)
            Positions that the offsets belong to.
        """
        z = self.chords(positions)
        if not self.driven.size:
            return z + self.offset
        corner, which, edge, end = self.driven.T
        chord, row = self._driven_chords(z), 2 * which
        if tangents is None:
            # Complex numbers turn and stretch the reference's tangent with the chord.
            before = self._driven_chords(self.chords(reference))
            start = before + self._complex(self.offset, row, corner)
            vector = start * chord / before
        else:
            t = tangents[edge, end]
            vector = np.where(end == 0, 1.0, -1.0) * np.abs(chord) * (t[:, 0] + 1j * t[:, 1])
        z = z + self.offset
        z[row, corner], z[row + 1, corner] = vector.real, vector.imag
        return z

    def chords(self, positions: Array) -> Array:
        """Chords of the edges at the corners, (4, C); also of displacements and velocities."""
        at, after, before = (positions[self.vertices[:, k]] for k in range(3))
        return np.concatenate([(after - at).T, (before - at).T])

    def velocities(self, positions: Array, velocity: Array, tangents: Array, tangent_velocity: Array) -> Array:
        """Time derivatives (4, C) of `vectors` for velocities of the vertices and of the driven edges' tangents."""
        dz = self.chords(velocity)
        if not self.driven.size:
            return dz
        corner, which, edge, end = self.driven.T
        row = 2 * which
        chord, change = self._driven_chords(self.chords(positions)), self._driven_chords(dz)
        length = np.abs(chord)
        stretch = (chord.real * change.real + chord.imag * change.imag) / length
        t, dt = (a[edge, end, 0] + 1j * a[edge, end, 1] for a in (tangents, tangent_velocity))
        vector = np.where(end == 0, 1.0, -1.0) * (stretch * t + length * dt)
        dz[row, corner], dz[row + 1, corner] = vector.real, vector.imag
        return dz

    def _driven_chords(self, z: Array) -> NDArray[np.complex128]:
        return self._complex(z, 2 * self.driven[:, 1], self.driven[:, 0])

    @staticmethod
    def _complex(z: Array, row: Index, corner: Index) -> NDArray[np.complex128]:
        return np.asarray(z[row, corner] + 1j * z[row + 1, corner])


@dataclass(frozen=True, eq=False)
class EdgeVectors:
    """Chords of the block edges that moving vertices touch.

    Attributes
    ----------
    vertices : ndarray, shape (m, 2)
    sums : VertexSums
    """

    vertices: Index
    sums: VertexSums

    def vectors(self, positions: Array) -> Array:
        """Chords (2, m)."""
        return np.asarray((positions[self.vertices[:, 1]] - positions[self.vertices[:, 0]]).T)


def block_corners(structure: BlockStructure, movable: Index, driven_edges: Index, tangents: Array) -> BlockCorners:
    """Collect the corners that depend on movable vertices.

    Parameters
    ----------
    structure : BlockStructure
    movable : ndarray
        Vertices that move, ascending.
    driven_edges : ndarray, shape (m,)
    tangents : ndarray, shape (m, 2, 2)
        Their unit end tangents in the reference.
    """
    topology = structure.topology
    unknown = np.full(len(structure.vertices), -1)
    unknown[movable] = np.arange(len(movable))
    corner = np.stack(
        [topology.quads, np.roll(topology.quads, -1, axis=1), np.roll(topology.quads, 1, axis=1)], axis=-1
    )
    sides = np.stack([topology.block_edges, np.roll(topology.block_edges, 1, axis=1)], axis=-1)
    blocks, k = np.nonzero((unknown[corner] >= 0).any(axis=2))
    vertices, edges = corner[blocks, k], sides[blocks, k]
    place = np.full(len(topology.edges), -1)
    place[driven_edges] = np.arange(len(driven_edges))
    driven = np.array(
        [
            (c, which, place[edges[c, which]], int(topology.edges[edges[c, which], 0] != vertices[c, 0]))
            for c, which in zip(*np.nonzero(place[edges] >= 0), strict=True)
        ],
        dtype=np.int64,
    ).reshape(-1, 4)
    offset = _offsets(structure, vertices, edges, place, tangents)
    sums = _vertex_sums(unknown[vertices], _ROWS, 2, len(movable))
    return BlockCorners(blocks, vertices, driven, offset, sums)


def edge_vectors(structure: BlockStructure, movable: Index) -> EdgeVectors:
    """Collect the edges that depend on movable vertices."""
    unknown = np.full(len(structure.vertices), -1)
    unknown[movable] = np.arange(len(movable))
    edges = structure.topology.edges
    vertices = edges[(unknown[edges] >= 0).any(axis=1)]
    sums = _vertex_sums(unknown[vertices], ((0, 0, -1.0), (0, 1, 1.0)), 1, len(movable))
    return EdgeVectors(vertices, sums)


def _offsets(structure: BlockStructure, vertices: Index, edges: Index, place: Index, tangents: Array) -> Array:
    """Tangents of curved edges, as long as their chords, less the chords, (4, C)."""
    offset = np.zeros((4, len(vertices)))
    curved = [edge for edge in np.unique(edges).tolist() if edge in structure.curves or place[edge] >= 0]
    known = dict(zip(curved, structure_end_tangents(structure, curved), strict=True))
    for edge in curved:
        ends = tangents[place[edge]] if place[edge] >= 0 else known[edge]
        first, second = structure.vertices[structure.topology.edges[edge]]
        chord = second - first
        length = float(np.hypot(*chord))
        for which in range(2):
            for c in np.flatnonzero(edges[:, which] == edge):
                at_first = vertices[c, 0] == structure.topology.edges[edge, 0]
                vector = length * ends[0] - chord if at_first else -length * ends[1] + chord
                offset[2 * which : 2 * which + 2, c] = vector
    return offset


def _vertex_sums(unknown: Index, rows: tuple[tuple[int, int, float], ...], vectors: int, count: int) -> VertexSums:
    """Sums over things that depend on vertices.

    Parameters
    ----------
    unknown : ndarray, shape (C, s)
        Numbers of the vertices each thing depends on among the movable ones, -1 for others.
    rows : tuple of (vector, vertex, factor)
        How its vectors depend on them.
    vectors : int
        Number of its vectors.
    count : int
        Number of movable vertices.
    """
    from scipy.sparse import csr_matrix

    size, m = 2 * vectors, len(unknown)
    things = np.arange(m)
    terms = [
        (2 * vector + d, 2 * unknown[:, vertex] + d, unknown[:, vertex] >= 0, factor)
        for vector, vertex, factor in rows
        for d in range(2)
    ]
    row = np.concatenate([dof[moves] for _, dof, moves, _ in terms])
    column = np.concatenate([component * m + things[moves] for component, _, moves, _ in terms])
    factors = np.concatenate([np.full(int(moves.sum()), factor) for *_, moves, factor in terms])
    gather = csr_matrix((factors, (row, column)), shape=(2 * count, size * m))
    pairs = [(a, b, a[2] & b[2]) for a in terms for b in terms]
    keys = np.concatenate([a[1][both] * (2 * count) + b[1][both] for a, b, both in pairs])
    column = np.concatenate([(a[0] * size + b[0]) * m + things[both] for a, b, both in pairs])
    factors = np.concatenate([np.full(int(both.sum()), a[3] * b[3]) for a, b, both in pairs])
    pattern, row = np.unique(keys, return_inverse=True)
    scatter = csr_matrix((factors, (row, column)), shape=(len(pattern), size**2 * m))
    return VertexSums(2 * count, gather, gather.T.tocsr(), scatter, pattern)
