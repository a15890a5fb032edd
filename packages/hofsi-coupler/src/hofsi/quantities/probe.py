"""Fields at points, and differences of the pressure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.locate import interpolation_weights
from hofsi import case
from hofsi.build import FluidPart, Problem, SolidPart
from hofsi.fem.element import boundary_first
from hofsi.quantities.body import fluid_of, fluid_state, mesh_state, solid_of, solid_state
from hofsi.quantities.evaluator import Evaluator, VectorEvaluator, component_of
from hofsi.quantities.place import attached, tracked
from hofsi.records import StepRecord

Array = NDArray[np.float64]

__all__ = ["pressure_difference", "probe"]


def probe(problem: Problem, asked: case.Probe) -> Evaluator:
    """Return a field at a point.

    Raises
    ------
    CaseError
        If there is no such body, or the point is not in it.
    """
    place, component = f"{asked.place}.at", asked.component or "magnitude"
    if asked.of == "solid":
        return component_of(_solid_vector(solid_of(problem, asked.place), asked, place), component)
    fluid = fluid_of(problem, asked.place)
    if asked.field == "pressure":
        return _pressure(fluid, asked.at, place)
    if asked.field == "displacement":
        return component_of(_mesh_displacement(fluid, asked.at, place), component)
    if asked.field == "vorticity":
        return _vorticity(fluid, asked.at, place)
    return component_of(_velocity(fluid, asked.at, place), component)


def pressure_difference(problem: Problem, asked: case.PressureDifference) -> Evaluator:
    """Return the pressure at one point minus that at another.

    Raises
    ------
    CaseError
        As `probe`.
    """
    fluid = fluid_of(problem, asked.place)
    start = _pressure(fluid, asked.start, f"{asked.place}.from")
    end = _pressure(fluid, asked.end, f"{asked.place}.to")
    return lambda record: start(record) - end(record)


def _solid_vector(solid: SolidPart, asked: case.Probe, place: str) -> VectorEvaluator:
    """Displacement or velocity of a material point."""
    location = attached(solid, asked.at, place)
    nodes = solid.mesh.cells[location.element]
    weights = interpolation_weights(location, solid.mesh.order)
    if asked.field == "displacement":
        return lambda record: weights @ solid_state(record).displacement[nodes]
    return lambda record: weights @ solid_state(record).velocity[nodes]


def _mesh_displacement(fluid: FluidPart, at: case.Point, place: str) -> VectorEvaluator:
    location = attached(fluid, at, place)
    nodes = fluid.mesh.cells[location.element]
    weights = interpolation_weights(location, fluid.mesh.order)
    reference = weights @ fluid.mesh.points[nodes]
    return lambda record: weights @ mesh_state(record).mesh.points[nodes] - reference


def _velocity(fluid: FluidPart, at: case.Point, place: str) -> VectorEvaluator:
    where = tracked(fluid, at, place)

    def evaluate(record: StepRecord) -> Array:
        location = where(record)
        if location is None:
            return np.full(2, np.nan)
        nodes = fluid.mesh.cells[location.element]
        return np.asarray(interpolation_weights(location, fluid.mesh.order) @ fluid_state(record).velocity[nodes])

    return evaluate


def _pressure(fluid: FluidPart, at: case.Point, place: str) -> Evaluator:
    where = tracked(fluid, at, place)
    order = fluid.mesh.order - 1
    permutation = boundary_first(order)[0]

    def evaluate(record: StepRecord) -> float:
        location = where(record)
        if location is None:
            return float("nan")
        weights = interpolation_weights(location, order)[permutation]
        return float(weights @ fluid_state(record).pressure[fluid.solver.space.pressure_cells[location.element]])

    return evaluate


def _vorticity(fluid: FluidPart, at: case.Point, place: str) -> Evaluator:
    where = tracked(fluid, at, place)

    def evaluate(record: StepRecord) -> float:
        from hofsi.solvers.fluid_vorticity import vorticity_at

        location = where(record)
        if location is None:
            return float("nan")
        return vorticity_at(mesh_state(record).mesh, location, fluid_state(record).velocity)

    return evaluate
