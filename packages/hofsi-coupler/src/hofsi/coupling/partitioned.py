"""Dirichlet–Neumann coupling: the solid drives the fluid, the fluid's momentum residual loads the solid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.case import Convection
from hofsi.clock import Clock
from hofsi.coupling.coupled_memory import CoupledMemory
from hofsi.coupling.fixed_point import FixedPoint, Flow, Solution
from hofsi.coupling.gap import InterfaceGap
from hofsi.coupling.interface import Interface
from hofsi.coupling.interface_balance import InterfaceBalance
from hofsi.coupling.load import InterfaceLoad
from hofsi.coupling.predictors import predict
from hofsi.coupling.relaxation import Accelerator
from hofsi.errors import ConvergenceError
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
        self._clock = clock
        self._rows = np.searchsorted(motion.driven.nodes, interface.fluid)
        held = np.logical_and.reduce(solid.supports.constraints.fixed[interface.solid], axis=1)
        self._load = InterfaceLoad(fluid, interface, held)
        self._balance = InterfaceBalance(fluid, interface, self._load)
        self._iteration = FixedPoint(self._load, solid, interface, settings, accelerator, clock)
        self._gap = InterfaceGap(motion.reference.mesh, interface.fluid)
        self._regenerated = 0  # blocks, in the meshes of the step at hand

    def initial(self, time: float) -> State:
        """Initial fields; the fluid mesh fits the solid's initial displacement."""
        solid = self._solid.initial_state(time)
        d = solid.displacement[self._interface.solid]
        mesh = self._motion.move(self._motion.reference, self._driven(d, time), time)
        return State(self._fluid.initial_state(time, mesh.mesh.points), solid, mesh, (d,))

    def memory(self) -> CoupledMemory:
        """What is kept between steps besides the state."""
        accelerator, test = self._iteration.accelerator, self._iteration.test
        return CoupledMemory(self._fluid.memory(), self._solid.memory(), accelerator.memory(), test.largest)

    def resume(self, state: State, memory: object) -> None:
        """Become what the solvers and the coupling were at a state."""
        fluid = _parts(state)[0]
        if not isinstance(memory, CoupledMemory):
            raise TypeError(f"memory: got {type(memory).__name__}; expected CoupledMemory, of a coupled problem.")
        self._fluid.resume(memory.fluid, fluid)
        self._solid.resume(memory.solid)
        self._iteration.accelerator.recall(memory.accelerator)
        self._iteration.test.recall(memory.largest)

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
        implicit, where = self._settings.geometry == "implicit", f"coupling, t = {time:g}"
        convection = self._fluid.fluid.convection_of_steps(self._settings)

        def begin(d: Array, convection: Convection, *, responding: bool) -> tuple[FluidStep, MeshState]:
            moved = self._move(mesh, d, time)
            with self._clock.phase("fluid"):
                step = self._fluid.begin_step(
                    fluid, moved.mesh.points, steps, time, convection=convection, responding=responding
                )
                return step, moved

        fixed = None if implicit else begin(predicted, convection, responding=True)
        last: FluidStep | None = None

        def flow(d: Array) -> Flow:
            nonlocal last
            velocity, rate = c[0] * d + rest, float(c[0])
            if fixed is not None:
                return self._checked(self._flow(*fixed, velocity, rate=rate), d - predicted, where)
            if last is None and self._iteration.condensing and self._fluid.responds(mesh.mesh.points):
                # A linear step to begin with: where the interface goes to, about, and how the load answers.
                last, moved = begin(d, "linearised", responding=True)
                return replace(self._flow(last, moved, velocity, rate=rate), converged=False, affine=False)
            step, moved = begin(d, convection, responding=False)
            if last is not None:
                step.continue_from(last, velocity)
            last = step
            return self._flow(step, moved, velocity, _NEWTON, rate=rate)

        self._iteration.test.begin_step(state.interface[0], self._load.evaluate(fluid))
        found = self._iteration.solve(predicted, flow, solid_step, where)
        reached = self._reached(found, solid_step, state.interface)
        with self._clock.phase("coupling"):
            return reached, self._balance.completed(found.record, state, reached, steps[0])

    def _checked(self, flow: Flow, gap: Array, where: str) -> Flow:
        """A flow that may be completed only if its mesh is near enough."""

        def finish() -> tuple[FluidState, MeshState]:
            self._gap.check(gap, where)
            return flow.finish()

        return replace(flow, finish=finish)

    def _reached(self, found: Solution, solid_step: SolidStep, interface: tuple[Array, ...]) -> State:
        """The state of a solution, after steps with these displacements of the interface."""
        d = found.displacement[self._interface.solid]
        with self._clock.phase("solid"):
            accepted = solid_step.accept(found.displacement)
        mesh = replace(found.mesh, regenerated=self._regenerated)
        return State(found.fluid, accepted, mesh, (d, *interface[: _HISTORY - 1]))

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
            found = self._steady(state, start, solid_step, 1.0)
        except ConvergenceError:
            unloaded = self._unloaded(self._solid.begin_static(solid))
            found, solid_step = self._steady_by_parts(state, unloaded)
        return self._reached(found, solid_step, ()), found.record

    def _unloaded(self, solid_step: SolidStep) -> Array:
        """The displacement without the fluid's load."""
        with self._clock.phase("solid"):
            return solid_step.solve(None)

    def _steady_by_parts(self, state: State, displacement: Array) -> tuple[Solution, SolidStep]:
        """Apply the fluid's load in parts, from one steady state to the next."""
        done, part = 0.0, 0.25
        while True:
            reached = min(1.0, done + part)
            try:
                solid_step = self._solid.begin_static(_parts(state)[1])
                found = self._steady(state, displacement, solid_step, reached)
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
                return found, solid_step
            displacement, done, part = found.displacement, reached, 1.5 * part

    def _steady(self, state: State, displacement: Array, solid_step: SolidStep, share: float) -> Solution:
        """Steady state under a share of the fluid's load, sought from a displacement of the solid."""
        fluid, _, mesh = _parts(state)
        at_rest = np.zeros((len(self._interface.fluid), 2))
        last: FluidStep | None = None

        def flow(d: Array) -> Flow:
            nonlocal last
            moved = self._move(mesh, d, fluid.time)
            with self._clock.phase("fluid"):
                step = self._fluid.begin_steady(fluid, moved.mesh.points)
                if last is not None:
                    step.continue_from(last)
            last = step
            return self._flow(step, moved, at_rest)

        self._iteration.test.begin_step(0.0, 0.0)
        d = displacement[self._interface.solid]
        return self._iteration.solve(d, flow, solid_step, "steady coupling", share=share, steady=True)

    def _flow(
        self,
        step: FluidStep,
        mesh: MeshState,
        velocity: Array,
        max_iterations: int | None = None,
        *,
        rate: float = 0.0,
    ) -> Flow:
        """The flow of a step for a velocity of the interface: solved for, or the step's response to it.

        The velocity changes with the displacement at this rate.
        """

        def stiffness() -> Array | None:
            return step.interface_stiffness(rate)

        def solve() -> tuple[FluidState, MeshState]:
            with self._clock.phase("fluid"):
                step.solve(velocity, max_iterations=max_iterations)
                return step.accept(), mesh

        with self._clock.phase("fluid"):
            telling = self._iteration.believing and not self._load.needs_fields
            reaction = step.respond(velocity) if telling else None
        if reaction is not None:
            return Flow(-reaction, True, solve, stiffness, affine=True)
        state, mesh = solve()
        affine = telling and step.responding
        with self._clock.phase("fluid"):
            return Flow(self._load.evaluate(state), step.converged, lambda: (state, mesh), stiffness, affine)


def _parts(state: State) -> tuple[FluidState, SolidState, MeshState]:
    assert state.fluid is not None
    assert state.solid is not None
    assert state.mesh is not None
    return state.fluid, state.solid, state.mesh
