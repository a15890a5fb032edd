"""The elements of a mesh of order p: integrals over all of them at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from full_mesh_movers.errors import MotionFailed
from hoblock import QuadMesh
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient, tensor_quadrature
from hofsi.fem.element import boundary_first
from hofsi.kernels.elasticity import gradient_products

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Elements", "Geometry"]


@dataclass(frozen=True, eq=False)
class Geometry:
    """Jacobians of the element maps at the quadrature points.

    Attributes
    ----------
    det_J : ndarray, shape (e, q)
    J_inv : ndarray, shape (2, 2, e, q)
        ∂ξ_c/∂x_d.
    weights : ndarray, shape (e, q)
        Quadrature weight times det J.
    """

    det_J: Array
    J_inv: Array
    weights: Array


@dataclass(frozen=True, eq=False)
class Elements:
    """Basis functions at quadrature points, and the nodes of all elements.

    Attributes
    ----------
    cells : ndarray, shape (e, i)
        Nodes of each element, those on its sides first.
    boundary : int
        How many of them are on the sides.
    N : ndarray, shape (q, i)
    dN : ndarray, shape (q, i, 2)
        Derivatives along ξ and η.
    weights : ndarray, shape (q,)
    inside : ndarray of bool, shape (q,)
        Whether a quadrature point is inside the element, not on a side.
    """

    cells: Index
    boundary: int
    N: Array
    dN: Array
    weights: Array
    inside: NDArray[np.bool_]
    _products: Array

    @staticmethod
    def of(mesh: QuadMesh, lobatto: int | None = None) -> Elements:
        """Tabulate the basis of a mesh at (p + 1)² Gauss points, or at ``lobatto``² Gauss–Lobatto points."""
        points, weights = tensor_quadrature(mesh.order + 1) if lobatto is None else _lobatto_quadrature(lobatto)
        local, boundary = boundary_first(mesh.order)
        nodes = gauss_lobatto(mesh.order)
        dN = np.ascontiguousarray(tensor_gradient(nodes, points)[:, local])
        return Elements(
            mesh.cells[:, local],
            boundary,
            np.ascontiguousarray(tensor_basis(nodes, points)[:, local]),
            dN,
            weights,
            np.abs(points).max(axis=1) < 1.0,
            gradient_products(dN)[1],
        )

    def reference_gradient(self, values: Array) -> Array:
        """∂v_a/∂ξ_c of a nodal field (n, 2) at the quadrature points, shape (2, 2, e, q)."""
        local = values[self.cells]
        local = (local - local[:, :1]).transpose(2, 0, 1)  # far from the origin digits would be lost
        e, i = self.cells.shape
        along = local.reshape(2 * e, i) @ self.dN.transpose(1, 2, 0).reshape(i, -1)
        return np.ascontiguousarray(along.reshape(2, e, 2, -1).transpose(0, 2, 1, 3))

    def gradient(self, values: Array, geometry: Geometry) -> Array:
        """∂v_a/∂x_d of a nodal field (n, 2) at the quadrature points, shape (2, 2, e, q)."""
        along, J_inv = self.reference_gradient(values), geometry.J_inv
        return along[:, 0, None] * J_inv[None, 0] + along[:, 1, None] * J_inv[None, 1]

    def geometry(self, points: Array) -> Geometry:
        """Jacobians for node positions (n, 2).

        Raises
        ------
        MotionFailed
            If det J is not positive at a quadrature point.
        """
        J = self.reference_gradient(points)
        det_J = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        if not (det_J > 0.0).all():
            worst = int(np.argmin(np.where(np.isfinite(det_J), det_J, -np.inf).min(axis=1)))
            raise MotionFailed(
                f"element {worst} has det J = {det_J[worst].min():.3g} at a quadrature point of the mesh on which the "
                "equations are set up; expected a positive one. Begin with a valid mesh, or take smaller steps."
            )
        J_inv = np.stack([[J[1, 1], -J[0, 1]], [-J[1, 0], J[0, 0]]]) / det_J
        return Geometry(det_J, J_inv, det_J * self.weights)

    def stiffness(self, coefficient: Array, J_inv: Array) -> Array:
        """∫ ∂_D N_i A_DC ∂_C N_j over some elements, shape (k, i, j).

        Parameters
        ----------
        coefficient : ndarray, shape (2, 2, k, q)
            A times the quadrature weight times det J.
        J_inv : ndarray, shape (2, 2, k, q)
            Of these elements.
        """
        half = J_inv[:, 0, None] * coefficient[0] + J_inv[:, 1, None] * coefficient[1]
        pulled = half[:, None, 0] * J_inv[:, 0] + half[:, None, 1] * J_inv[:, 1]
        count, i = coefficient.shape[2], self.cells.shape[1]
        return (pulled.transpose(2, 0, 1, 3).reshape(count, -1) @ self._products).reshape(count, i, i)

    def vector_stiffness(self, moduli: Array, J_inv: Array) -> Array:
        """∫ ∂_D N_i A_aDbC ∂_C N_j over some elements, shape (k, 2 i, 2 j), local unknowns 2 i + a.

        Parameters
        ----------
        moduli : ndarray, shape (2, 2, 2, 2, k, q)
            A_aDbC = A_bCaD times the quadrature weight times det J.
        J_inv : ndarray, shape (2, 2, k, q)
        """
        count, i = moduli.shape[4], self.cells.shape[1]
        K = np.empty((count, i, 2, i, 2))
        for a, b in ((0, 0), (0, 1), (1, 1)):
            K[:, :, a, :, b] = self.stiffness(moduli[a, :, b], J_inv)
        K[:, :, 1, :, 0] = K[:, :, 0, :, 1].transpose(0, 2, 1)
        return K.reshape(count, 2 * i, 2 * i)

    def mass(self, weights: Array) -> Array:
        """∫ N_i N_j over some elements, shape (k, i, j), from quadrature weights times det J, (k, q)."""
        i = self.N.shape[1]
        return (weights @ (self.N[:, :, None] * self.N[:, None, :]).reshape(-1, i * i)).reshape(-1, i, i)

    def force(self, stress: Array, geometry: Geometry) -> Array:
        """∫ P_aD ∂_D N_i assembled at the nodes, shape (n, 2), for P (2, 2, e, q)."""
        e, i = self.cells.shape
        J_inv = geometry.J_inv
        pulled = (stress[:, None, 0] * J_inv[None, :, 0] + stress[:, None, 1] * J_inv[None, :, 1]) * geometry.weights
        f = pulled.transpose(0, 2, 1, 3).reshape(2 * e, -1) @ self.dN.transpose(2, 0, 1).reshape(-1, i)
        local = f.reshape(2, -1)
        nodes = self.cells.ravel()
        return np.stack([np.bincount(nodes, weights=component) for component in local], axis=-1)


def _lobatto_quadrature(count: int) -> tuple[Array, Array]:
    """Gauss–Lobatto rule with count × count points on the square, exact to degree 2 count - 3 in each direction."""
    x = gauss_lobatto(count - 1)
    weights = 2.0 / (count * (count - 1) * legendre.legval(x, [0.0] * (count - 1) + [1.0]) ** 2)
    points = np.stack(np.meshgrid(x, x, indexing="xy"), axis=-1).reshape(-1, 2)
    return points, np.outer(weights, weights).ravel()
