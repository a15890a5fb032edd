"""One time step of solids, or static equilibrium: solved as often as needed, then accepted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.errors import ConvergenceError, NewtonError
from hofsi.solvers.load_response import LoadResponse
from hofsi.solvers.solid_newton import SolidNewton
from hofsi.solvers.solid_problem import SolidProblem
from hofsi.solvers.solid_state import SolidState
from hofsi.timestepping.second_order import MotionStep, load_weights

Array = NDArray[np.float64]

__all__ = ["SolidStep"]


class SolidStep:
    """One time step, or static equilibrium; made by `SolidSolver`.

    Parameters
    ----------
    solver : SolidProblem
    state : SolidState
        At the start.
    motion : MotionStep, or None
        What the time scheme makes of the step; None for statics.
    steps : tuple of float
        Its size and that of the step before it, newest first; empty for statics.
    time : float
        At the end.
    """

    def __init__(
        self, solver: SolidProblem, state: SolidState, motion: MotionStep | None, steps: tuple[float, ...], time: float
    ) -> None:
        self.solver, self.state, self.time = solver, state, time
        self._motion, self._steps = motion, steps
        equations = solver.equations
        point = time if motion is None else time - (1.0 - motion.share) * steps[0]
        self._dead = equations.loads.dead(point)
        self._load: Array | None = None
        self._response: tuple[Array, Array] | None = None  # matrices of one at the end of the step and at the point
        gradient = equations.gradient(state.displacement)
        factor = 0.0 if motion is None else motion.mass_factor
        self._newton = SolidNewton(
            equations,
            solver.supports,
            solver.system,
            solver.nonlinear,
            solver.counts,
            time,
            self._impose,
            factor,
            None if motion is None else motion.history,
            equations.loads.pressures(point),
            equations.stress(gradient),
            solver.tangent(factor),
            gradient if motion is not None and motion.averaged else None,
        )

    def _impose(self, point: Array) -> Array:
        """The supports at the end of the step hold there, whatever that means for the point of equilibrium."""
        if self._motion is None:
            return self.solver.supports.impose(point, self.time)
        end = self._motion.end(point)
        change = self.solver.supports.impose(end, self.time) - end
        return point + self._motion.share * change  # exactly the point where nothing is held

    def solve(
        self,
        load: Array | None = None,
        guess: Array | None = None,
        *,
        tolerance: float | None = None,
        response: LoadResponse | None = None,
    ) -> Array:
        """Find the displacement under a load.

        Later calls, with other loads, reuse the tangent's factors as long as they serve.

        Parameters
        ----------
        load : ndarray, shape (n, 2), optional
            Nodal forces of the fluid, besides the loads of the case.
        guess : ndarray, shape (n, 2), optional
            Where to start; by default the state at the start of the step, or, with a response, what the motion there
            lets expect if that is nearer to equilibrium.
        tolerance : float, optional
            Instead of the case's.
        response : LoadResponse, optional
            What the load gains with the displacement found; see `SolidProblem.takes_response`.

        Returns
        -------
        ndarray, shape (n, 2)

        Raises
        ------
        NewtonError, LinearSolverError
            If neither Newton's method from the guess nor applying the load little by little succeeds.
        """
        self._load = load
        force, motion = self._force(load), self._motion
        start = self.state.displacement if guess is None else guess
        start = start if motion is None else motion.point(start)
        tolerance = self.solver.nonlinear.tolerance if tolerance is None else tolerance
        newton = self._newton
        newton.response = None if response is None else self._at_point(response)
        try:
            if guess is None and response is not None and motion is not None:
                start = newton.nearer(start, motion.point(self._expected()), force)
            result = newton.solve(start, force, tolerance)
        except ConvergenceError:
            if self.solver.equations.linear:
                raise
            result = newton.solve_by_parts(self.state.displacement, force, tolerance)
        finally:
            newton.response = None
        self.solver.keep(newton.tangent)
        found = result if motion is None else motion.end(result)
        if load is not None and response is not None:
            self._load = load.copy()
            response.add_force(self._load, found)
        return found

    def _expected(self) -> Array:
        """The displacement at the end of the step that the motion at its start lets expect."""
        state, h = self.state, self._steps[0]
        expected = state.displacement + h * state.velocity
        if state.accelerations:
            expected += 0.5 * h * h * state.accelerations[0]
        elif len(state.velocities) > 1 and len(self._steps) > 1:
            expected += 0.5 * h * h / self._steps[1] * (state.velocities[0] - state.velocities[1])
        return expected

    def reaction(self, displacement: Array, load: Array | None = None) -> Array:
        """Forces of the supports on the solid, shape (n, 2): internal force + inertia - loads where it is held.

        At the end of the step, where the midpoint rule has no acceleration: it is extrapolated from two middles. What
        moving supports exert on their own mass oscillates with the schemes that are not backward differences.
        """
        if self._motion is None or self._motion.share == 1.0:
            return self.solver.supports.held_part(self._newton.residual(displacement, self._force(load)))
        equations = self.solver.equations
        gradient = equations.gradient(displacement)
        force = equations.loads.dead(self.time) + (0.0 if load is None else load)
        for pressure in equations.loads.pressures(self.time):
            pressure.add_force(force, displacement)
        internal = equations.internal_force(gradient, equations.stress(gradient))
        return self.solver.supports.held_part(
            internal + equations.mass @ self._final_acceleration(displacement) - force
        )

    def _final_acceleration(self, displacement: Array) -> Array:
        assert self._motion is not None
        acceleration = self._motion.acceleration(displacement)
        if not self._motion.averaged or not self.state.accelerations:
            return acceleration
        h = self._steps[0]
        return np.asarray(acceleration + h / (h + self.state.step) * (acceleration - self.state.accelerations[0]))

    def accept(self, displacement: Array) -> SolidState:
        """Return the state at the end of the step, its reaction under the load that was solved for last.

        Raises
        ------
        NewtonError
            If the solid is turned inside out somewhere: det F is not positive.
        """
        equations = self.solver.equations
        lowest = equations.lowest_volume_ratio(displacement)
        if not lowest > 0.0:
            raise NewtonError(
                f"the solid is turned inside out: det F is {lowest:.3g} somewhere; must be positive. "
                "Take smaller time steps, refine the mesh, or check the loads.",
                "inverted",
                f"solid, t = {self.time:g}",
            )
        reaction = self.reaction(displacement, self._load)
        motion = self._motion
        loads = () if self._load is None else (self._load, *self.state.loads[:1])
        if motion is None:
            return SolidState((displacement,), (np.zeros(displacement.shape),), self.time, reaction, loads=loads)
        displacements = displacement, self.state.displacement
        velocities = motion.velocity(displacement), self.state.velocity
        accelerations = () if self.solver.scheme.name == "bdf2" else (motion.acceleration(displacement),)
        return SolidState(displacements, velocities, self.time, reaction, accelerations, loads, self._steps[0])

    def _at_point(self, response: LoadResponse) -> LoadResponse:
        """The response of a load at the end of the step as one at the point of equilibrium."""
        motion = self._motion
        if motion is None or motion.share == 1.0:
            return response
        share = motion.share
        about = share * response.about + (1.0 - share) * motion.start[response.nodes]
        if self._response is None or self._response[0] is not response.matrix:
            self._response = response.matrix, self._load_weights()[0] / share * response.matrix
        return LoadResponse(response.nodes, self._response[1], about)

    def _force(self, load: Array | None) -> Array:
        """Nodal forces at the point of equilibrium for a load of the fluid at the end of the step."""
        if load is None:
            return self._dead
        loads = load, *self.state.loads
        return np.asarray(self._dead + sum(w * f for w, f in zip(self._load_weights(), loads, strict=False)))

    def _load_weights(self) -> tuple[float, ...]:
        """Shares of the fluid's loads at the ends of this step and of those before at the point of equilibrium."""
        share = 1.0 if self._motion is None else self._motion.share
        before = self.state.loads
        if share == 1.0 or not before:
            return (1.0,)
        return load_weights(share, self.state.step / self._steps[0] if len(before) > 1 else 0.0)
