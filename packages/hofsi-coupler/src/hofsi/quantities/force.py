"""Forces on edges, of the fluid on bodies and walls or of solids on their surroundings."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.build import FluidPart, Problem, SolidPart
from hofsi.errors import CaseError
from hofsi.quantities.body import fluid_of, fluid_state, solid_state
from hofsi.quantities.evaluator import VectorEvaluator, kept
from hofsi.records import StepRecord

if TYPE_CHECKING:
    from hofsi.coupling.interface import Interface
    from hofsi.solvers.fluid_forces import BoundaryForce

Array = NDArray[np.float64]

__all__ = ["boundary_force", "force"]


def force(problem: Problem, asked: case.Force) -> VectorEvaluator:
    """Return both components of a force; kept for the last state, because drag and lift ask for the same one.

    Raises
    ------
    CaseError
        If the edges are not at the boundary of the body.
    """
    fluid, solid = problem.fluid, problem.solid
    if solid is not None and (fluid is None or _is_dry(fluid, solid, asked)):
        return kept(_solid_force(problem, solid, asked))
    boundary = boundary_force(fluid_of(problem, asked.place), asked)
    return kept(lambda record: boundary.evaluate(fluid_state(record)))


def _is_dry(fluid: FluidPart, solid: SolidPart, asked: case.Force) -> bool:
    """Whether the edges of a force are at solids and not at the fluid."""
    wet, dry = (any(len(part.mesh.edge_groups.get(name, ())) for name in asked.on) for part in (fluid, solid))
    return dry and not wet


def boundary_force(fluid: FluidPart, asked: case.Force | case.Moment) -> BoundaryForce:
    """Return the fluid's force on the edges that a quantity names.

    Raises
    ------
    CaseError
        If they are not at the fluid's boundary.
    """
    from hofsi.solvers.fluid_forces import BoundaryForce

    try:
        return BoundaryForce(fluid.solver, asked.on)
    except CaseError as error:
        raise CaseError(error.problem, f"{asked.place}.on") from error


def _solid_force(problem: Problem, solid: SolidPart, asked: case.Force) -> VectorEvaluator:
    """Force of a solid on its surroundings at dry edges."""
    from hofsi.solvers.solid_forces import SolidForce

    try:
        boundary = SolidForce(solid.solver, asked.on)
    except CaseError as error:
        raise CaseError(error.problem, f"{asked.place}.on") from error
    if problem.fluid is None or problem.interface is None:
        return lambda record: boundary.evaluate(solid_state(record))
    correction = _load_of_walls(problem.fluid, solid, problem.interface)

    def evaluate(record: StepRecord) -> Array:
        state = solid_state(record)
        assert state.reaction is not None
        return boundary.evaluate(replace(state, reaction=state.reaction - correction(record)))

    return evaluate


def _load_of_walls(fluid: FluidPart, solid: SolidPart, interface: Interface) -> VectorEvaluator:
    """Part of the nodal load (n, 2) that acts on walls of the fluid, at interface nodes where the solid is fixed.

    It does not move the solid, so the coupling leaves it in the load; the reaction must not contain it.
    """
    from hofsi.coupling.load import InterfaceLoad

    fixed = solid.solver.supports.constraints.fixed[interface.solid]
    load = InterfaceLoad(fluid.solver, interface, ~(fixed[:, 0] & fixed[:, 1]))

    def evaluate(record: StepRecord) -> Array:
        state = fluid_state(record)
        walls = np.zeros(solid.mesh.points.shape)
        walls[interface.solid] = load.evaluate(state) + state.reaction[interface.fluid]
        return walls

    return evaluate
