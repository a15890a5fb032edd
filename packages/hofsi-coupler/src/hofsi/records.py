"""Plain records of a run: written by the numerics, read by observers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from hofsi.motion import MeshState
    from hofsi.solvers.fluid_state import FluidState
    from hofsi.solvers.solid import SolidState

__all__ = ["CouplingRecord", "State", "StepRecord"]


@dataclass(frozen=True)
class State:
    """Everything a step starts from and ends with.

    Attributes
    ----------
    fluid, solid : FluidState, SolidState or None
        None if the scene has no such field.
    mesh : MeshState or None
        Position of the fluid mesh; None without a fluid.
    interface : tuple of ndarray, shape (k, 2)
        Displacements of the wet interface, newest first.
    """

    fluid: FluidState | None = None
    solid: SolidState | None = None
    mesh: MeshState | None = None
    interface: tuple[NDArray[np.float64], ...] = field(default=())


@dataclass(frozen=True)
class CouplingRecord:
    """How a coupled step converged: iterations and the last residuals, relative to the step's increments."""

    iterations: int
    displacement: float
    force: float


@dataclass(frozen=True)
class StepRecord:
    """One finished step.

    Attributes
    ----------
    step : int
        From 1.
    time, dt : float
        End and size of the step; dt is 0 for a steady state.
    state : State
    coupling : CouplingRecord or None
        None without coupling.
    min_det_J : float or None
        Certified lower bound of det J of the fluid mesh; None without a fluid.
    """

    step: int
    time: float
    dt: float
    state: State
    coupling: CouplingRecord | None = None
    min_det_J: float | None = None
