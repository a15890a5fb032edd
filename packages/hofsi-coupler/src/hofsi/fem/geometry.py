"""Geometry factors of element maps at quadrature points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.errors import MeshMotionError
from hofsi.fem.element import ElementTable

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Geometry", "SideGeometry", "element_geometry", "physical_gradients", "side_geometry"]


@dataclass(frozen=True)
class Geometry:
    """Positions, integration weights and inverse Jacobians of a batch of elements.

    Attributes
    ----------
    x : ndarray, shape (e, q, 2)
    weights : ndarray, shape (e, q)
        Quadrature weight times det J.
    J_inv : ndarray, shape (e, q, 2, 2)
        ∂ξ_c/∂x_d.
    """

    x: Array
    weights: Array
    J_inv: Array

    def with_elements(self, elements: Index, geometry: Geometry) -> Geometry:
        """Return the same with other factors for some elements."""
        x, weights, J_inv = self.x.copy(), self.weights.copy(), self.J_inv.copy()
        x[elements], weights[elements], J_inv[elements] = geometry.x, geometry.weights, geometry.J_inv
        return Geometry(x, weights, J_inv)


def _jacobian(X: Array, table: ElementTable) -> Array:
    q, n, _ = table.dN.shape
    flat = X.transpose(0, 2, 1) @ table.dN.transpose(1, 0, 2).reshape(n, 2 * q)
    return np.asarray(flat.reshape(len(X), 2, q, 2).transpose(0, 2, 1, 3))


def _inverse(J: Array) -> tuple[Array, Array]:
    det_J = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
    J_inv = np.empty(J.shape)
    J_inv[..., 0, 0], J_inv[..., 1, 1] = J[..., 1, 1], J[..., 0, 0]
    J_inv[..., 0, 1], J_inv[..., 1, 0] = -J[..., 0, 1], -J[..., 1, 0]
    J_inv /= det_J[..., None, None]
    return det_J, J_inv


def element_geometry(X: Array, table: ElementTable, numbers: Index | None = None) -> Geometry:
    """Geometry factors of elements with node positions X.

    Parameters
    ----------
    X : ndarray, shape (e, i, 2)
    table : ElementTable
        The basis of the geometry.
    numbers : ndarray, shape (e,), optional
        Of the elements, for messages; by default from 0.

    Raises
    ------
    MeshMotionError
        If det J is not positive at a quadrature point.
    """
    det_J, J_inv = _inverse(_jacobian(X, table))
    if not (det_J > 0.0).all():
        bad = int(np.argmin(np.where(np.isfinite(det_J), det_J, -np.inf).min(axis=1)))
        number = bad if numbers is None else int(numbers[bad])
        raise MeshMotionError(
            f"element {number}: det J = {det_J[bad].min():.3g} at a quadrature point; must be positive."
        )
    return Geometry(table.N @ X, det_J * table.weights, J_inv)


def physical_gradients(geometry: Geometry | SideGeometry, table: ElementTable) -> tuple[Array, Array]:
    """Derivatives of the basis along x and y, each of shape (e, q, i)."""
    along_xi, along_eta = table.dN[..., 0], table.dN[..., 1]
    J_inv = geometry.J_inv[:, :, :, :, None]
    return (
        J_inv[:, :, 0, 0] * along_xi + J_inv[:, :, 1, 0] * along_eta,
        J_inv[:, :, 0, 1] * along_xi + J_inv[:, :, 1, 1] * along_eta,
    )


@dataclass(frozen=True)
class SideGeometry:
    """A group of element sides of one local number.

    Attributes
    ----------
    number : int
        Local number of the side.
    elements : ndarray, shape (k,)
    table : ElementTable
        Basis on that side.
    x : ndarray, shape (k, q, 2)
    normals : ndarray, shape (k, q, 2)
        Outward normal times arc length times quadrature weight.
    J_inv : ndarray, shape (k, q, 2, 2)
    """

    number: int
    elements: Index
    table: ElementTable
    x: Array
    normals: Array
    J_inv: Array

    @property
    def lengths(self) -> Array:
        """Arc length times quadrature weight, shape (k, q)."""
        return np.asarray(np.hypot(self.normals[..., 0], self.normals[..., 1]))


def side_geometry(X: Array, sides: Index, tables: tuple[ElementTable, ...]) -> list[SideGeometry]:
    """Geometry of element sides, grouped by local side number.

    Parameters
    ----------
    X : ndarray, shape (e, i, 2)
    sides : ndarray, shape (k, 2)
        (element, side) pairs.
    tables : tuple of ElementTable
        Basis of the geometry on the four sides.
    """
    groups = []
    for side in range(4):
        elements = sides[sides[:, 1] == side, 0]
        if not elements.size:
            continue
        table = tables[side]
        J = _jacobian(X[elements], table)
        tangent = J[..., side % 2]  # along ξ on sides 0 and 2, along η on sides 1 and 3
        outward = 1.0 if side in (0, 1) else -1.0  # counter-clockwise is with the side's direction on 0 and 1
        normals = outward * np.stack([tangent[..., 1], -tangent[..., 0]], axis=-1) * table.weights[:, None]
        groups.append(SideGeometry(side, elements, table, table.N @ X[elements], normals, _inverse(J)[1]))
    return groups
