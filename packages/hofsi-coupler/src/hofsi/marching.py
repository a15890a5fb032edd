"""A fluid or a solid alone: from one state to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from hofsi.clock import Clock
from hofsi.records import CouplingRecord, MarchMemory, State

if TYPE_CHECKING:
    from hofsi.motion import MeshMotion, MeshState
    from hofsi.solvers.fluid import FluidSolver
    from hofsi.solvers.fluid_memory import FluidMemory
    from hofsi.solvers.solid import SolidSolver
    from hofsi.solvers.solid_state import SolidMemory

Array = NDArray[np.float64]

__all__ = ["FluidMarch", "March", "SolidMarch"]


class March(Protocol):
    """Advances a state; the time loop knows nothing else."""

    def initial(self, time: float) -> State:
        """State at the start."""
        ...

    def step(self, state: State, steps: Sequence[float], time: float) -> tuple[State, CouplingRecord | None]:
        """Return the state at ``time``; ``steps`` are the sizes of this step and of those before it, newest first."""
        ...

    def steady(self, state: State) -> tuple[State, CouplingRecord | None]:
        """Return the state at rest."""
        ...

    def memory(self) -> MarchMemory:
        """What is kept between steps besides the state.

        It is that of the last step that was accepted when it is asked for before the next one begins, and stays as it
        is then.
        """
        ...

    def resume(self, state: State, memory: object) -> None:
        """Become what the march was at a state; TypeError if the memory is not one of its own.

        Arrays of the memory that are those of the state, or of the mesh, are the same objects.
        """
        ...


class FluidMarch:
    """A fluid alone, on a mesh at rest or one that moves as prescribed.

    Parameters
    ----------
    solver : FluidSolver
    reference : MeshState
    motion : MeshMotion or None
        None if the mesh stands still.
    displacement : callable or None
        time → displacement (k, 2) of the driven nodes.
    clock : Clock
    """

    def __init__(
        self,
        solver: FluidSolver,
        reference: MeshState,
        motion: MeshMotion | None,
        displacement: Callable[[float], Array] | None,
        clock: Clock,
    ) -> None:
        self._solver, self._reference, self._motion = solver, reference, motion
        self._displacement, self._clock = displacement, clock

    def initial(self, time: float) -> State:
        """Initial velocity on the mesh at the start time."""
        mesh = self._mesh(self._reference, time)
        return State(fluid=self._solver.initial_state(time, mesh.mesh.points), mesh=mesh)

    def _mesh(self, current: MeshState, time: float) -> MeshState:
        if self._motion is None or self._displacement is None:
            return current
        with self._clock.phase("mesh"):
            return self._motion.move(current, self._displacement(time), time)

    def step(self, state: State, steps: Sequence[float], time: float) -> tuple[State, CouplingRecord | None]:
        """Move the mesh and solve the fluid once."""
        assert state.fluid is not None
        assert state.mesh is not None
        mesh = self._mesh(state.mesh, time)
        with self._clock.phase("fluid"):
            fluid, points = state.fluid, mesh.mesh.points
            convection = self._solver.fluid.convection_of_steps(None)
            step = self._solver.begin_step(fluid, points, steps, time, convection=convection)
            step.solve(np.zeros((0, 2)))
            return State(fluid=step.accept(), mesh=mesh), None

    def steady(self, state: State) -> tuple[State, CouplingRecord | None]:
        """Solve for the steady flow on the mesh as it is, from rest by way of lower orders."""
        from hofsi.solvers.lower_order import start_of_lower_order

        assert state.fluid is not None
        assert state.mesh is not None
        with self._clock.phase("fluid"):
            start = start_of_lower_order(self._solver, state.fluid)
            step = self._solver.begin_steady(start, state.mesh.mesh.points)
            step.solve(np.zeros((0, 2)))
            return State(fluid=step.accept(), mesh=state.mesh), None

    def memory(self) -> FluidMemory:
        """What the solver keeps."""
        return self._solver.memory()

    def resume(self, state: State, memory: object) -> None:
        """Become what the solver was at a state."""
        from hofsi.solvers.fluid_memory import FluidMemory

        assert state.fluid is not None
        if not isinstance(memory, FluidMemory):
            raise TypeError(f"memory: got {type(memory).__name__}; expected FluidMemory, of a fluid alone.")
        self._solver.resume(memory, state.fluid)


class SolidMarch:
    """A solid alone."""

    def __init__(self, solver: SolidSolver, clock: Clock) -> None:
        self._solver, self._clock = solver, clock

    def initial(self, time: float) -> State:
        """Initial displacement and velocity."""
        return State(solid=self._solver.initial_state(time))

    def step(self, state: State, steps: Sequence[float], time: float) -> tuple[State, CouplingRecord | None]:
        """Solve the solid once."""
        assert state.solid is not None
        with self._clock.phase("solid"):
            step = self._solver.begin_step(state.solid, steps, time)
            return State(solid=step.accept(step.solve(None))), None

    def steady(self, state: State) -> tuple[State, CouplingRecord | None]:
        """Solve for static equilibrium."""
        assert state.solid is not None
        with self._clock.phase("solid"):
            step = self._solver.begin_static(state.solid)
            return State(solid=step.accept(step.solve(None))), None

    def memory(self) -> SolidMemory:
        """What the solver keeps."""
        return self._solver.memory()

    def resume(self, state: State, memory: object) -> None:
        """Become what the solver was at a state."""
        from hofsi.solvers.solid_state import SolidMemory

        if not isinstance(memory, SolidMemory):
            raise TypeError(f"memory: got {type(memory).__name__}; expected SolidMemory, of a solid alone.")
        self._solver.resume(memory)
