"""Initial velocities that the boundary or continuity contradicts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hofsi.build import FluidPart
from hofsi.kernels import navier_stokes as kernel
from hofsi.solvers import fluid_integrals

Array = NDArray[np.float64]

__all__ = ["start"]

_NOTICEABLE = 1e-3  # parts of the velocity and of its gradient from which a contradiction is told

_ROUNDING = 1e-8  # of the velocity: a gradient (its L² norm in the plane is a velocity) that is rounding


def start(fluid: FluidPart, time: float) -> Iterator[str]:
    """Say where an initial velocity disagrees with the conditions at the start, and how much divergence it has."""
    solver, points = fluid.solver, fluid.mesh.points
    if solver.fluid.initial_velocity is None:
        return
    state = solver.initial_state(time)
    velocity, still = state.velocity, np.zeros(points.shape)
    largest = float(np.abs(velocity).max())
    nobody = velocity[solver.boundary.interface]
    apart = np.hypot(*(solver.boundary.impose(velocity, points, still, nobody, time) - velocity).T)
    worst = int(np.argmax(apart))
    if apart[worst] > _NOTICEABLE * largest:
        x, y = points[worst]
        yield (
            f"fluid.initial_velocity: at ({x:.6g}, {y:.6g}) it differs by {apart[worst]:.4g} from what the boundary "
            "has there: an impulsive start, with large forces in the first steps"
        )
    geometry, space = solver.geometry(points), solver.space
    gradient = kernel.velocity_gradient(space.velocity.dN, geometry.J_inv, velocity[space.velocity_cells])
    with np.errstate(over="ignore", invalid="ignore"):  # absurd velocities fail in the first step
        size = float(np.sqrt((geometry.weights * (gradient**2).sum(axis=(0, 1))).sum()))
        divergence = fluid_integrals.divergence(solver, state)
    if divergence > _NOTICEABLE * size > _ROUNDING * largest:
        yield (
            f"fluid.initial_velocity: its divergence is {100.0 * divergence / size:.2g} % of its gradient (L² norms); "
            "the first step removes it at once, by a pressure that is large as an impulse. Give a velocity without "
            "divergence if the first steps matter"
        )
