"""Relaxation of the coupling's fixed-point iteration: constant, and Aitken's dynamic factor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["Accelerator", "Aitken", "AitkenMemory", "ConstantRelaxation"]


class Accelerator(Protocol):
    """Chooses the next interface displacement from the residuals so far."""

    def begin_step(self) -> None:
        """Forget the iterates of the step before."""
        ...

    def next(self, d: Array, residual: Array) -> Array:
        """Return the next iterate after the iterate ``d`` with the residual d̃ - d, both of shape (k,)."""
        ...

    def end_step(self) -> None:
        """Keep what later steps may use of this one, which has converged."""
        ...

    def forget(self) -> None:
        """Start anew: the step did not converge, and what was kept of earlier ones may be why."""
        ...

    def memory(self) -> object:
        """What is kept between steps: a frozen dataclass of arrays and numbers, or None."""
        ...

    def recall(self, memory: object) -> None:
        """Take back what `memory` returned; start anew if it comes from another kind of accelerator."""
        ...


class ConstantRelaxation:
    """d + ω r with a constant ω."""

    def __init__(self, relaxation: float) -> None:
        self._relaxation = relaxation

    def begin_step(self) -> None:
        """Nothing to forget."""

    def next(self, d: Array, residual: Array) -> Array:
        """Return d + ω r."""
        return d + self._relaxation * residual

    def end_step(self) -> None:
        """Nothing to keep."""

    def forget(self) -> None:
        """Nothing to forget."""

    def memory(self) -> None:
        """Nothing is kept."""

    def recall(self, memory: object) -> None:
        """Nothing to take back."""


@dataclass(frozen=True)
class AitkenMemory:
    """The last factor."""

    factor: float


class Aitken:
    """d + ω r with Aitken's ω, started in every step from the last factor, at most the given one.

    References
    ----------
    Küttler & Wall, Comput. Mech. 43 (2008) 61–72, Eq. (44), doi:10.1007/s00466-008-0255-5.
    """

    def __init__(self, relaxation: float) -> None:
        self._first = self._factor = relaxation
        self._last: Array | None = None

    def begin_step(self) -> None:
        """Start from the first factor, with the sign and at most the size of the last one."""
        self._factor = float(np.copysign(min(abs(self._factor), self._first), self._factor)) or self._first
        self._last = None

    def next(self, d: Array, residual: Array) -> Array:
        """Return d + ω r."""
        if self._last is not None:
            change = residual - self._last
            squared = float(change @ change)
            if squared > 0.0:
                self._factor *= -float(self._last @ change) / squared
        self._last = residual.copy()
        return d + self._factor * residual

    def end_step(self) -> None:
        """Nothing to keep but the factor."""

    def forget(self) -> None:
        """Start the next step from the given factor."""
        self._factor, self._last = self._first, None

    def memory(self) -> AitkenMemory:
        """The last factor."""
        return AitkenMemory(self._factor)

    def recall(self, memory: object) -> None:
        """Go on from the last factor."""
        self.forget()
        if isinstance(memory, AitkenMemory):
            self._factor = memory.factor
