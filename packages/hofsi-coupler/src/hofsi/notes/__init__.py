"""What users should know about a problem that can be simulated: found before the first step, told and written down."""

from __future__ import annotations

from hofsi.build import Problem
from hofsi.case import Steady
from hofsi.notes.changes import fast_changes
from hofsi.notes.locking import locking

__all__ = ["notes"]


def notes(problem: Problem) -> tuple[str, ...]:
    """Say what is decided for the user, and what the numbers will suffer from.

    That the pressure of an enclosed fluid is the one with the mean 0; conditions that contradict where edges meet; an
    initial velocity that the conditions or continuity contradict; solids whose elements lock; expressions that change
    faster than the time steps.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    tuple of str
        One sentence or two each.

    Raises
    ------
    CaseError
        If the velocities around an enclosed fluid at rest do not balance.
    """
    case = problem.case
    found: list[str] = []
    if problem.fluid is not None:
        from hofsi.notes.conditions import contradictions
        from hofsi.notes.enclosure import enclosure
        from hofsi.notes.start import start

        first = 0.0 if isinstance(case.time, Steady) else case.time.step(1)[0]
        found += enclosure(problem, problem.fluid, first)
        found += contradictions(problem.fluid, first)
        if not isinstance(case.time, Steady):
            found += start(problem.fluid, case.time.start)
    found += locking(case)
    if not isinstance(case.time, Steady):
        found += fast_changes(case, case.time)
    return tuple(found)
