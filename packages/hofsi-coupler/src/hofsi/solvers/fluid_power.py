"""Power that enters a fluid through its boundary, other than through its interface with solids, and by body forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.fem.geometry import side_geometry
from hofsi.solvers.fluid import FluidSolver, FluidState
from hofsi.solvers.fluid_flow import BoundaryFlow
from hofsi.solvers.fluid_forces import given_traction, named_sides

Array = NDArray[np.float64]

__all__ = ["FluidPower"]


class FluidPower:
    """What the surroundings do to a fluid per unit time, from its own equations.

    Where the velocity is given the force of the boundary is the residual of the momentum equation, so that in a steady
    flow the balance with dissipation and convected energy holds to the accuracy of the solution, not only to that of
    its stresses.

    Parameters
    ----------
    solver : FluidSolver
    """

    def __init__(self, solver: FluidSolver) -> None:
        self._solver = solver
        self._dry = np.setdiff1d(np.arange(solver.space.velocity_count), solver.boundary.interface)
        self._loaded = [
            (condition, named_sides(solver.mesh, condition.on))
            for condition in solver.fluid.boundaries
            if isinstance(condition, case.Traction | case.Pressure | case.DoNothing | case.Velocity)
        ]
        self._flow = BoundaryFlow(solver)

    def external(self, state: FluidState) -> float:
        """Power of walls, given velocities, given tractions and body forces."""
        power = float((state.reaction[self._dry] * state.velocity[self._dry]).sum())
        return power + self._of_tractions(state) + self._of_body_force(state)

    def interface(self, state: FluidState) -> float:
        """Power of the solids at the interface."""
        nodes = self._solver.boundary.interface
        return float((state.reaction[nodes] * state.velocity[nodes]).sum())

    def convected(self, state: FluidState) -> float:
        """∮ ρ |u|²/2 (u - w)·n, the kinetic energy that leaves with the fluid."""
        return self._flow.kinetic_energy_rate(state)

    def _of_tractions(self, state: FluidState) -> float:
        solver, space, power = self._solver, self._solver.space, 0.0
        for condition, sides in self._loaded:
            for group in side_geometry(state.points[0][space.velocity_cells], sides, space.velocity_sides):
                u = group.table.N @ state.velocity[space.velocity_cells[group.elements]]
                power += float((given_traction(solver, condition, group, state) * u).sum())
        return power

    def _of_body_force(self, state: FluidState) -> float:
        force, space = self._solver.fluid.body_force, self._solver.space
        if force is None:
            return 0.0
        geometry = self._solver.geometry(state.points[0])
        u = space.velocity.N @ state.velocity[space.velocity_cells]
        x, y = geometry.x[..., 0], geometry.x[..., 1]
        density = sum(f.evaluate(x=x, y=y, t=state.time) * u[..., a] for a, f in enumerate(force))
        return float((geometry.weights * density).sum())
