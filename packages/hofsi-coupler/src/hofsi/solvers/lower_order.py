"""A steady flow on the same elements at a lower order: where the search at the order asked for starts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hoblock.reference import gauss_lobatto
from hoblock.resampling import resample
from hofsi.errors import LinearSolverError, MeshMotionError, NewtonError
from hofsi.fem.resampling import gathered, lexicographic, resampled
from hofsi.fem.spaces import TaylorHood
from hofsi.solvers.fluid import FluidSolver, FluidState

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["start_of_lower_order"]

_WORTH_IT = 6  # lowest order whose systems cost enough for a detour
_LOWEST = 4  # order: a flow of order 3 is too far from one of order 6 or 7
_ROUGH = 1e-4  # tolerance of the residual there; what the lower order leaves out is larger


def start_of_lower_order(solver: FluidSolver, state: FluidState) -> FluidState:
    """Replace a state at rest by the steady flow of half the order, at least 4, which starts from half of that in turn.

    The lower order costs a tenth to a fifth; from its solution Newton's method makes one or two matrices instead of
    five.

    Parameters
    ----------
    solver : FluidSolver
        Of the order asked for, without an interface.
    state : FluidState

    Returns
    -------
    FluidState
        The given state if it is not at rest, if the order is low, the model linear, or the lower order fails, for
        example because its elements are invalid.

    References
    ----------
    Hackbusch: Multi-Grid Methods and Applications, Springer 1985, doi:10.1007/978-3-662-02427-0, Chapter 5 (nested
    iteration).
    """
    order = max(_LOWEST, solver.mesh.order // 2)
    if solver.mesh.order < _WORTH_IT or not solver.convecting or state.velocity.any():
        return state
    low = resample(solver.mesh.with_points(state.points[0]), order)
    nonlinear = replace(solver.nonlinear, tolerance=max(_ROUGH, solver.nonlinear.tolerance))
    nobody = np.zeros(0, dtype=np.int64)
    try:
        lower = FluidSolver(low, solver.fluid, nonlinear, solver.linear, nobody)
        start = start_of_lower_order(lower, lower.initial_state(state.time))
        velocity, pressure = lower.begin_steady(start, low.points).solve(np.zeros((0, 2)))
    except (NewtonError, LinearSolverError, MeshMotionError):
        return state
    velocity, pressure = _on_higher_order(lower.space, solver.space, velocity, pressure)
    solver.counts.iterations_below += lower.counts.iterations + lower.counts.iterations_below
    return replace(state, velocities=(velocity,), pressure=pressure)


def _on_higher_order(low: TaylorHood, high: TaylorHood, velocity: Array, pressure: Array) -> tuple[Array, Array]:
    """Velocity and pressure in the spaces of a higher order: the same functions."""
    velocity = _raised(
        velocity[lexicographic(low.velocity_cells, low.velocity.order)],
        lexicographic(high.velocity_cells, high.velocity.order),
        high.velocity_count,
    )
    pressure = _raised(
        pressure[lexicographic(low.pressure_cells, low.pressure.order)],
        lexicographic(high.pressure_cells, high.pressure.order),
        high.pressure_count,
    )
    return velocity, pressure


def _raised(values: Array, cells: Index, count: int) -> Array:
    """Nodal array (count, ...) of element values (e, i, ...) of a lower order, on elements (e, j) of a higher one."""
    order = round(cells.shape[1] ** 0.5) - 1
    return gathered(resampled(values, gauss_lobatto(order)), cells, count)
