"""What a case comes to: questions that several parts of a plan ask."""

from __future__ import annotations

from hofsi.case import Case, Convection, Fluid, Steady, Unsteady

__all__ = ["convection_of_steps", "counted", "has_series", "is_coupled", "iterates", "moves"]


def is_coupled(case: Case) -> bool:
    """Whether there are a fluid and a solid."""
    return case.fluid is not None and bool(case.solids)


def moves(case: Case) -> bool:
    """Whether the fluid's mesh moves."""
    return case.fluid is not None and bool(case.solids or case.motions)


def convection_of_steps(case: Case, fluid: Fluid) -> Convection:
    """How time steps treat convection."""
    return fluid.convection_of_steps(case.coupling if case.solids else None)


def iterates(case: Case, fluid: Fluid) -> bool:
    """Whether the fluid's equations are nonlinear."""
    if fluid.model == "stokes":
        return False
    return isinstance(case.time, Steady) or convection_of_steps(case, fluid) in ("newton", "picard")


def has_series(case: Case) -> bool:
    """Whether there are quantities over time."""
    return bool(case.quantities) and isinstance(case.time, Unsteady)


def counted(count: int, noun: str) -> str:
    """A number and its noun: 1 step, 2 steps."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
