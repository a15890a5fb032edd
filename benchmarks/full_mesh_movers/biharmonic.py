"""Biharmonic smoothing of the displacement."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers.boundary_tangents import BoundaryTangents
from full_mesh_movers.condensed_system import CondensedFactor, CondensedSystem
from full_mesh_movers.elements import Elements, Geometry
from full_mesh_movers.node_roles import NodeRoles
from hoblock import QuadMesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Biharmonic"]


@dataclass(frozen=True, eq=False)
class Biharmonic:
    """Δ²u = 0 for each component of the displacement u, with u and its normal derivative given on the boundary.

    Mixed form with continuous elements for u and w = -Δu. For all test functions v, and all z that vanish where u is
    given,

        ∫ w v - ∫ ∇u·∇v = -∮ g v,        ∫ ∇w·∇z = 0,        ∂u/∂n = g.

    Parameters
    ----------
    mesh : QuadMesh
        The reference.
    moving, fixed : ndarray of int
        Ascending nodes on the moving body and on the rest of the boundary.
    normals : {"kept", "turned"}
        "kept": g = 0, lines of the mesh keep direction and spacing where they leave the boundary (clamped). "turned":
        g = n' - n, they turn with the boundary, n and n' being its unit normals before and after the move; both are
        the same for a translation.
    incremental : bool
        Solve for the increment from the last accepted state on its mesh, assembled and factorised in each move.
        Otherwise everything is factorised once, on the reference.

    References
    ----------
    Helenbrook, Int. J. Numer. Meth. Engng 56 (2003) 1007–1021, doi:10.1002/nme.595; Ciarlet, Raviart, in: Mathematical
    Aspects of Finite Elements in Partial Differential Equations, Academic Press 1974, 125–145.
    """

    mesh: QuadMesh
    moving: Index
    fixed: Index
    normals: Literal["kept", "turned"] = field(default="kept", kw_only=True)
    incremental: bool = field(default=False, kw_only=True)
    _roles: NodeRoles = field(init=False, repr=False)
    _elements: Elements = field(init=False, repr=False)
    _tangents: BoundaryTangents = field(init=False, repr=False)
    _system: CondensedSystem = field(init=False, repr=False)
    _factor: _MixedFactor | None = field(init=False, repr=False, default=None)

    def __post_init__(self) -> None:
        if self.normals not in ("kept", "turned"):
            raise ValueError(f"normals is {self.normals!r}; expected 'kept' or 'turned'.")
        roles, elements = NodeRoles.of(self.mesh, self.moving, self.fixed), Elements.of(self.mesh)
        given = np.zeros((len(self.mesh.points), 2), dtype=bool)  # w before u
        given[roles.given, 1] = True
        for name, value in (
            ("moving", roles.moving),
            ("fixed", roles.fixed),
            ("_roles", roles),
            ("_elements", elements),
            ("_tangents", BoundaryTangents.of(self.mesh)),
            ("_system", CondensedSystem(elements.cells, elements.boundary, given)),
        ):
            object.__setattr__(self, name, value)
        if not self.incremental:
            object.__setattr__(self, "_factor", self._factorised(self.mesh.points))

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions; see `FullMeshMover.move`."""
        start = self._roles.start(current, self.incremental)
        given = self._roles.displacement(start, positions)
        load = np.zeros_like(given)
        if self.normals == "turned":
            load = self._tangents.change_of_normal_load(start, self._roles.placed(start, positions))
        return self._roles.placed(start + self._solved(start, given, load), positions)

    def displacement(self, given: Array, load: Array) -> Array:
        """Displacement from the reference for any normal derivative g.

        Parameters
        ----------
        given : ndarray, shape (n, 2)
            Displacement of moving and fixed nodes; what is there at free nodes is not read.
        load : ndarray, shape (n, 2)
            ∮ g N_i ds.
        """
        return self._solved(self.mesh.points, given, load)

    def _solved(self, start: Array, given: Array, load: Array) -> Array:
        factor = self._factor or self._factorised(start)
        return factor.solve(given, load)

    def _factorised(self, points: Array) -> _MixedFactor:
        elements, geometry = self._elements, self._elements.geometry(points)
        scale = _scale(elements, geometry)
        local = scale.reshape(-1)[self._system.dofs]
        i = elements.cells.shape[1]

        def matrices(some: slice) -> Array:
            weights = geometry.weights[some]
            A = np.zeros((len(weights), i, 2, i, 2))
            K = elements.stiffness(np.eye(2)[:, :, None, None] * weights, geometry.J_inv[:, :, some])
            A[:, :, 0, :, 0] = elements.mass(weights)
            A[:, :, 0, :, 1] = A[:, :, 1, :, 0] = -K
            return A.reshape(len(weights), 2 * i, 2 * i) * local[some, :, None] * local[some, None, :]

        return _MixedFactor(self._system.factorise(matrices), scale)


@dataclass(frozen=True, eq=False)
class _MixedFactor:
    """The factorised mixed form in unknowns w/scale[:, 0], u/scale[:, 1]."""

    factor: CondensedFactor
    scale: Array  # (n, 2)

    def solve(self, given: Array, load: Array) -> Array:
        values, rhs = np.zeros((2, len(given), 2, 2))
        values[:, 1] = given / self.scale[:, 1, None]
        rhs[:, 0] = -load * self.scale[:, 0, None]
        return self.factor.solve(values, rhs if load.any() else None)[:, 1] * self.scale[:, 1, None]


def _scale(elements: Elements, geometry: Geometry) -> Array:
    """Sizes of w and u at each node, shape (n, 2), that make diagonal and coupling of a node one.

    With them no pivoting is needed: the sizes of the entries of M and K differ by the area of an element.
    """
    metric = np.einsum("cdeq,kdeq->ckeq", geometry.J_inv, geometry.J_inv) * geometry.weights
    squares = np.einsum("qic,qik->ckqi", elements.dN, elements.dN).reshape(-1, elements.cells.shape[1])
    stiffness = metric.transpose(2, 0, 1, 3).reshape(len(elements.cells), -1) @ squares
    mass = geometry.weights @ elements.N**2
    nodes = elements.cells.ravel()
    m, k = (np.bincount(nodes, weights=diagonal.ravel()) for diagonal in (mass, stiffness))
    return np.stack([1.0 / np.sqrt(m), np.sqrt(m) / k], axis=-1)
