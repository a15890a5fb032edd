"""Inverse distance weighting of the displacement."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from full_mesh_movers.boundary_tangents import BoundaryTangents
from full_mesh_movers.node_roles import NodeRoles
from hoblock import QuadMesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["InverseDistance", "inverse_distance_weights"]

_ROWS = 2048
"""Points that are evaluated at a time."""


def inverse_distance_weights(points: Array, centres: Array, count: int, exponent: float) -> Array:
    """Weights r^-exponent of the first ``count`` centres, divided by the sum over all, shape (len(points), count).

    Parameters
    ----------
    points : ndarray, shape (k, 2)
        None of them a centre.
    centres : ndarray, shape (m, 2)
    count : int
    exponent : float
        Positive.
    """
    if not 0.0 < exponent < np.inf:
        raise ValueError(f"exponent is {exponent:g}; expected a positive one, for example 3.")
    result = np.empty((len(points), count))
    for first in range(0, len(points), _ROWS):
        some = slice(first, first + _ROWS)
        r2 = cdist(points[some], centres, "sqeuclidean")
        weights = (r2 / r2.min(axis=1, keepdims=True)) ** (-0.5 * exponent)
        result[some] = weights[:, :count] / weights.sum(axis=1, keepdims=True)
    return result


@dataclass(frozen=True, eq=False)
class InverseDistance:
    """The displacement of a free node is the mean of that of all boundary nodes, weighted with r^-exponent.

    Parameters
    ----------
    mesh : QuadMesh
        The reference.
    moving, fixed : ndarray of int
        Ascending nodes on the moving body and on the rest of the boundary.
    exponent : float
        Positive.
    rotations : bool
        Average the rigid motions of the boundary at its nodes, x ↦ x_i + u_i + R_i (x - x_i), instead of their
        displacements u_i alone. R_i is the rotation of the tangent.

    References
    ----------
    Witteveen, Bijl, AIAA 2009-3996, doi:10.2514/6.2009-3996; with rotations Luke, Collins, Blades, J. Comput. Phys. 231
    (2012) 586–601, doi:10.1016/j.jcp.2011.09.021.
    """

    mesh: QuadMesh
    moving: Index
    fixed: Index
    exponent: float = field(default=3.0, kw_only=True)
    rotations: bool = field(default=False, kw_only=True)
    _roles: NodeRoles = field(init=False, repr=False)
    _tangents: BoundaryTangents | None = field(init=False, repr=False)
    _weights: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        roles, points = NodeRoles.of(self.mesh, self.moving, self.fixed), self.mesh.points
        centres = points[np.concatenate([roles.moving, roles.fixed])]
        for name, value in (
            ("moving", roles.moving),
            ("fixed", roles.fixed),
            ("_roles", roles),
            ("_tangents", BoundaryTangents.of(self.mesh) if self.rotations else None),
            ("_weights", inverse_distance_weights(points[roles.free], centres, len(roles.moving), self.exponent)),
        ):
            object.__setattr__(self, name, value)

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions; see `FullMeshMover.move`. ``current`` is ignored."""
        points, free = self.mesh.points.copy(), self._roles.free
        given = self._roles.displacement(points, positions)[self.moving]
        if self._tangents is None:
            points[free] += self._weights @ given
            return self._roles.placed(points, positions)
        R = self._tangents.rotations(points, self._roles.placed(points, positions))[self.moving] - 1.0
        u, x = (field[:, 0] + 1j * field[:, 1] for field in (given, points))
        shift = u - R * x[self.moving]
        mean = self._weights @ np.column_stack([shift.real, shift.imag, R.real, R.imag])
        moved = mean[:, 0] + 1j * mean[:, 1] + (mean[:, 2] + 1j * mean[:, 3]) * x[free]
        points[free] += np.column_stack([moved.real, moved.imag])
        return self._roles.placed(points, positions)
