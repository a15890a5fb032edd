"""What a case needs and what it does not: counts and choices, found without running anything."""

from __future__ import annotations

from hofsi.case import Case
from hofsi.case_checks import check_case
from hofsi.plan.bodies import fluid_items, solid_items
from hofsi.plan.coupling import coupling_items
from hofsi.plan.meshes import meshes_of
from hofsi.plan.report import Item, Plan
from hofsi.plan.series import output_items, time_items
from hofsi.plan.skipped import skipped_items

__all__ = ["Item", "Plan", "plan"]


def plan(case: Case) -> Plan:
    """Check a case completely, its mesh included, and say what a run of it needs.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Plan

    Raises
    ------
    HoblockError
        If there is no such block structure.
    CaseError
        If an element would be invalid, or the case cannot be simulated.
    """
    check_case(case)
    meshes = meshes_of(case)
    bodies = (*fluid_items(case, meshes), *solid_items(case, meshes), *coupling_items(case, meshes))
    built = (*bodies, *time_items(case), *output_items(case))
    return Plan(built, tuple(skipped_items(case, meshes)))
