"""What flows through parts of the fluid's boundary, and the mean pressure there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.geometry import SideGeometry, side_geometry
from hofsi.fem.sides import boundary_sides
from hofsi.solvers.fluid import FluidSolver, FluidState
from hofsi.solvers.fluid_forces import named_sides

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BoundaryFlow"]


class BoundaryFlow:
    """Integrals over element sides at the fluid's boundary, exact for its polynomials; n points out of the fluid.

    Parameters
    ----------
    solver : FluidSolver
    names : sequence of str or None
        Of the mesh's edges, each side counts once; None for the whole boundary.
    sides : ndarray, shape (k, 2), optional
        Elements and sides instead.

    Raises
    ------
    CaseError
        If a name is unknown or its edges are not at the fluid's boundary.
    """

    def __init__(self, solver: FluidSolver, names: Sequence[str] | None = None, *, sides: Index | None = None) -> None:
        self._solver = solver
        if sides is None:
            sides = boundary_sides(solver.mesh) if names is None else named_sides(solver.mesh, names)
        self._sides = sides

    def rate(self, state: FluidState, *, relative: bool = False) -> float:
        """Return ∫ u·n, the volume per unit time and depth that leaves, or ∫ (u - w)·n relative to the mesh."""
        return float(sum(flow.sum() for flow in self._flows(state, relative=relative)))

    def inflow(self, state: FluidState) -> float:
        """Return ∫ max(-u·n, 0), what enters where fluid enters; walls that recede let it in."""
        return -float(sum(np.minimum(flow, 0.0).sum() for flow in self._flows(state, relative=False)))

    def kinetic_energy_rate(self, state: FluidState) -> float:
        """Return ∫ ρ |u|²/2 (u - w)·n, the kinetic energy per unit time and depth that leaves with the fluid."""
        solver, rate = self._solver, 0.0
        for group, flow in zip(self._groups(state), self._flows(state, relative=True), strict=True):
            u = group.table.N @ state.velocity[solver.space.velocity_cells[group.elements]]
            rate += 0.5 * solver.fluid.density * float(((u * u).sum(axis=-1) * flow).sum())
        return rate

    def mean_pressure(self, state: FluidState) -> float:
        """Return ∫ p ds/∫ ds."""
        space = self._solver.space
        force = length = 0.0
        for group in self._groups(state):
            p = state.pressure[space.pressure_cells[group.elements]] @ space.pressure_sides[group.number].N.T
            force += float((p * group.lengths).sum())
            length += float(group.lengths.sum())
        return force / length

    def _flows(self, state: FluidState, *, relative: bool) -> Iterator[Array]:
        """Velocity·n times length and weight at the points of groups of sides, each (k, q)."""
        velocity = state.velocity
        if relative and state.mesh_velocity is not None:
            velocity = velocity - state.mesh_velocity
        for group in self._groups(state):
            u = group.table.N @ velocity[self._solver.space.velocity_cells[group.elements]]
            yield np.einsum("kqa,kqa->kq", u, group.normals)

    def _groups(self, state: FluidState) -> list[SideGeometry]:
        space = self._solver.space
        return side_geometry(state.points[0][space.velocity_cells], self._sides, space.velocity_sides)
