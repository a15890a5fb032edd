"""The mesh as a neo-Hookean solid under large strains."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers.condensed_system import CondensedFactor, CondensedSystem
from full_mesh_movers.elastic import lame_parameters
from full_mesh_movers.elements import Elements, Geometry
from full_mesh_movers.errors import MotionFailed
from full_mesh_movers.neo_hookean_law import energy, moduli, stress
from full_mesh_movers.node_roles import NodeRoles
from full_mesh_movers.stiffening import Kind, Stiffening
from hoblock import QuadMesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["NeoHooke"]

_PARTS = 50
_SMALLEST_PART = 2.0**-8
"""Of the rest of the way; and how many parts there may be."""

_ROUGH, _FINE = 1e-4, 1e-6
"""Longest last Newton step, by the size of the smallest element, on the way and at its end."""


@dataclass(frozen=True, eq=False)
class NeoHooke:
    """All nodes follow as those of a compressible neo-Hookean solid, whose energy is infinite at det F = 0.

    The reference is free of stress. The energy is minimised by Newton's method with a backtracking line search, which
    starts from the last accepted state. If the whole way to the new positions fails, it is divided into parts; if that
    fails, it is tried again from the reference. What is returned is an equilibrium for the given positions, the same
    for every start that leads to the same branch.

    Parameters
    ----------
    mesh : QuadMesh
        The reference.
    moving, fixed : ndarray of int
        Ascending nodes on the moving body and on the rest of the boundary.
    stiffening : {"distance", "area", "jacobian"}
        What Young's modulus depends on, on the reference; see `Stiffening`.
    exponent : float
    poissons_ratio : float
        In (-1, 0.5).
    points : int
        Gauss–Lobatto points in each direction, p + 3 by default, at least 3. det F is positive there, which includes
        the corners and sides of the elements, where it usually changes its sign first, and not necessarily elsewhere.
    iterations : int
        Newton steps at most, for each part of the way.

    Notes
    -----
    `move` raises `MotionFailed` if no equilibrium is found, also with small parts of the way.
    """

    mesh: QuadMesh
    moving: Index
    fixed: Index
    stiffening: Kind = field(default="distance", kw_only=True)
    exponent: float = field(default=-1.5, kw_only=True)
    poissons_ratio: float = field(default=0.3, kw_only=True)
    points: int | None = field(default=None, kw_only=True)
    iterations: int = field(default=25, kw_only=True)
    _roles: NodeRoles = field(init=False, repr=False)
    _elements: Elements = field(init=False, repr=False)
    _geometry: Geometry = field(init=False, repr=False)
    _system: CondensedSystem = field(init=False, repr=False)
    _size: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        lame_parameters(self.poissons_ratio)
        points = self.mesh.order + 3 if self.points is None else self.points
        if points < 3:
            raise ValueError(f"points is {points}; expected at least 3.")
        roles = NodeRoles.of(self.mesh, self.moving, self.fixed)
        elements = Elements.of(self.mesh, points)
        geometry = elements.geometry(self.mesh.points)
        stiffening = Stiffening.of(self.mesh, roles.moving, self.stiffening, self.exponent)
        E = stiffening.factor(elements, geometry, self.mesh.points)
        given = np.zeros(self.mesh.points.shape, dtype=bool)
        given[roles.given] = True
        for name, value in (
            ("moving", roles.moving),
            ("fixed", roles.fixed),
            ("_roles", roles),
            ("_elements", elements),
            ("_geometry", Geometry(geometry.det_J, geometry.J_inv, geometry.weights * E)),
            ("_system", CondensedSystem(elements.cells, elements.boundary, given)),
            ("_size", float(np.sqrt(geometry.weights.sum(axis=1).min()))),
        ):
            object.__setattr__(self, name, value)

    def move(self, current: Array, positions: Array) -> Array:
        """Return all node positions; see `FullMeshMover.move`."""
        current = self._roles.start(current, True)
        end = self.mesh.points + self._roles.displacement(self.mesh.points, positions)
        if np.isfinite(self._energy(current)) and not np.array_equal(current, self.mesh.points):
            try:
                return self._roles.placed(self._carried(current, end), positions)
            except MotionFailed:
                pass
        return self._roles.placed(self._carried(self.mesh.points, end), positions)

    def _carried(self, x: Array, end: Array) -> Array:
        """Go to an end (n, 2), of which only the given nodes are read, in as many parts as it takes."""
        given, done = self._roles.given, 0.0
        for _ in range(_PARTS):
            way = np.zeros_like(x)
            way[given] = end[given] - x[given]
            # Two solutions of the same system: out-of-balance forces, and the whole rest of the way.
            nothing = np.zeros_like(way)
            both = self._tangent(x).solve(
                np.stack([nothing, way], axis=-1), np.stack([-self._force(x), nothing], axis=-1)
            )
            part, moved = 1.0, None
            while moved is None:
                if part < _SMALLEST_PART:
                    raise _stuck(done)
                moved = self._relaxed(x + both[..., 0] + part * both[..., 1], _FINE if part == 1.0 else _ROUGH)
                if moved is not None and part == 1.0:
                    return moved
                part *= 0.5
            x, done = moved, done + 2.0 * part * (1.0 - done)
        raise _stuck(done)

    def _relaxed(self, x: Array, tolerance: float) -> Array | None:
        """Minimise the energy by moving the free nodes; None if this fails."""
        if not np.isfinite(self._energy(x)):
            return None
        try:
            for _ in range(self.iterations):
                force = self._force(x)[:, :, None]
                step = self._tangent(x).solve(np.zeros_like(force), -force)[:, :, 0]
                fraction = self._line_search(x, step)
                if fraction == 0.0:
                    return None
                x = x + fraction * step
                if fraction == 1.0 and np.abs(step).max() < tolerance * self._size:
                    return x
        except MotionFailed:  # a singular tangent
            return None
        return None

    def _line_search(self, x: Array, step: Array) -> float:
        """Fraction of a step that decreases the energy enough; 0 if there is none."""
        before = self._energy(x)
        slope = float((self._force(x) * step)[self._roles.free].sum())
        noise = 1e-13 * (abs(before) + float(self._geometry.weights.sum()))
        if slope > noise:
            return 0.0
        fraction = 1.0
        while fraction > 1e-4:
            if self._energy(x + fraction * step) <= before + 1e-4 * fraction * slope + noise:
                return fraction
            fraction *= 0.5
        return 0.0

    def _deformation(self, x: Array) -> Array:
        F = self._elements.gradient(x - self.mesh.points, self._geometry)
        F[0, 0] += 1.0
        F[1, 1] += 1.0
        return F

    def _energy(self, x: Array) -> float:
        return float(
            (energy(self._deformation(x), *lame_parameters(self.poissons_ratio)) * self._geometry.weights).sum()
        )

    def _force(self, x: Array) -> Array:
        P = stress(self._deformation(x), *lame_parameters(self.poissons_ratio))
        return self._elements.force(P, self._geometry)

    def _tangent(self, x: Array) -> CondensedFactor:
        F, lame = self._deformation(x), lame_parameters(self.poissons_ratio)

        def matrices(some: slice) -> Array:
            A = moduli(F[:, :, some], *lame) * self._geometry.weights[some]
            return self._elements.vector_stiffness(A, self._geometry.J_inv[:, :, some])

        return self._system.factorise(matrices)


def _stuck(done: float) -> MotionFailed:
    return MotionFailed(
        f"neo-Hooke: no equilibrium beyond {done:.3g} of the way to the given positions. The mesh is as far as it can "
        "be driven, or the positions are not those of a body."
    )
