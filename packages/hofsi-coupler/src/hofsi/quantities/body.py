"""The fluid and the solid that a quantity is of: their part of the problem, and their state after a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hofsi.build import FluidPart, Problem, SolidPart
from hofsi.errors import CaseError
from hofsi.records import StepRecord

if TYPE_CHECKING:
    from hofsi.motion import MeshState
    from hofsi.solvers.fluid import FluidState
    from hofsi.solvers.solid import SolidState

__all__ = ["fluid_of", "fluid_state", "mesh_state", "solid_of", "solid_state"]


def fluid_of(problem: Problem, place: str) -> FluidPart:
    """Return the fluid of a problem.

    Raises
    ------
    CaseError
        If there is none.
    """
    if problem.fluid is None:
        raise CaseError("it is of the fluid, and there is no [fluid]. Remove the quantity", place)
    return problem.fluid


def solid_of(problem: Problem, place: str) -> SolidPart:
    """Return the solids of a problem.

    Raises
    ------
    CaseError
        If there are none.
    """
    if problem.solid is None:
        raise CaseError("it is of a solid, and there is no [[solid]]. Remove the quantity", place)
    return problem.solid


def fluid_state(record: StepRecord) -> FluidState:
    """Return the fluid after a step of a problem that has one."""
    assert record.state.fluid is not None
    return record.state.fluid


def solid_state(record: StepRecord) -> SolidState:
    """Return the solids after a step of a problem that has some."""
    assert record.state.solid is not None
    return record.state.solid


def mesh_state(record: StepRecord) -> MeshState:
    """Return the position of the fluid's mesh after a step of a problem with a fluid."""
    assert record.state.mesh is not None
    return record.state.mesh
