"""Vorticity of the fluid at nodes and at places in elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.locate import Location
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient
from hofsi.fem.element import ElementTable
from hofsi.fem.geometry import element_geometry, physical_gradients

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["FluidVorticity", "vorticity_at"]


class FluidVorticity:
    """ω = ∂v/∂x - ∂u/∂y at the nodes of a mesh, averaged where elements meet.

    Parameters
    ----------
    mesh : QuadMesh
        In any position.
    same : ndarray, shape (n,), optional
        For each node the one that stands for it: nodes of periodic sides meet the elements of both.
    """

    def __init__(self, mesh: QuadMesh, same: Index | None = None) -> None:
        self._cells, self._same = mesh.cells, same
        self._sums = mesh.cells if same is None else same[mesh.cells]
        nodes = gauss_lobatto(mesh.order)
        self._table = _table(mesh.order, np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2))
        self._share = 1.0 / np.maximum(np.bincount(self._sums.ravel(), minlength=len(mesh.points)), 1)

    def at_nodes(self, points: Array, velocity: Array) -> Array:
        """Return the vorticity (n,) of a velocity (n, 2) on the mesh with node positions ``points`` (n, 2)."""
        values = _vorticity(points[self._cells], velocity[self._cells], self._table)
        means = self._share * np.bincount(self._sums.ravel(), weights=values.ravel(), minlength=len(points))
        return means if self._same is None else means[self._same]


def vorticity_at(mesh: QuadMesh, location: Location, velocity: Array) -> float:
    """Vorticity at a place in an element, that of the element's own polynomial.

    Parameters
    ----------
    mesh : QuadMesh
        Where it is now.
    location : Location
        On a face the elements beside it have different values; this one's counts.
    velocity : ndarray, shape (n, 2)
    """
    cell = mesh.cells[[location.element]]
    table = _table(mesh.order, np.array([[location.xi, location.eta]]))
    return float(_vorticity(mesh.points[cell], velocity[cell], table)[0, 0])


def _table(order: int, places: Array) -> ElementTable:
    nodes = gauss_lobatto(order)
    return ElementTable(
        order, places, np.ones(len(places)), tensor_basis(nodes, places), tensor_gradient(nodes, places)
    )


def _vorticity(X: Array, u: Array, table: ElementTable) -> Array:
    """At the points of a table, shape (e, q), of element nodes X and velocities u, each (e, i, 2)."""
    dNx, dNy = physical_gradients(element_geometry(X, table), table)
    return np.asarray((dNx @ u[..., 1:] - dNy @ u[..., :1])[..., 0])
