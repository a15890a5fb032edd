"""Integrals over the whole fluid and over all solids."""

from __future__ import annotations

from hofsi import case
from hofsi.build import Problem
from hofsi.quantities.body import fluid_of, fluid_state, solid_of, solid_state
from hofsi.quantities.evaluator import Evaluator
from hofsi.solvers import fluid_integrals, solid_integrals

__all__ = ["integral", "solid_integral"]

_INTEGRALS = {
    "area": fluid_integrals.area,
    "continuity-residual": fluid_integrals.continuity_residual,
    "dissipation": fluid_integrals.dissipation,
    "divergence": fluid_integrals.divergence,
    "enstrophy": fluid_integrals.enstrophy,
    "kinetic-energy": fluid_integrals.kinetic_energy,
}
_SOLID_INTEGRALS = {
    "kinetic-energy": solid_integrals.kinetic_energy,
    "strain-energy": solid_integrals.strain_energy,
}


def integral(problem: Problem, asked: case.FluidIntegral) -> Evaluator:
    """Return an integral over the fluid.

    Raises
    ------
    CaseError
        If there is no fluid.
    """
    solver, evaluate = fluid_of(problem, asked.place).solver, _INTEGRALS[asked.what]
    return lambda record: evaluate(solver, fluid_state(record))


def solid_integral(problem: Problem, asked: case.SolidIntegral) -> Evaluator:
    """Return an integral over all solids.

    Raises
    ------
    CaseError
        If there is none.
    """
    solver, evaluate = solid_of(problem, asked.place).solver, _SOLID_INTEGRALS[asked.what]
    return lambda record: evaluate(solver, solid_state(record))
