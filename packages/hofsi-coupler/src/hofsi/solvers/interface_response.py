"""How a linear step of the fluid answers to other velocities of its interface, without a look at the rest of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.condensed_factor import CondensedFactor

Array = NDArray[np.float64]

__all__ = ["InterfaceResponse"]


class InterfaceResponse:
    """A linear step is affine in the velocity of the interface: u = u₀ + E γ, reaction h = h₀ + S γ.

    S is the Schur complement of the interface's velocities, a byproduct of the factorisation, and E a substitution
    backwards.

    Parameters
    ----------
    factor : CondensedFactor
        Of the step's matrix, with the interface's velocities as its border.
    matrix : ndarray, shape (2k, 2k)
        S.
    velocity : ndarray, shape (k, 2)
        Of the interface in a solution.
    reaction : ndarray, shape (k, 2)
        What acts on the fluid at the nodes of the interface there.
    """

    def __init__(self, factor: CondensedFactor, matrix: Array, velocity: Array, reaction: Array) -> None:
        self._factor, self.matrix, self._velocity, self._reaction = factor, matrix, velocity.copy(), reaction

    def reaction(self, velocity: Array) -> Array:
        """Reaction (k, 2) to another velocity (k, 2)."""
        change = self.matrix @ (velocity - self._velocity).ravel()
        return np.asarray(self._reaction + change.reshape(-1, 2))

    def change(self, velocity: Array) -> Array:
        """What another velocity (k, 2) changes of all unknowns, those of the interface included, shape (size,)."""
        return self._factor.extended((velocity - self._velocity).ravel())
