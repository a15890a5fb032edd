"""What a coupled problem knows between steps besides the state."""

from __future__ import annotations

from dataclasses import dataclass, replace

from hofsi.solvers.fluid_memory import FluidMemory
from hofsi.solvers.solid_state import SolidMemory

__all__ = ["CoupledMemory"]


@dataclass(frozen=True, eq=False)
class CoupledMemory:
    """What the solvers and their coupling know besides the state.

    Attributes
    ----------
    fluid : FluidMemory
    solid : SolidMemory
    accelerator : object
        What `hofsi.coupling.relaxation.Accelerator.memory` returned.
    largest : (float, float)
        Norms of the largest displacement and force of the run.
    """

    fluid: FluidMemory
    solid: SolidMemory
    accelerator: object
    largest: tuple[float, float]

    def without_factors(self) -> CoupledMemory:
        """Return the same without what matrices were made from."""
        return replace(self, fluid=self.fluid.without_factors(), solid=self.solid.without_factors())
