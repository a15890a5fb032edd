"""Cases built to break the numerics, in groups: each has an outcome that is expected beforehand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

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
from stress.still_open import OPEN

__all__ = [
    "AS_EXPECTED",
    "GROUPS",
    "NOT_AS_EXPECTED",
    "OPEN",
    "Numbers",
    "Stops",
    "StressCase",
    "Within",
    "carried_out",
    "surprises",
]

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


def surprises(rows: Sequence[Mapping[str, object]], *, quick: bool) -> list[str]:
    """What of the rows of cases is news: not as expected and not known to be, or known to be and mended.

    Quick cases are smaller, and may be as expected where whole ones are not.
    """
    told = []
    for row in rows:
        known, wrong = row["case"] in OPEN.get(str(row["group"]), ()), row["verdict"] == NOT_AS_EXPECTED
        if wrong and not known:
            told.append(f"{row['group']}: {row['case']}: {row['found']}")
        if known and not wrong and not quick:
            told.append(f"{row['group']}: {row['case']}: as expected now; take it off stress/still_open.py")
    return told
