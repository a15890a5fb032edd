"""A hybrid: corners of the elements as an elastic solid, everything else by transfinite interpolation."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers.elastic import Elastic
from full_mesh_movers.node_roles import NodeRoles
from full_mesh_movers.stiffening import Kind
from hoblock import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.reference import gauss_lobatto

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["MacroElements"]


@dataclass(frozen=True, eq=False)
class MacroElements:
    """Bilinear elastic elements move the corners; the displacement is blended along sides, then into the elements.

    The displacement is linear along a side in the element's coordinate, except on sides whose nodes are given, and
    inside an element it is the transfinite interpolation of its sides (Gordon and Hall).

    Parameters
    ----------
    mesh : QuadMesh
        The reference. The straight-sided elements between its corners must be valid, too.
    moving, fixed : ndarray of int
        Ascending nodes on the moving body and on the rest of the boundary.
    stiffening, exponent, poissons_ratio, incremental
        Of the elastic solid, see `Elastic`.

    References
    ----------
    Bartels, NASA/TM-2005-213789 (finite macro-elements).
    """

    mesh: QuadMesh
    moving: Index
    fixed: Index
    stiffening: Kind = field(default="distance", kw_only=True)
    exponent: float = field(default=-1.0, kw_only=True)
    poissons_ratio: float = field(default=0.3, kw_only=True)
    incremental: bool = field(default=False, kw_only=True)
    _roles: NodeRoles = field(init=False, repr=False)
    _corners: Index = field(init=False, repr=False)
    _driving: Index = field(init=False, repr=False)
    _solid: Elastic = field(init=False, repr=False)

    def __post_init__(self) -> None:
        roles = NodeRoles.of(self.mesh, self.moving, self.fixed)
        corners, cells = np.unique(self.mesh.corners[:, [0, 1, 3, 2]], return_inverse=True)
        solid = Elastic(
            QuadMesh(self.mesh.points[corners], cells.reshape(-1, 4).astype(np.int64), 1, {}, {}),
            np.flatnonzero(np.isin(corners, roles.moving)),
            np.flatnonzero(np.isin(corners, roles.fixed)),
            stiffening=self.stiffening,
            exponent=self.exponent,
            poissons_ratio=self.poissons_ratio,
            incremental=self.incremental,
        )
        for name, value in (
            ("moving", roles.moving),
            ("fixed", roles.fixed),
            ("_roles", roles),
            ("_corners", corners),
            ("_driving", np.flatnonzero(np.isin(roles.moving, corners))),
            ("_solid", solid),
        ):
            object.__setattr__(self, name, value)

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions; see `FullMeshMover.move`."""
        start = self._roles.start(current, self.incremental)
        u = self._roles.displacement(start, positions)
        corners = self._corners
        moved = self._solid.move(start[corners], np.asarray(positions, dtype=float)[self._driving])
        return self._roles.placed(start + self._blended(moved - start[corners], u), positions)

    def _blended(self, corners: Array, given: Array) -> Array:
        """Displacement (n, 2) from that of the corners and of the given nodes."""
        p, cells = self.mesh.order, self.mesh.cells
        s = 0.5 * (1.0 + gauss_lobatto(p))[:, None]
        u = np.empty_like(given)
        u[self._corners] = corners
        sides = cells[:, side_nodes(p)]
        u[sides] = (1.0 - s) * u[sides[:, :, :1]] + s * u[sides[:, :, -1:]]
        u[self._roles.given] = given[self._roles.given]
        bottom, right, top, left = np.moveaxis(u[sides], 1, 0)
        a, b = (corner[:, None, None] for corner in (bottom[:, 0], bottom[:, -1]))
        c, d = (corner[:, None, None] for corner in (top[:, -1], top[:, 0]))
        xi, eta = s[None, None, 1:-1], s[None, 1:-1, None]
        inner = (
            (1.0 - eta) * bottom[:, None, 1:-1]
            + eta * top[:, None, 1:-1]
            + (1.0 - xi) * left[:, 1:-1, None]
            + xi * right[:, 1:-1, None]
            - ((1.0 - eta) * ((1.0 - xi) * a + xi * b) + eta * ((1.0 - xi) * d + xi * c))
        )
        u[cells.reshape(-1, p + 1, p + 1)[:, 1:-1, 1:-1]] = inner
        return u
