"""Laplace smoothing of the displacement."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers.condensed_system import CondensedFactor, CondensedSystem
from full_mesh_movers.elements import Elements
from full_mesh_movers.node_roles import NodeRoles
from full_mesh_movers.stiffening import Kind, Stiffening
from hoblock import QuadMesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Laplace"]


@dataclass(frozen=True, eq=False)
class Laplace:
    """div(k grad u) = 0 for each component of the displacement u, with elements of the order of the mesh.

    Parameters
    ----------
    mesh : QuadMesh
        The reference.
    moving, fixed : ndarray of int
        Ascending nodes on the moving body and on the rest of the boundary.
    stiffening : {"distance", "area", "jacobian"}
        What k depends on: the distance from the moving body, the area of the element, or det J; see `Stiffening`.
    exponent : float
        0 is plain Laplace smoothing, -1 divides by the distance, the area or det J.
    incremental : bool
        Solve for the increment from the last accepted state on its mesh, with k of that mesh, assembled and factorised
        in each move. Otherwise everything is factorised once, on the reference.

    References
    ----------
    Löhner, Yang, Commun. Numer. Meth. Engng 12 (1996) 599–608; Jasak, Tuković, Trans. FAMENA 30 (2006) 1–20.
    """

    mesh: QuadMesh
    moving: Index
    fixed: Index
    stiffening: Kind = field(default="distance", kw_only=True)
    exponent: float = field(default=-1.0, kw_only=True)
    incremental: bool = field(default=False, kw_only=True)
    _roles: NodeRoles = field(init=False, repr=False)
    _elements: Elements = field(init=False, repr=False)
    _stiffening: Stiffening = field(init=False, repr=False)
    _system: CondensedSystem = field(init=False, repr=False)
    _factor: CondensedFactor | None = field(init=False, repr=False, default=None)

    def __post_init__(self) -> None:
        roles, elements = NodeRoles.of(self.mesh, self.moving, self.fixed), Elements.of(self.mesh)
        given = np.zeros((len(self.mesh.points), 1), dtype=bool)
        given[roles.given] = True
        for name, value in (
            ("moving", roles.moving),
            ("fixed", roles.fixed),
            ("_roles", roles),
            ("_elements", elements),
            ("_stiffening", Stiffening.of(self.mesh, roles.moving, self.stiffening, self.exponent)),
            ("_system", CondensedSystem(elements.cells, elements.boundary, given)),
        ):
            object.__setattr__(self, name, value)
        if not self.incremental:
            object.__setattr__(self, "_factor", self._factorised(self.mesh.points))

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions; see `FullMeshMover.move`."""
        start = self._roles.start(current, self.incremental)
        given = self._roles.displacement(start, positions)
        factor = self._factor or self._factorised(start)
        return self._roles.placed(start + factor.solve(given[:, None])[:, 0], positions)

    def _factorised(self, points: Array) -> CondensedFactor:
        geometry = self._elements.geometry(points)
        k = self._stiffening.factor(self._elements, geometry, points) * geometry.weights

        def matrices(some: slice) -> Array:
            return self._elements.stiffness(np.eye(2)[:, :, None, None] * k[some], geometry.J_inv[:, :, some])

        return self._system.factorise(matrices)
