"""Errors of a flow in L², by more quadrature points than the solver uses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.element import boundary_first, element_table
from hofsi.fem.geometry import element_geometry
from hofsi.fem.spaces import permuted
from hofsi.solvers.fluid import FluidSolver, FluidState
from manufactured_flows.flow import Flow

Array = NDArray[np.float64]

__all__ = ["l2_errors"]

_MORE = 5
"""Quadrature points in each direction beyond order + 1; the solver has 1."""


def l2_errors(flow: Flow, solver: FluidSolver, state: FluidState) -> tuple[float, float]:
    """L² norms of the errors of velocity and pressure; of an enclosed flow the pressures' means are removed first.

    Parameters
    ----------
    flow : Flow
    solver : FluidSolver
    state : FluidState
    """
    space, points = solver.space, state.points[0]
    p = space.velocity.order
    nodes = boundary_first(p)[0]
    velocity = permuted(element_table(p, p + 1 + _MORE), nodes)
    pressure = permuted(element_table(p - 1, p + 1 + _MORE), boundary_first(p - 1)[0])
    geometry = element_geometry(points[space.velocity_cells], velocity)
    w = geometry.weights
    u = velocity.N @ state.velocity[space.velocity_cells] - flow.velocity_at(geometry.x, state.time)
    q = state.pressure[space.pressure_cells] @ pressure.N.T - flow.pressure_at(geometry.x, state.time)
    if len(solver.enclosed(points)):
        q -= np.sum(w * q) / np.sum(w)
    return float(np.sqrt(np.sum(w[..., None] * u**2))), float(np.sqrt(np.sum(w * q**2)))
