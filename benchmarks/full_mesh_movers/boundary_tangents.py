"""Sides of the boundary, their tangents and how a motion turns them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers.node_roles import boundary_sides
from hoblock import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.reference import gauss_legendre, gauss_lobatto, lagrange, lagrange_derivative

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]

__all__ = ["BoundaryTangents"]


@dataclass(frozen=True, eq=False)
class BoundaryTangents:
    """Tangents of the boundary at Gauss points of its sides, as complex numbers, counter-clockwise.

    Attributes
    ----------
    nodes : ndarray, shape (s, p + 1)
        Nodes of each side.
    N, dN : ndarray, shape (q, p + 1)
        Basis of a side and its derivative counter-clockwise, up to the sign in ``signs``.
    weights : ndarray, shape (q,)
    signs : ndarray, shape (s, 1)
        -1 where the direction of a side is clockwise.
    """

    nodes: Index
    N: Array
    dN: Array
    weights: Array
    signs: Array

    @staticmethod
    def of(mesh: QuadMesh) -> BoundaryTangents:
        """Find the boundary of a mesh."""
        element, side = boundary_sides(mesh).T
        points, weights = gauss_legendre(mesh.order + 1)
        gll = gauss_lobatto(mesh.order)
        return BoundaryTangents(
            mesh.cells[element[:, None], side_nodes(mesh.order)[side]],
            lagrange(gll, points),
            lagrange_derivative(gll, points),
            weights,
            np.where(side < 2, 1.0, -1.0)[:, None],
        )

    def tangents(self, points: Array) -> Complex:
        """Tangents for node positions (n, 2), as long as the map of the side stretches, shape (s, q)."""
        x = points[:, 0] + 1j * points[:, 1]
        return self.signs * (x[self.nodes] @ self.dN.T)

    def change_of_normal_load(self, before: Array, after: Array) -> Array:
        """∮ (n' - n) N_i ds at all nodes, shape (n, 2): outward unit normals n before and n' after a motion.

        The integral is over the boundary before the motion.
        """
        old, new = self.tangents(before), self.tangents(after)
        length = np.abs(old)
        change = -1j * (new / np.abs(new) - old / length)  # a quarter turn to the right of the tangent
        local = ((change * length * self.weights) @ self.N).ravel()
        nodes, count = self.nodes.ravel(), len(before)
        parts = [np.bincount(nodes, weights=part, minlength=count) for part in (local.real, local.imag)]
        return np.stack(parts, axis=-1)

    def rotations(self, before: Array, after: Array) -> Complex:
        """Rotation e^{iθ} of the boundary at each node, the mean of its sides; 1 at other nodes, shape (n,)."""
        turned = self.tangents(after) * self.tangents(before).conj()
        mean = np.zeros(len(before), dtype=np.complex128)
        np.add.at(mean, self.nodes, ((turned / np.abs(turned) * self.weights) @ self.N))
        size = np.abs(mean)
        return np.where(size > 0.0, mean / np.where(size > 0.0, size, 1.0), 1.0)
