"""What is known of a fluid at the end of a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["FluidState"]


@dataclass(frozen=True)
class FluidState:
    """Fluid at the end of a step.

    Attributes
    ----------
    velocities : tuple of ndarray, shape (n, 2)
        Newest first; as many as the time scheme needs.
    pressure : ndarray, shape (m,)
    points : tuple of ndarray, shape (n, 2)
        Node positions at the same times.
    reaction : ndarray, shape (n, 2)
        Nodal momentum residual: what the boundary does to the fluid where it holds it; minus it is the load on a body.
    time : float
    mesh_velocity : ndarray, shape (n, 2), or None
        By the formula of the time scheme; None before the first step.
    """

    velocities: tuple[Array, ...]
    pressure: Array
    points: tuple[Array, ...]
    reaction: Array
    time: float
    mesh_velocity: Array | None = None

    @property
    def velocity(self) -> Array:
        """Newest velocity."""
        return self.velocities[0]
