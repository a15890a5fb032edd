"""What passes the interface in a step, as the fluid has it and as the solids have it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hofsi.coupling.interface import Interface
from hofsi.coupling.load import InterfaceLoad
from hofsi.records import CouplingRecord, State
from hofsi.solvers.fluid import FluidSolver
from hofsi.solvers.fluid_flow import BoundaryFlow
from hofsi.solvers.fluid_forces import interface_sides

Array = NDArray[np.float64]

__all__ = ["InterfaceBalance"]


class InterfaceBalance:
    """Work on both sides of an interface, and the mass that flows through it.

    Parameters
    ----------
    solver : FluidSolver
    interface : Interface
    load : InterfaceLoad
    """

    def __init__(self, solver: FluidSolver, interface: Interface, load: InterfaceLoad) -> None:
        self._density, self._interface, self._load = solver.fluid.density, interface, load
        self._flow = BoundaryFlow(solver, sides=interface_sides(solver))

    def completed(self, record: CouplingRecord, before: State, after: State, dt: float) -> CouplingRecord:
        """The record of a step with what passed the interface in it.

        Parameters
        ----------
        record : CouplingRecord
        before, after : State
            Of a coupled problem, at the start and the end of the step.
        dt : float
        """
        assert before.fluid is not None
        assert after.fluid is not None
        nodes = self._interface.fluid
        first, last = (self._load.evaluate(state) for state in (before.fluid, after.fluid))
        power = [
            float((f * u[nodes]).sum())
            for f, u in zip((first, last), (before.fluid.velocity, after.fluid.velocity), strict=True)
        ]
        moved = after.interface[0] - before.interface[0]
        return replace(
            record,
            work_fluid=0.5 * dt * (power[0] + power[1]),
            work_solid=0.5 * float(((first + last) * moved).sum()),
            mass_flux=self._density * self._flow.rate(after.fluid, relative=True),
        )
