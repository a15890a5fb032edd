"""Initial velocities that the boundary or continuity contradicts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hofsi.build import FluidPart
from hofsi.kernels import navier_stokes as kernel
from hofsi.solvers import fluid_integrals
from hofsi.solvers.fluid import FluidSolver

Array = NDArray[np.float64]

__all__ = ["start"]

_NOTICEABLE = 1e-3  # parts of the velocity and of its gradient from which a contradiction is told
_SAME = 1e-9  # of the largest velocity: differences between periodic sides that are rounding
_ROUNDING = 1e-8  # of the velocity: a gradient (its L² norm in the plane is a velocity) that is rounding


def start(fluid: FluidPart, time: float) -> Iterator[str]:
    """Say where an initial velocity disagrees with the conditions at the start, and how much divergence it has."""
    solver, points = fluid.solver, fluid.mesh.points
    if solver.fluid.initial_velocity is None:
        return
    yield from _differences(solver)
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


def _differences(solver: FluidSolver) -> Iterator[str]:
    """Say where it differs at periodic sides."""
    points = solver.mesh.points
    given = solver.initial_velocity(points)
    largest = float(np.abs(given).max())
    for sides in solver.periodic:
        apart = np.hypot(*(given[sides.nodes[:, 0]] - given[sides.nodes[:, 1]]).T)
        worst = int(np.argmax(apart))
        if apart[worst] > _SAME * largest:
            (x, y), (u, v) = (points[sides.nodes[worst, k]] for k in range(2))
            yield (
                f"fluid.initial_velocity: it differs by {apart[worst]:.4g} between ({x:.6g}, {y:.6g}) and "
                f"({u:.6g}, {v:.6g}), which are the same place by {sides.place}: the velocity at one of them is taken. "
                "Give one with the period of the sides"
            )
