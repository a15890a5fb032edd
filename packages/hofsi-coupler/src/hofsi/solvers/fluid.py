"""The incompressible Navier–Stokes equations on a moving mesh: from one state to the next step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hofsi.case import Convection
from hofsi.fem.element_matrices import TracedMatrices
from hofsi.solvers.fluid_equations import FluidEquations
from hofsi.solvers.fluid_matrices import MatrixOrigin
from hofsi.solvers.fluid_memory import FluidMemory
from hofsi.solvers.fluid_operator import FluidOperator
from hofsi.solvers.fluid_state import FluidState
from hofsi.solvers.fluid_step import FluidStep
from hofsi.timestepping.schemes import bdf_weights, extrapolation_weights

Array = NDArray[np.float64]

__all__ = ["FluidSolver", "FluidState", "FluidStep"]


class FluidSolver(FluidEquations):
    """Steps of one fluid; made with the parameters of `FluidEquations`."""

    def initial_state(self, time: float = 0.0, points: Array | None = None) -> FluidState:
        """State from the initial velocity of the case, or at rest, on the reference mesh or the given points."""
        points = self.mesh.points if points is None else points
        self.check_periodic(points, time)
        velocity = self.space.copied(self.initial_velocity(points))
        return FluidState((velocity,), np.zeros(self.space.pressure_count), (points,), np.zeros(points.shape), time)

    def initial_velocity(self, points: Array) -> Array:
        """The initial velocity of the case as it is given, shape (n, 2); zero if it is not."""
        velocity = np.zeros(points.shape)
        if self.fluid.initial_velocity is not None:
            for a, expression in enumerate(self.fluid.initial_velocity):
                velocity[:, a] = expression.evaluate(x=points[:, 0], y=points[:, 1])
        return velocity

    def resume(self, memory: FluidMemory, state: FluidState) -> None:
        """Become what the solver was when it came to a state and `memory` was asked for.

        Parameters
        ----------
        memory : FluidMemory
            Its arrays that are the same as those of the state are the same objects.
        state : FluidState
        """

        def matrices(origin: MatrixOrigin) -> TracedMatrices:
            if origin.velocity is None or origin.mesh_velocity is None:
                return TracedMatrices(self.constant_terms(origin.points, origin.rate).ask().matrices, origin)
            nothing = np.zeros(origin.points.shape)
            operator = FluidOperator(
                self, origin.points, origin.mesh_velocity, origin.rate, nothing, state.time, share=origin.share
            )
            return operator.matrices(origin.velocity, newton=origin.newton)

        self.recall(memory, matrices)

    def begin_step(
        self,
        state: FluidState,
        points: Array,
        steps: Sequence[float],
        time: float,
        *,
        convection: Convection,
        responding: bool = False,
    ) -> FluidStep:
        """Start a time step that ends at ``time`` on a mesh with node positions ``points``.

        Parameters
        ----------
        state : FluidState
        points : ndarray, shape (n, 2)
            The same array as before if the mesh stands still.
        steps : sequence of float
            This step's size and those before it, newest first.
        time : float
            At the end of the step.
        convection : {"newton", "picard", "linearised", "extrapolated"}
            The last two expect the velocity extrapolated from the last steps (second order): the step is linear.
        responding : bool
            Whether the step will be solved for several velocities of the interface.
        """
        self.check_periodic(points, time)
        order = min(2, len(state.velocities), len(steps))
        c = bdf_weights(steps[:order])
        history = np.tensordot(c[1:], np.stack(state.velocities[:order]), axes=1)
        mesh_velocity = np.zeros(points.shape)
        if any(points is not old for old in state.points):
            moving = [points, *state.points][: order + 1]
            mesh_velocity = np.tensordot(c, np.stack(moving), axes=1)
        e = extrapolation_weights(steps, order - 1)
        expected = np.tensordot(e, np.stack(state.velocities[:order]), axes=1)
        if convection in ("linearised", "extrapolated"):
            relative = expected - mesh_velocity
            self.boundary.stick(relative, points, mesh_velocity)
            expected = relative + mesh_velocity
        rate = float(c[0])
        return FluidStep(
            self, state, points, mesh_velocity, rate, history, time, expected, order, convection, responding
        )

    def begin_steady(self, state: FluidState, points: Array) -> FluidStep:
        """Start a search for the steady state on a mesh at rest."""
        self.check_periodic(points, state.time)
        self.enclosed(points).expect_held()
        zero = np.zeros(points.shape)
        iteration: Convection = "picard" if self.fluid.convection == "picard" else "newton"
        return FluidStep(self, state, points, zero, 0.0, zero, state.time, state.velocity, 0, iteration)
