"""The energy of a block structure as a function of its movable vertices: what the barrier mover minimises."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.movers._corner_energies import CornerEnergy
from hoblock.movers._corners import BlockCorners, EdgeVectors
from hoblock.movers._newton import solve_positive
from hoblock.movers._roles import VertexRoles
from hoblock.movers._unknowns import chain_rule

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BlockEnergy", "BoundEnergy", "LengthEnergy"]

_DENSE = 400
"""Unknowns up to which a dense Cholesky factorisation is faster than a sparse one."""


@dataclass(frozen=True, eq=False)
class LengthEnergy:
    """Mean over edges of (r + 1/r - 2)/2, r = (l/l₀)², times a weight: keeps lengths where only angles count.

    Attributes
    ----------
    edges : EdgeVectors
    squares : ndarray, shape (m,)
        l₀².
    weight : float
    """

    edges: EdgeVectors
    squares: Array
    weight: float

    def value(self, c: Array) -> float:
        """Energy of edges (2, m)."""
        r = (c * c).sum(axis=0) / self.squares
        return float(0.5 * self.weight * (r + 1.0 / r - 2.0).mean())

    def derivatives(self, c: Array, convex: bool) -> tuple[float, Array, Array]:
        """Energy, gradient (2, m) and Hessian (2, 2, m); of the Hessian only the positive part if it is ``convex``."""
        r = (c * c).sum(axis=0) / self.squares
        share = 0.5 * self.weight / len(r)
        by_r = 1.0 - 1.0 / r**2
        dr = 2.0 * c / self.squares
        hessian = (share * 2.0 / r**3) * dr[:, None] * dr
        curvature = share * (np.maximum(by_r, 0.0) if convex else by_r) * 2.0 / self.squares
        hessian[0, 0] += curvature
        hessian[1, 1] += curvature
        return float(share * (r + 1.0 / r - 2.0).sum()), share * by_r * dr, hessian


@dataclass(frozen=True, eq=False)
class BlockEnergy:
    """Mean energy of the corners that movable vertices touch, plus that of the edges' lengths.

    The unknowns y are x and y of the free vertices, then the coordinates of the sliding ones on their paths.

    Attributes
    ----------
    roles : VertexRoles
    corners : BlockCorners
    energy : CornerEnergy
    lengths : LengthEnergy or None
    """

    roles: VertexRoles
    corners: BlockCorners
    energy: CornerEnergy
    lengths: LengthEnergy | None

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 2 * len(self.roles.free) + len(self.roles.sliding.vertices)

    def unknowns(self, vertices: Array) -> Array:
        """Unknowns of positions (n, 2) of all vertices."""
        along = self.roles.sliding.coordinates(vertices[self.roles.sliding.vertices])
        return np.concatenate([vertices[self.roles.free].reshape(-1), along])

    def vertices(self, driven: Array, y: Array) -> Array:
        """Positions (n, 2) of all vertices from those of the driven ones and the unknowns."""
        split = 2 * len(self.roles.free)
        return self.roles.assembled(driven, y[:split].reshape(-1, 2), y[split:])

    def bound(self, driven: Array, tangents: Array | None) -> BoundEnergy:
        """Return the energy for a position of the driven vertices and of the end tangents of the driven edges."""
        roles = self.roles
        fixed = roles.assembled(driven, np.zeros((len(roles.free), 2)))
        fixed[roles.sliding.vertices] = 0.0
        z = self.corners.vectors(fixed, tangents, roles.reference)
        c = None if self.lengths is None else self.lengths.edges.vectors(fixed)
        movable = roles.movable
        free, sliding = np.searchsorted(movable, roles.free), np.searchsorted(movable, roles.sliding.vertices)
        return BoundEnergy(self, z, c, free, sliding)


@dataclass(frozen=True, eq=False)
class BoundEnergy:
    """A `BlockEnergy` for one position of what is driven, a function of the unknowns alone.

    Attributes
    ----------
    block : BlockEnergy
    z, c : ndarray
        Shares of the vertices that do not move in corners (4, C) and edges (2, m).
    free, sliding : ndarray
        Places of the free and the sliding vertices among the movable ones.
    """

    block: BlockEnergy
    z: Array
    c: Array | None
    free: Index
    sliding: Index

    def _positions(self, y: Array) -> Array:
        """x and y of the movable vertices, shape (2 k,)."""
        split = 2 * len(self.free)
        if not self.sliding.size:
            return y
        positions = np.empty((len(self.free) + len(self.sliding), 2))
        positions[self.free] = y[:split].reshape(-1, 2)
        positions[self.sliding] = self.block.roles.sliding.positions(y[split:])
        return positions.reshape(-1)

    def corner_vectors(self, y: Array) -> Array:
        """Corners z, shape (4, C)."""
        return self.z + self.block.corners.sums.vectors(self._positions(y)).reshape(4, -1)

    def value(self, y: Array, epsilon: float) -> tuple[float, float]:
        """Energy, and the smallest cross product of a corner relative to the reference."""
        x = self._positions(y)
        with np.errstate(all="ignore"):  # a step may go anywhere; what is not finite is not taken
            values, d = self.block.energy.values(self.z + self.block.corners.sums.vectors(x).reshape(4, -1), epsilon)
            energy = float(values.mean())
            if self.c is not None and self.block.lengths is not None:
                energy += self.block.lengths.value(self.c + self.block.lengths.edges.sums.vectors(x).reshape(2, -1))
        return energy, float(d.min())

    def derivatives(self, y: Array, epsilon: float, convex: bool) -> tuple[float, Array, Any]:
        """Energy, gradient and Hessian by the unknowns.

        ``convex``: Hessians of corners and edges are projected on their positive semidefinite parts (Teran, Sifakis,
        Irving, Fedkiw, SCA 2005, doi:10.1145/1073368.1073394). The Hessian is dense if it is small.
        """
        block, x = self.block, self._positions(y)
        sums, count = block.corners.sums, block.corners.count
        found = block.energy.derivatives(self.z + sums.vectors(x).reshape(4, -1), epsilon)
        hessians = _positive(found.hessian) if convex else found.hessian
        dense = sums.size <= _DENSE
        energy, gradient = float(found.value.mean()), sums.gradient(found.gradient) / count
        hessian: Any = (sums.dense if dense else sums.sparse)(hessians) / count
        if self.c is not None and block.lengths is not None:
            edges = block.lengths.edges.sums
            value, slope, curvature = block.lengths.derivatives(self.c + edges.vectors(x).reshape(2, -1), convex)
            energy += value
            gradient += edges.gradient(slope)
            hessian = hessian + (edges.dense if dense else edges.sparse)(curvature)
        if self.sliding.size:
            gradient, hessian = self._along_paths(y, gradient, hessian, convex)
        return energy, gradient, hessian

    def _along_paths(self, y: Array, gradient: Array, hessian: Any, convex: bool) -> tuple[Array, Any]:
        """Derivatives by positions made those by the unknowns: x'(s) and x''(s) of the sliding vertices enter."""
        from scipy.sparse import diags

        first, second = self.block.roles.sliding.derivatives(y[2 * len(self.free) :])
        T = chain_rule(self.free, self.sliding, first, len(gradient) // 2)
        bend = np.zeros(T.shape[1])
        bend[2 * len(self.free) :] = (gradient.reshape(-1, 2)[self.sliding] * second).sum(axis=1)
        if convex:
            bend = np.maximum(bend, 0.0)
        reduced = T.T @ (hessian @ T)
        if isinstance(hessian, np.ndarray):
            reduced[np.diag_indices(len(bend))] += bend
            return T.T @ gradient, reduced
        return T.T @ gradient, reduced + diags(bend)

    def response(self, y: Array, change: Array, lengths: Array | None) -> Array | None:
        """Rate of the unknowns at a minimum when what does not depend on them changes; None if it is not strict.

        Parameters
        ----------
        y : ndarray
        change : ndarray, shape (4, C)
            Rate of the corners z with the unknowns held.
        lengths : ndarray, shape (2, m), or None
            The same of the edges.
        """
        block, x = self.block, self._positions(y)
        sums, split = block.corners.sums, 2 * len(self.free)
        found = block.energy.derivatives(self.z + sums.vectors(x).reshape(4, -1), 0.0)
        right = sums.gradient(np.einsum("ijc,jc->ic", found.hessian, change)) / block.corners.count
        if self.c is not None and block.lengths is not None and lengths is not None:
            edges = block.lengths.edges.sums
            curvature = block.lengths.derivatives(self.c + edges.vectors(x).reshape(2, -1), False)[2]
            right += edges.gradient(np.einsum("ijc,jc->ic", curvature, lengths))
        if self.sliding.size:
            first = block.roles.sliding.derivatives(y[split:])[0]
            right = chain_rule(self.free, self.sliding, first, len(right) // 2).T @ right
        return solve_positive(self.derivatives(y, 0.0, False)[2], -right)


def _positive(hessians: Array) -> Array:
    """Positive semidefinite parts of symmetric matrices (4, 4, C)."""
    values, vectors = np.linalg.eigh(hessians.transpose(2, 0, 1))
    projected = (vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1)
    return np.ascontiguousarray(projected.transpose(1, 2, 0))
