"""The mesh as a linear elastic solid."""

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

__all__ = ["Elastic", "lame_parameters"]


def lame_parameters(poissons_ratio: float) -> tuple[float, float]:
    """λ and μ of plane strain for Young's modulus 1.

    Raises
    ------
    ValueError
        If Poisson's ratio is not in (-1, 0.5).
    """
    if not -1.0 < poissons_ratio < 0.5:
        raise ValueError(f"poissons_ratio is {poissons_ratio:g}; expected one in (-1, 0.5). Try 0.3.")
    return poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio)), 0.5 / (1.0 + poissons_ratio)


@dataclass(frozen=True, eq=False)
class Elastic:
    """All nodes follow as those of a linear elastic solid in plane strain, with elements of the order of the mesh.

    Parameters
    ----------
    mesh : QuadMesh
        The reference.
    moving, fixed : ndarray of int
        Ascending nodes on the moving body and on the rest of the boundary.
    stiffening : {"distance", "area", "jacobian"}
        What Young's modulus depends on: the distance from the moving body, the area of the element (A/A_min)^exponent,
        or det J; see `Stiffening`.
    exponent : float
        Stein and Tezduyar's χ is ``stiffening="jacobian", exponent=-χ``; χ = 1 drops det J from the integrals.
    poissons_ratio : float
        In (-1, 0.5).
    incremental : bool
        Solve for the increment from the last accepted state on its mesh, with the stiffening of that mesh, assembled
        and factorised in each move.
    cached : bool
        Whether a one-step method factorises once. Without, it assembles and factorises in each move, with the same
        result; what does not change with the mesh (pattern, order of elimination) is kept.

    References
    ----------
    Stein, Tezduyar, Benney, J. Appl. Mech. 70 (2003) 58–63, doi:10.1115/1.1530635.
    """

    mesh: QuadMesh
    moving: Index
    fixed: Index
    stiffening: Kind = field(default="distance", kw_only=True)
    exponent: float = field(default=-1.0, kw_only=True)
    poissons_ratio: float = field(default=0.3, kw_only=True)
    incremental: bool = field(default=False, kw_only=True)
    cached: bool = field(default=True, kw_only=True)
    _roles: NodeRoles = field(init=False, repr=False)
    _elements: Elements = field(init=False, repr=False)
    _stiffening: Stiffening = field(init=False, repr=False)
    _system: CondensedSystem = field(init=False, repr=False)
    _factor: CondensedFactor | None = field(init=False, repr=False, default=None)

    def __post_init__(self) -> None:
        lame_parameters(self.poissons_ratio)
        roles, elements = NodeRoles.of(self.mesh, self.moving, self.fixed), Elements.of(self.mesh)
        given = np.zeros(self.mesh.points.shape, dtype=bool)
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
        if self.cached and not self.incremental:
            object.__setattr__(self, "_factor", self._factorised(self.mesh.points))

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions; see `FullMeshMover.move`."""
        start = self._roles.start(current, self.incremental)
        given = self._roles.displacement(start, positions)
        factor = self._factor or self._factorised(start)
        return self._roles.placed(start + factor.solve(given[:, :, None])[:, :, 0], positions)

    def _factorised(self, points: Array) -> CondensedFactor:
        geometry = self._elements.geometry(points)
        E = self._stiffening.factor(self._elements, geometry, points) * geometry.weights
        unit = _moduli(*lame_parameters(self.poissons_ratio))[..., None, None]

        def matrices(some: slice) -> Array:
            return self._elements.vector_stiffness(unit * E[some], geometry.J_inv[:, :, some])

        return self._system.factorise(matrices)


def _moduli(lame_lambda: float, lame_mu: float) -> Array:
    """A_aDbC = λ δ_aD δ_bC + μ (δ_ab δ_DC + δ_aC δ_bD)."""
    I = np.eye(2)
    return (
        lame_lambda * np.einsum("ad,bc->adbc", I, I)
        + lame_mu * np.einsum("ab,dc->adbc", I, I)
        + lame_mu * np.einsum("ac,bd->adbc", I, I)
    )
