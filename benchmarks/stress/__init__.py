"""Cases built to break the numerics, in groups: each has an outcome that is expected beforehand."""

from __future__ import annotations

from collections.abc import Mapping

from stress import (
    added_mass,
    coupling_tolerances,
    flows,
    gradings,
    long_runs,
    mesh_motion,
    orders,
    solids,
    starts,
    step_sizes,
    thin_flaps,
)
from stress.case import AS_EXPECTED, NOT_AS_EXPECTED, Numbers, Stops, StressCase, Within, carried_out

__all__ = ["AS_EXPECTED", "GROUPS", "NOT_AS_EXPECTED", "Numbers", "Stops", "StressCase", "Within", "carried_out"]

GROUPS: Mapping[str, tuple[StressCase, ...]] = {
    "mesh_motion": mesh_motion.CASES,
    "added_mass": added_mass.CASES,
    "step_sizes": step_sizes.CASES,
    "solids": solids.CASES,
    "thin_flaps": thin_flaps.CASES,
    "flows": flows.CASES,
    "orders": orders.CASES,
    "gradings": gradings.CASES,
    "long_runs": long_runs.CASES,
    "starts": starts.CASES,
    "coupling_tolerances": coupling_tolerances.CASES,
}
