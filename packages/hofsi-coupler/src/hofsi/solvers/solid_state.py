"""What is known of solids at the end of a step, and what their solver keeps besides."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hofsi.counts import Counts

Array = NDArray[np.float64]

__all__ = ["SolidMemory", "SolidState"]


def _frozen(array: Array) -> Array:
    view = array.view()
    view.setflags(write=False)
    return view


@dataclass(frozen=True, eq=False)
class SolidState:
    """Solids at the end of a step.

    Attributes
    ----------
    displacements, velocities : tuple of ndarray, shape (n, 2)
        Newest first, at most two; read-only.
    time : float
    reaction : ndarray, shape (n, 2), or None
        Nodal forces of the supports on the solid, zero where nothing holds it; read-only. None in an initial state.
    accelerations : tuple of ndarray, shape (n, 2)
        The newest, if the scheme needs it; for the midpoint rule that of the middle of the last step. Read-only.
    loads : tuple of ndarray, shape (n, 2)
        Nodal forces of the fluid, newest first, at most two; read-only. Empty in an initial state.
    step : float
        Size of the last step, 0 in an initial state.
    """

    displacements: tuple[Array, ...]
    velocities: tuple[Array, ...]
    time: float
    reaction: Array | None = None
    accelerations: tuple[Array, ...] = ()
    loads: tuple[Array, ...] = ()
    step: float = 0.0

    def __post_init__(self) -> None:
        if self.reaction is not None:
            object.__setattr__(self, "reaction", _frozen(self.reaction))
        for name in ("displacements", "velocities", "accelerations", "loads"):
            object.__setattr__(self, name, tuple(_frozen(array) for array in getattr(self, name)))

    @property
    def displacement(self) -> Array:
        """Newest displacement."""
        return self.displacements[0]

    @property
    def velocity(self) -> Array:
        """Newest velocity."""
        return self.velocities[0]


@dataclass(frozen=True, eq=False)
class SolidMemory:
    """What a solver knows besides the state.

    Attributes
    ----------
    counts : Counts
        A copy.
    mass_factor : float or None
        Of the tangent that is kept for later steps; None if there is none.
    fell_back : bool
        Whether its factors are those of the fallback.
    """

    counts: Counts
    mass_factor: float | None = None
    fell_back: bool = False

    def without_factors(self) -> SolidMemory:
        """Return the same without the tangent."""
        return replace(self, mass_factor=None)
