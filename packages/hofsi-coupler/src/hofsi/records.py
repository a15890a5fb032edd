"""Plain records of what a computation did; written by the numerics, read by observers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from hofsi.motion import MeshState
    from hofsi.solvers.fluid import FluidState
    from hofsi.solvers.solid import SolidState

__all__ = ["Clock", "Counts", "CouplingRecord", "State", "StepRecord"]


@dataclass
class Counts:
    """How often a solver did its expensive things.

    Attributes
    ----------
    geometries : int
        Geometry factors of a whole mesh.
    constant_assemblies : int
        Element matrices without the terms that change from iteration to iteration.
    assemblies : int
        Element matrices that are factorised.
    factorisations, solves : int
    iterations : int
        Nonlinear iterations.
    """

    geometries: int = 0
    constant_assemblies: int = 0
    assemblies: int = 0
    factorisations: int = 0
    solves: int = 0
    iterations: int = 0


class Clock:
    """Seconds spent in named phases.

    Phases may nest; the time of an inner phase does not count for the outer one.

    Attributes
    ----------
    seconds : dict of str to float
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._running: list[str] = []
        self._since = 0.0

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count the time of the block for a phase."""
        self._switch()
        self._running.append(name)
        try:
            yield
        finally:
            self._switch()
            self._running.pop()

    def _switch(self) -> None:
        now = perf_counter()
        if self._running:
            name = self._running[-1]
            self.seconds[name] = self.seconds.get(name, 0.0) + now - self._since
        self._since = now


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
