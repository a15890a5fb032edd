"""Plain records of a run: written by the numerics, read by observers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from hofsi.motion import MeshState
    from hofsi.solvers.fluid_state import FluidState
    from hofsi.solvers.solid_state import SolidState
    from hofsi.timestepping.control import ControlMemory
    from hofsi.timestepping.local_error import ErrorMemory

__all__ = ["CouplingRecord", "MarchMemory", "Rejection", "RunMemory", "State", "StepRecord"]


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
    """How a coupled step converged, and what passed its interface.

    Attributes
    ----------
    iterations : int
    displacement, force : float
        Last residuals, relative to the step's increments.
    work_fluid, work_solid : float or None
        Work of the fluid on the solids in the step, by the trapezoidal rule in the nodal forces: with the velocity of
        the fluid at the interface, and with the displacement of the solids. They differ by what the time schemes leave.
        None without a step.
    mass_flux : float or None
        ∫ ρ (u - w)·n over the interface at the end of the step: what flows through it, because the fluid's mesh stands
        where the interface was expected (geometry = "extrapolated"); rounding if it stands where the interface is.
    """

    iterations: int
    displacement: float
    force: float
    work_fluid: float | None = None
    work_solid: float | None = None
    mass_flux: float | None = None


@dataclass(frozen=True)
class Rejection:
    """An attempt at a step that was given up.

    Attributes
    ----------
    dt : float
        Its size.
    error : str
        The kind of error, ``"NewtonError"`` for example; ``"LocalError"`` for a step that was not accurate enough.
    reason : str
        What happened.
    """

    dt: float
    error: str
    reason: str


class MarchMemory(Protocol):
    """What solvers know besides the state: a frozen dataclass of arrays, numbers and others like it."""

    def without_factors(self) -> MarchMemory:
        """Return the same without what matrices were made from, for a case with other matrices."""
        ...


@dataclass(frozen=True, eq=False)
class RunMemory:
    """What a run knows after a step besides the state: the next step depends on it.

    Attributes
    ----------
    sizes : tuple of float
        Of the last steps, newest first.
    control : ControlMemory
        Which step comes next.
    errors : ErrorMemory or None
        What local errors are estimated from; None if they are not.
    march : MarchMemory
        What `hofsi.marching.March.memory` returned.
    """

    sizes: tuple[float, ...]
    control: ControlMemory
    errors: ErrorMemory | None
    march: MarchMemory


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
    done : float
        Steps of the scene's ``dt`` that are behind: a whole number, unless a step was divided and more of it follows.
    local_error : float or None
        Estimate for this step, see `hofsi.timestepping.local_error`; None if there is none.
    rejected : tuple of Rejection
        Larger steps that were tried before this one, in that order.
    memory : RunMemory or None
        What `hofsi.simulate.simulate` needs to go on after this step; None for a steady state.
    """

    step: int
    time: float
    dt: float
    state: State
    coupling: CouplingRecord | None = None
    min_det_J: float | None = None
    done: float = 0.0
    local_error: float | None = None
    rejected: tuple[Rejection, ...] = ()
    memory: RunMemory | None = field(default=None, repr=False, compare=False)
