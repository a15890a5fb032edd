"""Energies of the solids, of their motion and of their strain, and the power of what acts on them."""

from __future__ import annotations

from hofsi.solvers.solid import SolidSolver, SolidState

__all__ = ["external_power", "kinetic_energy", "strain_energy"]


def kinetic_energy(solver: SolidSolver, state: SolidState) -> float:
    """∫ ρ |v|²/2 over the undeformed solids."""
    v = state.velocity
    return 0.5 * float((v * (solver.equations.mass @ v)).sum())


def strain_energy(solver: SolidSolver, state: SolidState) -> float:
    """∫ W over the undeformed solids; zero where they are undeformed."""
    return solver.equations.strain_energy(state.displacement)


def external_power(solver: SolidSolver, state: SolidState) -> float:
    """Power of body forces, tractions, pressures and moving supports; not that of a fluid."""
    force = solver.equations.loads.dead(state.time).copy()
    for pressure in solver.equations.loads.pressures(state.time):
        pressure.add_force(force, state.displacement)
    if state.reaction is not None:
        force += state.reaction
    return float((force * state.velocity).sum())
