"""Moments of the fluid's force on edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.locate import interpolation_weights
from hofsi import case
from hofsi.build import FluidPart, Problem
from hofsi.quantities.body import fluid_of, fluid_state, mesh_state
from hofsi.quantities.evaluator import Evaluator, VectorEvaluator
from hofsi.quantities.force import boundary_force
from hofsi.quantities.place import attached
from hofsi.records import StepRecord

Array = NDArray[np.float64]

__all__ = ["moment"]


def moment(problem: Problem, asked: case.Moment) -> Evaluator:
    """Return the moment about a vertex, which moves with the mesh, or about a place given as a function of time.

    Raises
    ------
    CaseError
        If there is no fluid, the edges are not at its boundary, or the vertex does not belong to it.
    """
    fluid = fluid_of(problem, asked.place)
    boundary = boundary_force(fluid, asked)
    center = _center(fluid, asked)
    return lambda record: asked.factor * boundary.moment(fluid_state(record), center(record))


def _center(fluid: FluidPart, asked: case.Moment) -> VectorEvaluator:
    if isinstance(asked.about, case.Point):
        location = attached(fluid, asked.about, f"{asked.place}.about")
        nodes, weights = fluid.mesh.cells[location.element], interpolation_weights(location, fluid.mesh.order)
        return lambda record: weights @ mesh_state(record).mesh.points[nodes]
    x, y = asked.about

    def center(record: StepRecord) -> Array:
        return np.array([float(part.evaluate(t=record.time)) for part in (x, y)])

    return center
