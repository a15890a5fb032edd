"""What a fluid's solver knows besides the state: what its matrices and factors were made from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hofsi.counts import Counts
from hofsi.fem.saddle_point import CycleMemory
from hofsi.solvers.fluid_factors import FactorsMemory
from hofsi.solvers.fluid_system import SystemOrigin

Array = NDArray[np.float64]

__all__ = ["FluidMemory"]


@dataclass(frozen=True, eq=False)
class FluidMemory:
    """What a solver needs, besides a state, to go on as if it had never stopped.

    Factors that outlive their step decide about the rounding of later ones. They are not kept themselves, but what they
    were made from, of which the same bits are made again.

    Attributes
    ----------
    counts : Counts
        A copy.
    enclosed : ndarray, shape (n, 2), or None
        Node positions at which enclosed regions were looked for.
    system : SystemOrigin or None
        Of the linear system at hand.
    geometry : ndarray, shape (n, 2), or None
        Node positions of the geometry factors at hand.
    constant : tuple of ndarray, shape (n, 2), and float, or None
        Node positions and weight of the new velocity of the matrices without convection at hand.
    stokes : bool or None
        Whether the factors of these have fallen back; None if there are none.
    responding : bool
        Whether they were made to tell how the interface responds.
    factors : FactorsMemory or None
        Of the factors that outlive iterations.
    cycle : CycleMemory or None
        Of the preconditioner of an iterative solver.
    """

    counts: Counts
    enclosed: Array | None = None
    system: SystemOrigin | None = None
    geometry: Array | None = None
    constant: tuple[Array, float] | None = None
    stokes: bool | None = None
    responding: bool = False
    factors: FactorsMemory | None = None
    cycle: CycleMemory | None = None

    def without_factors(self) -> FluidMemory:
        """Return the same without what matrices were made from."""
        return replace(self, constant=None, stokes=None, factors=None, cycle=None)
