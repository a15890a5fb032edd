"""Angles and lengths around the free vertices of a block structure, with their derivatives, in batches.

Points are complex numbers x + i y: the angle from e to f is arg(f ē), its gradient by f is i/f̄.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]

__all__ = ["NormalEquations", "VertexPatches", "vertex_patches"]


@dataclass(frozen=True, eq=False)
class NormalEquations:
    """JᵀJ and Jᵀh of least-squares problems in the plane, one a vertex, from the complex gradients j of the rows of h.

    Attributes
    ----------
    square : ndarray of float, shape (k,)
        Σ |j|², the trace of JᵀJ.
    twist : ndarray of complex, shape (k,)
        Σ j², the part of JᵀJ that is not a multiple of the identity.
    gradient : ndarray of complex, shape (k,)
        Σ j h, the vector Jᵀh.
    """

    square: Array
    twist: Complex
    gradient: Complex

    def step_along(self, tangents: Complex, damping: float) -> Complex:
        """The same where vertices can move along unit tangents only: s = t (tᵀJᵀh)/(tᵀJᵀJ t + damping·tᵀJᵀJ t)."""
        curvature = 0.5 * (self.square + (self.twist * tangents.conj() ** 2).real) * (1.0 + damping)
        slope = (self.gradient * tangents.conj()).real
        return tangents * np.where(curvature > 0.0, slope / np.where(curvature > 0.0, curvature, 1.0), 0.0)

    def step(self, damping: float) -> Complex:
        """Solve (JᵀJ + damping·trace(JᵀJ) I) s = Jᵀh; a singular matrix gives the shortest of its solutions."""
        square = (1.0 + 2.0 * damping) * self.square
        determinant = square * square - np.abs(self.twist) ** 2
        regular = determinant > 1e-12 * square * square
        solution = 2.0 * (square * self.gradient - self.twist * self.gradient.conj())
        shortest = 0.5 * (square * self.gradient + self.twist * self.gradient.conj())  # JᵀJ Jᵀh / trace²
        singular_scale = np.where(square > 0.0, square * square, 1.0)
        return np.where(regular, solution / np.where(regular, determinant, 1.0), shortest / singular_scale)


@dataclass(frozen=True, eq=False)
class VertexPatches:
    """Free vertices of which no two share a block, so that they can be placed at the same time.

    Rows of the same vertex are adjacent; ``first_angle`` and ``first_edge`` are the first rows of each.

    Attributes
    ----------
    vertices : ndarray, shape (k,)
    corner, after, before : ndarray, shape (a,)
        Vertex where the angle is and its two neighbours: the angle is that from ``after - corner``
        counter-clockwise to ``before - corner``.
    by_after, by_before : ndarray, shape (a,)
        Derivative of ``after - corner`` and ``before - corner`` by the vertex that moves: -1, 0 or 1.
    ideal : ndarray, shape (a,)
        Angle D wanted, in radians.
    first_angle : ndarray, shape (k,)
    own, other : ndarray, shape (m,)
        Ends of the edges at each vertex.
    length : ndarray, shape (m,)
        Reference lengths.
    first_edge : ndarray, shape (k,)
    """

    vertices: Index
    corner: Index
    after: Index
    before: Index
    by_after: Array
    by_before: Array
    ideal: Array
    first_angle: Index
    own: Index
    other: Index
    length: Array
    first_edge: Index

    def angles(self, points: Complex) -> tuple[Array, Complex]:
        """Angles in (-90°, 270°] and their gradients by the vertex that moves, both of shape (a,)."""
        corner = points[self.corner]
        e, f = points[self.after] - corner, points[self.before] - corner
        angle = np.angle(f * e.conj())
        angle[angle <= -0.5 * np.pi] += 2.0 * np.pi
        return angle, 1j * (self.by_before / f.conj() - self.by_after / e.conj())

    def angle_errors(self, points: Complex, power: int) -> tuple[Array, Complex]:
        """f = |α - D|^power and its gradients."""
        angle, gradient = self.angles(points)
        error = angle - self.ideal
        slope = power * error ** (power - 1)
        return slope * error / power, slope * gradient

    def length_penalties(
        self, points: Complex, lower: float, upper: float | None, penalty: float
    ) -> tuple[Array, Complex]:
        """g = C (|x - a|² - limit²)² with C = penalty/length⁴ outside the limits, and its gradients.

        ``lower`` and ``upper`` are fractions of the reference lengths.
        """
        edge = points[self.own] - points[self.other]
        relative = (edge.real**2 + edge.imag**2) / self.length**2
        excess = np.minimum(relative - lower**2, 0.0)
        if upper is not None:
            excess += np.maximum(relative - upper**2, 0.0)
        return penalty * excess**2, (4.0 * penalty * excess / self.length**2) * edge

    def normal_equations(
        self, points: Complex, power: int, lower: float, upper: float | None, penalty: float
    ) -> NormalEquations:
        """Normal equations of h = [f, g] at each vertex."""
        f, df = self.angle_errors(points, power)
        g, dg = self.length_penalties(points, lower, upper, penalty)

        def total(of_angles: Complex, of_edges: Complex) -> Complex:
            return np.add.reduceat(of_angles, self.first_angle) + np.add.reduceat(of_edges, self.first_edge)

        square = total(df * df.conj(), dg * dg.conj()).real
        return NormalEquations(square, total(df * df, dg * dg), total(df * f, dg * g))


def vertex_patches(structure: BlockStructure, free: Index, ideal: Array) -> tuple[VertexPatches, ...]:
    """Batch the free vertices in the order in which a sweep visits them.

    Parameters
    ----------
    structure : BlockStructure
    free : ndarray of int
        Vertices that move.
    ideal : ndarray, shape (b, 4)
        Angle wanted at each corner of each block, in radians.
    """
    quads = structure.topology.quads
    blocks_of = _rows_of(quads, len(structure.vertices))
    edges_of = _rows_of(structure.topology.edges, len(structure.vertices))
    color = np.full(len(structure.vertices), -1)
    for vertex in free:
        taken = color[quads[blocks_of[vertex]]]
        color[vertex] = next(c for c in range(len(free)) if c not in taken)
    return tuple(
        _patches(structure, np.flatnonzero(color == c), blocks_of, edges_of, ideal)
        for c in range(int(color.max(initial=-1)) + 1)
    )


def _rows_of(table: Index, count: int) -> list[Index]:
    """Rows of a table of vertices in which each vertex stands, ascending."""
    rows = np.argsort(table.ravel(), kind="stable") // table.shape[1]
    return np.split(rows, np.cumsum(np.bincount(table.ravel(), minlength=count))[:-1])


def _patches(
    structure: BlockStructure, vertices: Index, blocks_of: list[Index], edges_of: list[Index], ideal: Array
) -> VertexPatches:
    quads, edges = structure.topology.quads, structure.topology.edges
    angles: list[tuple[int, int, int, int, int]] = []
    wanted: list[float] = []
    pairs: list[tuple[int, int]] = []
    first_angle, first_edge = [], []
    for vertex in vertices:
        first_angle.append(len(angles))
        first_edge.append(len(pairs))
        for block in blocks_of[vertex]:
            place = int(np.flatnonzero(quads[block] == vertex)[0])
            # All angles but the one opposite the vertex. (by_after, by_before): it is the corner, before, or after.
            for turn, derivative in ((0, (-1, -1)), (1, (0, 1)), (3, (1, 0))):
                k = (place + turn) % 4
                angles.append((quads[block, k], quads[block, (k + 1) % 4], quads[block, k - 1], *derivative))
                wanted.append(float(ideal[block, k]))
        ends = edges[edges_of[vertex]]
        pairs.extend((int(vertex), int(other)) for other in ends[ends != vertex])
    corner, after, before, by_after, by_before = np.array(angles, dtype=np.int64).T
    own, other = np.array(pairs, dtype=np.int64).T
    length = np.hypot(*(structure.vertices[own] - structure.vertices[other]).T)
    return VertexPatches(
        vertices,
        corner,
        after,
        before,
        by_after.astype(float),
        by_before.astype(float),
        np.array(wanted),
        np.array(first_angle),
        own,
        other,
        length,
        np.array(first_edge),
    )
