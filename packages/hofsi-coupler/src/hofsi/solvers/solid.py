"""Elastic solids on one mesh: time steps and static equilibrium, state in and state out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi import case
from hofsi.counts import Counts
from hofsi.errors import ConvergenceError, NewtonError
from hofsi.linear.checked import CheckedSolver
from hofsi.solvers.load_response import LoadResponse, unknowns_of
from hofsi.solvers.solid_equations import SolidEquations
from hofsi.solvers.solid_newton import SolidNewton, Tangent
from hofsi.solvers.solid_rest import check_held
from hofsi.solvers.solid_state import SolidMemory, SolidState
from hofsi.solvers.solid_supports import SolidSupports
from hofsi.solvers.solid_system import solid_system
from hofsi.timestepping.second_order import (
    MotionStep,
    backward_difference,
    generalised_alpha,
    load_weights,
    midpoint,
)

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["SolidMemory", "SolidSolver", "SolidState", "SolidStep"]


class SolidSolver:
    """Discretisation of one or several elastic solids.

    Parameters
    ----------
    mesh : QuadMesh
        The solids' blocks only, undeformed.
    solids : sequence of Solid
    nonlinear : NonlinearSettings
    linear : LinearSettings, optional
        By default sparse LU.
    scheme : SolidScheme, optional
        Of time steps; by default backward differences.

    Attributes
    ----------
    equations : SolidEquations
    supports : SolidSupports
    system : CondensedSystem
        The linear systems: LU or multigrid.
    counts : Counts
        What was done so far.
    """

    def __init__(
        self,
        mesh: QuadMesh,
        solids: Sequence[case.Solid],
        nonlinear: case.NonlinearSettings,
        linear: case.LinearSettings | None = None,
        scheme: case.SolidScheme | None = None,
    ) -> None:
        self.scheme = scheme or case.SolidScheme()
        self.mesh, self.solids, self.nonlinear = mesh, tuple(solids), nonlinear
        self.equations = SolidEquations(mesh, solids)
        self.supports = SolidSupports(mesh, solids, self.equations.cells_of)
        self.counts = Counts()
        self.system = solid_system(self.equations, self.supports, linear or case.LinearSettings(), self.counts)
        self._tangent: Tangent | None = None

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

    def takes_response(self, nodes: Index) -> bool:
        """Whether loads may answer to displacements of some nodes: not with iterative solvers or inclined rollers."""
        return self.system.tells_flexibility(unknowns_of(nodes))

    def keep(self, tangent: Tangent | None) -> None:
        """Keep a tangent for later steps if it holds for them: if all solids are linear."""
        if self.equations.linear:
            self._tangent = tangent

    def memory(self) -> SolidMemory:
        """What is kept between steps, so that `resume` can make it again."""
        kept = self._tangent
        if kept is None:
            return SolidMemory(self.counts.copy())
        factor = kept.factor.factor
        return SolidMemory(self.counts.copy(), kept.mass_factor, isinstance(factor, CheckedSolver) and factor.fell_back)

    def resume(self, memory: SolidMemory) -> None:
        """Become what the solver was when `memory` was asked for.

        The tangent of linear solids depends on neither displacement nor loads.
        """
        self._tangent = None
        if memory.mass_factor is not None and self.equations.linear:
            gradient = self.equations.gradient(np.zeros(self.mesh.points.shape))
            K = self.equations.tangent(gradient, self.equations.stress(gradient), memory.mass_factor, ())
            factor = self.system.factorise(K)
            if memory.fell_back and isinstance(factor.factor, CheckedSolver):
                factor.factor.fall_back()
            self._tangent = Tangent(memory.mass_factor, K, factor)
        self.counts.recall(memory.counts)

    def tangent(self, mass_factor: float) -> Tangent | None:
        """Return the tangent that was kept, if it holds for a step with this mass factor."""
        kept = self._tangent
        return kept if kept is not None and kept.mass_factor == mass_factor else None


class SolidStep:
    """One time step, or static equilibrium; made by `SolidSolver`.

    Parameters
    ----------
    solver : SolidSolver
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
        self, solver: SolidSolver, state: SolidState, motion: MotionStep | None, steps: tuple[float, ...], time: float
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
            Where to start; by default what the motion at the start of the step lets expect.
        tolerance : float, optional
            Instead of the case's.
        response : LoadResponse, optional
            What the load gains with the displacement found; see `SolidSolver.takes_response`.

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
        start = self._expected() if guess is None else guess
        start = start if motion is None else motion.point(start)
        tolerance = self.solver.nonlinear.tolerance if tolerance is None else tolerance
        self._newton.response = None if response is None else self._at_point(response)
        try:
            result = self._newton.solve(start, force, tolerance)
        except ConvergenceError:
            if self.solver.equations.linear:
                raise
            result = self._newton.solve_by_parts(self.state.displacement, force, tolerance)
        self.solver.keep(self._newton.tangent)
        return result if motion is None else motion.end(result)

    def _expected(self) -> Array:
        """The displacement at the end of the step that the motion at its start lets expect."""
        state = self.state
        if self._motion is None:
            return state.displacement
        h = self._steps[0]
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
