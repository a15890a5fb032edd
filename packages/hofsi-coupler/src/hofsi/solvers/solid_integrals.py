"""Energies of the solids: of their motion and of their strain."""

from __future__ import annotations

from hofsi.solvers.solid import SolidSolver, SolidState

__all__ = ["kinetic_energy", "strain_energy"]


def kinetic_energy(solver: SolidSolver, state: SolidState) -> float:
    """∫ ρ |v|²/2 over the undeformed solids."""
    v = state.velocity
    return 0.5 * float((v * (solver.equations.mass @ v)).sum())


def strain_energy(solver: SolidSolver, state: SolidState) -> float:
    """∫ W over the undeformed solids; zero where they are undeformed."""
    return solver.equations.strain_energy(state.displacement)
