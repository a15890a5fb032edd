"""Dirichlet–Neumann coupling: the solid drives the fluid, the fluid's momentum residual loads the solid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.clock import Clock
from hofsi.coupling.convergence import ConvergenceTest, Residuals
from hofsi.coupling.coupled_memory import CoupledMemory
from hofsi.coupling.failure import coupling_failure, solid_failure
from hofsi.coupling.interface import Interface
from hofsi.coupling.interface_balance import InterfaceBalance
from hofsi.coupling.load import InterfaceLoad
from hofsi.coupling.predictors import predict
from hofsi.coupling.relaxation import Accelerator
from hofsi.coupling.stall import StallWatch, Verdict
from hofsi.errors import ConvergenceError, CouplingError
from hofsi.motion import MeshMotion, MeshState
from hofsi.records import CouplingRecord, State
from hofsi.solvers.fluid import FluidSolver, FluidState, FluidStep
from hofsi.solvers.solid import SolidSolver, SolidState, SolidStep
from hofsi.timestepping.schemes import bdf_weights

Array = NDArray[np.float64]

__all__ = ["CoupledMarch"]

_HISTORY = 6  # interface displacements kept: a cubic predictor needs four, and all that a start needs to fade
_SMALLEST_PART = 1.0 / 64.0  # of the fluid's load, in a steady problem
_NEWTON = 2  # Newton iterations of the fluid in one coupling iteration
_STEADY = "steady coupling"
_INNER = 1e-2  # of the coupling's tolerance: the solid's, at most, so that coupling does not stall in its noise


@dataclass
class _Fields:
    """What the last coupling iteration left behind."""

    fluid: FluidState
    mesh: MeshState
    solid: SolidStep
    displacement: Array


@dataclass
class _Flow:
    """The flow around one displacement of the interface: its load, and the rest when it is asked for.

    Attributes
    ----------
    force : ndarray, shape (k, 2)
        On the solid, at the nodes of the interface.
    converged : bool
        Whether the flow itself has.
    finish : callable
        Makes the flow's state, whose load confirms ``force``, and its mesh.
    """

    force: Array
    converged: bool
    finish: Callable[[], tuple[FluidState, MeshState]]


class CoupledMarch:
    """Strong coupling of a fluid and one or several solids.

    Parameters
    ----------
    fluid : FluidSolver
        Its interface nodes are those of ``interface.fluid``.
    solid : SolidSolver
    interface : Interface
    motion : MeshMotion
    prescribed : callable
        time → displacement (k, 2) of the driven nodes, zero on the interface.
    settings : CouplingSettings
    accelerator : Accelerator
    clock : Clock
    """

    def __init__(
        self,
        fluid: FluidSolver,
        solid: SolidSolver,
        interface: Interface,
        motion: MeshMotion,
        prescribed: Callable[[float], Array],
        settings: case.CouplingSettings,
        accelerator: Accelerator,
        clock: Clock,
    ) -> None:
        self._fluid, self._solid, self._interface, self._motion = fluid, solid, interface, motion
        self._prescribed, self._settings = prescribed, settings
        self._accelerator, self._clock = accelerator, clock
        self._test = ConvergenceTest(settings.tolerance, settings.force_tolerance)
        self._rows = np.searchsorted(motion.driven.nodes, interface.fluid)
        held = np.logical_and.reduce(solid.supports.constraints.fixed[interface.solid], axis=1)
        self._load = InterfaceLoad(fluid, interface, held)
        self._balance = InterfaceBalance(fluid, interface, self._load)
        self._regenerated = 0  # blocks, in the meshes of the step at hand
        self._believing = True  # responses of the fluid, until its fields tell another force

    def initial(self, time: float) -> State:
        """Initial fields; the fluid mesh fits the solid's initial displacement."""
        solid = self._solid.initial_state(time)
        d = solid.displacement[self._interface.solid]
        mesh = self._motion.move(self._motion.reference, self._driven(d, time), time)
        return State(self._fluid.initial_state(time, mesh.mesh.points), solid, mesh, (d,))

    def memory(self) -> CoupledMemory:
        """What is kept between steps besides the state."""
        return CoupledMemory(self._fluid.memory(), self._solid.memory(), self._accelerator.memory(), self._test.largest)

    def resume(self, state: State, memory: object) -> None:
        """Become what the solvers and the coupling were at a state."""
        fluid = _parts(state)[0]
        if not isinstance(memory, CoupledMemory):
            raise TypeError(f"memory: got {type(memory).__name__}; expected CoupledMemory, of a coupled problem.")
        self._fluid.resume(memory.fluid, fluid)
        self._solid.resume(memory.solid)
        self._accelerator.recall(memory.accelerator)
        self._test.recall(memory.largest)

    def _driven(self, d: Array, time: float) -> Array:
        displacement = self._prescribed(time)
        displacement[self._rows] = d
        return displacement

    def _move(self, current: MeshState, d: Array, time: float) -> MeshState:
        with self._clock.phase("mesh"):
            moved = self._motion.move(current, self._driven(d, time), time)
        self._regenerated += moved.regenerated
        return moved

    def step(self, state: State, steps: Sequence[float], time: float) -> tuple[State, CouplingRecord | None]:
        """One time step, iterated until displacement and force have converged."""
        fluid, solid, mesh = _parts(state)
        order = min(2, len(state.interface), len(steps), len(fluid.velocities))
        c = bdf_weights(steps[:order])
        rest = np.tensordot(c[1:], np.stack(state.interface[:order]), axes=1)
        self._regenerated = 0
        predicted = predict(state.interface, steps, self._settings.predictor, solid.velocity[self._interface.solid])
        # The load at the start is not known, and the error of the first step, which is of first order, fades from the
        # differences of displacements by 1/3 a step. Other schemes than BDF2 would remember both.
        solid_step = self._solid.begin_step(solid, steps, time, starting=len(state.interface) < _HISTORY)
        implicit = self._settings.geometry == "implicit"
        convection = self._fluid.fluid.convection_of_steps(self._settings)

        responding = not implicit and not self._load.needs_fields

        def begin(d: Array, before: FluidStep | None) -> tuple[FluidStep, MeshState]:
            moved = self._move(mesh, d, time)
            with self._clock.phase("fluid"):
                step = self._fluid.begin_step(
                    fluid, moved.mesh.points, steps, time, convection=convection, responding=responding
                )
                if before is not None:
                    step.continue_from(before)
                return step, moved

        fixed = None if implicit else begin(predicted, None)
        last: FluidStep | None = None

        def flow(d: Array) -> _Flow:
            nonlocal last
            last, moved = fixed or begin(d, last)
            return self._flow(last, moved, c[0] * d + rest, _NEWTON if implicit else None)

        self._test.begin_step(state.interface[0], self._load.evaluate(fluid))
        fields, record = self._iterate(predicted, flow, solid_step, f"coupling, t = {time:g}")
        d = fields.displacement[self._interface.solid]
        with self._clock.phase("solid"):
            accepted = solid_step.accept(fields.displacement)
        reached = State(fields.fluid, accepted, fields.mesh, (d, *state.interface[: _HISTORY - 1]))
        with self._clock.phase("coupling"):
            return reached, self._balance.completed(record, state, reached, steps[0])

    def steady(self, state: State) -> tuple[State, CouplingRecord | None]:
        """Iterate steady flow and static equilibrium on meshes that fit the current displacement.

        The start is the initial displacement, if there is one, or the solid without the fluid's load. If that fails,
        the load is applied in parts.
        """
        solid = _parts(state)[1]
        self._regenerated = 0
        solid_step = self._solid.begin_static(solid)
        start = solid.displacement if solid.displacement.any() else self._unloaded(solid_step)
        try:
            fields, record = self._steady(state, start, solid_step, 1.0)
        except ConvergenceError:
            unloaded = self._unloaded(self._solid.begin_static(solid))
            fields, record = self._steady_by_parts(state, unloaded)
        d = fields.displacement[self._interface.solid]
        return State(fields.fluid, fields.solid.accept(fields.displacement), fields.mesh, (d,)), record

    def _unloaded(self, solid_step: SolidStep) -> Array:
        """The displacement without the fluid's load."""
        with self._clock.phase("solid"):
            return solid_step.solve(None)

    def _steady_by_parts(self, state: State, displacement: Array) -> tuple[_Fields, CouplingRecord]:
        """Apply the fluid's load in parts, from one steady state to the next."""
        done, part = 0.0, 0.25
        while True:
            reached = min(1.0, done + part)
            try:
                solid_step = self._solid.begin_static(_parts(state)[1])
                fields, record = self._steady(state, displacement, solid_step, reached)
            except ConvergenceError as error:
                part *= 0.5
                if part < _SMALLEST_PART:
                    raise error.extended(
                        f"Applied little by little, {done:.3g} of the fluid's load was reached: there may be no steady "
                        "state near the start, as of a solid that buckles or is too soft for the flow. Lower the load, "
                        "stiffen the solid, give an initial_displacement nearer to the state, or march in time."
                    ) from error
                continue
            if reached == 1.0:
                return fields, record
            displacement, done, part = fields.displacement, reached, 1.5 * part

    def _steady(
        self, state: State, displacement: Array, solid_step: SolidStep, share: float
    ) -> tuple[_Fields, CouplingRecord]:
        """Steady state under a share of the fluid's load, sought from a displacement of the solid."""
        fluid, _, mesh = _parts(state)
        at_rest = np.zeros((len(self._interface.fluid), 2))
        last: FluidStep | None = None

        def flow(d: Array) -> _Flow:
            nonlocal last
            moved = self._move(mesh, d, fluid.time)
            with self._clock.phase("fluid"):
                step = self._fluid.begin_steady(fluid, moved.mesh.points)
                if last is not None:
                    step.continue_from(last)
            last = step
            return self._flow(step, moved, at_rest)

        self._test.begin_step(0.0, 0.0)
        return self._iterate(displacement[self._interface.solid], flow, solid_step, _STEADY, share)

    def _flow(self, step: FluidStep, mesh: MeshState, velocity: Array, max_iterations: int | None = None) -> _Flow:
        """The flow of a step for a velocity of the interface: solved for, or the step's response to it."""

        def solve() -> tuple[FluidState, MeshState]:
            with self._clock.phase("fluid"):
                step.solve(velocity, max_iterations=max_iterations)
                return step.accept(), mesh

        with self._clock.phase("fluid"):
            reaction = step.respond(velocity) if self._believing else None
        if reaction is not None:
            return _Flow(-reaction, True, solve)
        state, mesh = solve()
        with self._clock.phase("fluid"):
            return _Flow(self._load.evaluate(state), step.converged, lambda: (state, mesh))

    def _iterate(
        self,
        d: Array,
        flow: Callable[[Array], _Flow],
        solid_step: SolidStep,
        where: str,
        share: float = 1.0,
    ) -> tuple[_Fields, CouplingRecord]:
        """Fixed-point iteration d ↦ d̃ with acceleration; one that fails takes the accelerator's memory with it."""
        try:
            return self._iterated(d, flow, solid_step, where, share)
        except ConvergenceError:
            self._accelerator.forget()
            raise

    def _iterated(
        self,
        d: Array,
        flow: Callable[[Array], _Flow],
        solid_step: SolidStep,
        where: str,
        share: float,
    ) -> tuple[_Fields, CouplingRecord]:
        """Fixed-point iteration d ↦ d̃ with acceleration, under a share of the fluid's load."""
        settings, interface = self._settings, self._interface
        self._accelerator.begin_step()
        self._believing = True
        inner = min(self._solid.nonlinear.tolerance, _INNER * settings.tolerance)
        displacement: Array | None = None
        residuals, watch = Residuals(np.inf, np.inf), StallWatch()
        verdict: Verdict = ""
        for iteration in range(1, settings.max_iterations + 1):
            now = flow(d)
            force = now.force
            try:
                with self._clock.phase("solid"):
                    displacement = solid_step.solve(share * self._nodal(force), displacement, tolerance=inner)
            except ConvergenceError as error:
                raise solid_failure(error, watch, where) from error
            image = displacement[interface.solid]
            residual = image - d
            if not (np.isfinite(residual).all() and np.isfinite(force).all()):
                raise CouplingError(f"displacement or force is not finite in iteration {iteration}.", "diverged", where)
            residuals = self._test.residuals(image, residual, force)
            excess = self._test.excess(residuals)
            if now.converged and excess <= 1.0:
                fluid, moved = now.finish()
                self._believing = self._test.confirms(force, self._load.evaluate(fluid))
                if self._believing:
                    self._accelerator.end_step()
                    record = CouplingRecord(iteration, residuals.displacement, residuals.force)
                    mesh = replace(moved, regenerated=self._regenerated)
                    return _Fields(fluid, mesh, solid_step, displacement), record
            verdict = watch.observe(image, residual, excess)
            if verdict:
                break
            with self._clock.phase("coupling"):
                d = self._accelerator.next(d.ravel(), residual.ravel()).reshape(-1, 2)
        raise coupling_failure(verdict, residuals, self._test, watch, settings, where, steady=where == _STEADY)

    def _nodal(self, force: Array) -> Array:
        nodal = np.zeros(self._solid.mesh.points.shape)
        nodal[self._interface.solid] = force
        return nodal


def _parts(state: State) -> tuple[FluidState, SolidState, MeshState]:
    assert state.fluid is not None
    assert state.solid is not None
    assert state.mesh is not None
    return state.fluid, state.solid, state.mesh
