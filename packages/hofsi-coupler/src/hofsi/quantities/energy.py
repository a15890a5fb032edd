"""The energy of fluid and solids, and what changes it."""

from __future__ import annotations

from dataclasses import dataclass

from hofsi.build import Problem
from hofsi.quantities.body import fluid_state, solid_state
from hofsi.records import StepRecord
from hofsi.solvers import fluid_integrals, solid_integrals
from hofsi.solvers.fluid_power import FluidPower

__all__ = ["Energies", "EnergyBudget"]


@dataclass(frozen=True)
class Energies:
    """Energy and powers at the end of a step, of fluid and solids together, per unit depth.

    Attributes
    ----------
    kinetic, strain : float
    dissipation : float
        By viscosity.
    power : float
        Of everything outside: walls, given velocities and tractions, supports, body forces and pressures, and kinetic
        energy that comes in with the fluid, less what leaves with it.
    """

    kinetic: float
    strain: float
    dissipation: float
    power: float

    @property
    def energy(self) -> float:
        """Kinetic and strain energy."""
        return self.kinetic + self.strain


class EnergyBudget:
    """Follows the energy of a problem from step to step.

    What is left of the change of energy, less power minus dissipation by the trapezoidal rule, is what the numerics
    make or take: damping by the time scheme, stabilisation, the work of the interface that fluid and solids do not
    agree on, all of second order in the step size, and ∫ ρ |u|²/2 ∇·u, which falls with the elements' size.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem) -> None:
        self._fluid = None if problem.fluid is None else problem.fluid.solver
        self._solid = None if problem.solid is None else problem.solid.solver
        self._power = None if self._fluid is None else FluidPower(self._fluid)
        self._before: Energies | None = None

    def evaluate(self, record: StepRecord) -> Energies:
        """Energy and powers after a step."""
        kinetic = strain = dissipation = power = 0.0
        if self._fluid is not None and self._power is not None:
            state = fluid_state(record)
            kinetic += fluid_integrals.kinetic_energy(self._fluid, state)
            dissipation += fluid_integrals.dissipation(self._fluid, state)
            power += self._power.external(state) - self._power.convected(state)
        if self._solid is not None:
            solid = solid_state(record)
            kinetic += solid_integrals.kinetic_energy(self._solid, solid)
            strain += solid_integrals.strain_energy(self._solid, solid)
            power += solid_integrals.external_power(self._solid, solid)
        return Energies(kinetic, strain, dissipation, power)

    def follow(self, record: StepRecord) -> tuple[float | None, ...]:
        """Kinetic and strain energy, dissipation and power after a step, and what is left of the energy's change in it.

        That is None in the first step that is followed.
        """
        before, now = self._before, self.evaluate(record)
        self._before = now
        left = None
        if before is not None:
            given = 0.5 * sum(part.power - part.dissipation for part in (before, now))
            left = now.energy - before.energy - record.dt * given
        return now.kinetic, now.strain, now.dissipation, now.power, left
