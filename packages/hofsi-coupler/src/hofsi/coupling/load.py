"""The fluid's load on the solid at the nodes of the interface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.coupling.interface import Interface
from hofsi.fem.sides import boundary_sides
from hofsi.solvers.fluid import FluidSolver, FluidState
from hofsi.solvers.fluid_forces import NeighbourSides, interface_sides

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

__all__ = ["InterfaceLoad"]


class InterfaceLoad:
    """Nodal forces of the fluid on the solid: minus the fluid's momentum residual at the interface.

    Where the interface ends at a boundary whose velocity is given, a wall or an inlet, the residual holds the traction
    of that boundary as well. It does not act on the solid and is taken off.

    Parameters
    ----------
    solver : FluidSolver
    interface : Interface
    held : ndarray of bool, shape (k,)
        Nodes of the interface where the solid cannot move: what acts there has no effect and is not corrected.
    """

    def __init__(self, solver: FluidSolver, interface: Interface, held: Mask) -> None:
        outer = boundary_sides(solver.mesh)
        dry = outer[~np.isin(outer @ [4, 1], interface_sides(solver) @ [4, 1])]
        self._nodes = interface.fluid
        self._neighbours = NeighbourSides(solver, dry.tolist(), interface.fluid[~held])
        self._rows = np.searchsorted(interface.fluid, self._neighbours.nodes)

    @property
    def needs_fields(self) -> bool:
        """Whether the reaction at the interface alone does not tell the forces."""
        return bool(self._neighbours)

    def evaluate(self, state: FluidState) -> Array:
        """Return the nodal forces at a state that the solver has computed, shape (k, 2)."""
        force = -state.reaction[self._nodes]
        if self._neighbours:
            np.add.at(force, self._rows, self._neighbours.forces(state))
        return force
