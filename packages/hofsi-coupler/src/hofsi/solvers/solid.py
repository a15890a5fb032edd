"""Elastic solids on one mesh: time steps and static equilibrium, state in and state out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hofsi.solvers.solid_problem import SolidProblem
from hofsi.solvers.solid_rest import check_held
from hofsi.solvers.solid_state import SolidMemory, SolidState
from hofsi.solvers.solid_step import SolidStep
from hofsi.timestepping.second_order import backward_difference, generalised_alpha, midpoint

Array = NDArray[np.float64]

__all__ = ["SolidMemory", "SolidSolver", "SolidState", "SolidStep"]


class SolidSolver(SolidProblem):
    """Steps of solids; made with the parameters of `SolidProblem`."""

    def initial_state(self, time: float = 0.0) -> SolidState:
        """State from the initial displacement and velocity of the case, at rest where none is given.

        Where solids touch, the later one in the case decides.
        """
        d, v = np.zeros(self.mesh.points.shape), np.zeros(self.mesh.points.shape)
        for solid, own in zip(self.solids, self.equations.cells_of, strict=True):
            nodes = np.unique(self.mesh.cells[own])
            x, y = self.mesh.points[nodes].T
            for field, given in ((d, solid.initial_displacement), (v, solid.initial_velocity)):
                for a, expression in enumerate(given or ()):
                    field[nodes, a] = expression.evaluate(x=x, y=y)
        if self.scheme.name != "generalised-alpha":
            return SolidState((d,), (v,), time)
        return SolidState((d,), (v,), time, accelerations=(self._initial_acceleration(d, time),))

    def _initial_acceleration(self, displacement: Array, time: float) -> Array:
        """Acceleration under the loads of the case without a fluid; 0 where the solids are held."""
        equations = self.equations
        gradient = equations.gradient(displacement)
        force = equations.loads.dead(time).copy()
        for pressure in equations.loads.pressures(time):
            pressure.add_force(force, displacement)
        force = force - equations.internal_force(gradient, equations.stress(gradient))
        factor = self.system.factorise(equations.element_masses())
        return factor.solve(equations.shared(force)).reshape(-1, 2)

    def begin_step(
        self, state: SolidState, steps: Sequence[float], time: float, *, starting: bool = False
    ) -> SolidStep:
        """Start a time step that ends at ``time``.

        Backward differences are of first order as long as the state knows one time only.

        Parameters
        ----------
        state : SolidState
        steps : sequence of float
            This step's size and the one before it, newest first.
        time : float
            At the end of the step.
        starting : bool
            Make a step of backward differences whatever the scheme: they need no load and no acceleration at the start.
        """
        h = steps[0]
        if starting or self.scheme.name == "bdf2":
            motion = backward_difference(state.displacements, state.velocities, steps)
        elif self.scheme.name == "generalised-alpha":
            acceleration, radius = state.accelerations[0], self.scheme.spectral_radius
            motion = generalised_alpha(state.displacement, state.velocity, acceleration, h, radius)
        else:
            motion = midpoint(state.displacement, state.velocity, h)
        return SolidStep(self, state, motion, tuple(steps[:2]), time)

    def begin_static(self, state: SolidState | None = None) -> SolidStep:
        """Start a search for static equilibrium, from a state or from the initial one.

        Raises
        ------
        CaseError
            If the supports leave a part of the solids free to move without deforming.
        """
        check_held(self.mesh, self.solids, self.equations.cells_of, self.supports.constraints.entries)
        start = self.initial_state() if state is None else state
        return SolidStep(self, start, None, (), start.time)
