"""Coefficients that make some parts of a mesh stiffer than others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from full_mesh_movers.boundary_tangents import BoundaryTangents
from full_mesh_movers.elements import Elements, Geometry
from hoblock import QuadMesh
from hoblock.reference import equispaced, gauss_lobatto, lagrange

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Kind = Literal["area", "distance", "jacobian"]

__all__ = ["Kind", "Stiffening"]

_PARTS = 8
"""Straight pieces, times the order, in which the distance sees a side of the moving body."""


@dataclass(frozen=True, eq=False)
class Stiffening:
    """A factor of the stiffness at every quadrature point: some size to the power of an exponent.

    Attributes
    ----------
    kind : {"area", "jacobian", "distance"}
        The size: area of the element, det J at the point, or distance of the point from the moving body.
    exponent : float
        0 gives a uniform material; with negative exponents small elements, or those near the body, are stiff.
    sides : ndarray, shape (s, p + 1)
        Nodes of the sides of the moving body.
    samples : ndarray, shape (k, p + 1)
        Basis of a side at the ends of the pieces.
    moving : ndarray
        Nodes on the moving body.

    References
    ----------
    "jacobian": Stein, Tezduyar, Benney, J. Appl. Mech. 70 (2003) 58–63, doi:10.1115/1.1530635; their χ is -exponent,
    and χ = 1 drops det J from the integrals. "distance": Jasak, Tuković, Trans. FAMENA 30 (2006) 1–20, who use -1 and
    -2.
    """

    kind: Kind
    exponent: float
    sides: Index
    samples: Array
    moving: Index

    @staticmethod
    def of(mesh: QuadMesh, moving: Index, kind: Kind, exponent: float) -> Stiffening:
        """Check the parameters and find the moving sides of a mesh."""
        if kind not in ("area", "distance", "jacobian"):
            raise ValueError(f"stiffening is {kind!r}; expected 'area', 'distance' or 'jacobian'.")
        if not np.isfinite(exponent):
            raise ValueError(f"exponent is {exponent:g}; expected a finite number, for example -1.")
        sides = BoundaryTangents.of(mesh).nodes
        samples = lagrange(gauss_lobatto(mesh.order), equispaced(_PARTS * mesh.order))
        return Stiffening(kind, exponent, sides[np.isin(sides, moving).all(axis=1)], samples, moving)

    def factor(self, elements: Elements, geometry: Geometry, points: Array) -> Array:
        """Return (size/smallest size)^exponent, for the distance (size/largest size)^exponent, shape (e, q).

        Parameters
        ----------
        elements : Elements
        geometry : Geometry
            Of these points.
        points : ndarray, shape (n, 2)
        """
        if self.exponent == 0.0 or (self.kind == "distance" and not self.moving.size):
            return np.ones_like(geometry.det_J)
        if self.kind == "distance":
            size = self._distance((elements.N @ points[elements.cells]).reshape(-1, 2), points)
            size = size.reshape(geometry.det_J.shape)
            # On the body itself the distance is zero; the nearest point inside the element stands for it.
            size = np.maximum(size, size[:, elements.inside].min(axis=1, keepdims=True))
            return (size / size.max()) ** self.exponent
        size = geometry.det_J if self.kind == "jacobian" else geometry.weights.sum(axis=1, keepdims=True)
        return np.broadcast_to((size / size.min()) ** self.exponent, geometry.det_J.shape)

    def _distance(self, x: Array, points: Array) -> Array:
        """Distance of points (k, 2) from the moving nodes and the pieces between samples of their sides."""
        distance = cKDTree(points[self.moving]).query(x)[0]
        if not self.sides.size:
            return distance
        ends = self.samples @ points[self.sides]  # (s, k, 2)
        count = ends.shape[1]
        nearest = cKDTree(ends.reshape(-1, 2)).query(x, k=2)[
            1
        ]  # the pieces that end there; a node between sides is there twice
        for side, k in zip(*divmod(nearest.T, count), strict=True):
            a, b = ends[side, np.maximum(k - 1, 0)], ends[side, np.maximum(k, 1)]
            along = b - a
            t = np.clip(((x - a) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
            distance = np.minimum(distance, np.hypot(*(x - a - t[:, None] * along).T))
        return distance
