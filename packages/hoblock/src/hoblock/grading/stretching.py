"""Gradings that stretch elements towards one end or both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError

Array = NDArray[np.float64]

__all__ = ["Exponential"]


@dataclass(frozen=True)
class Exponential:
    """s ↦ (exp(a s) - 1)/(exp(a) - 1): sizes grow by a constant ratio, dense at the first vertex for a > 0."""

    a: float

    def __post_init__(self) -> None:
        if not abs(self.a) <= 50.0:
            raise GradingError(f"exponential grading: a is {self.a:g}; expected a number in [-50, 50].")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        s = np.asarray(s, dtype=float)
        if abs(self.a) < 1e-8:
            return s + self.a * s * (s - 1.0) / 2.0
        return np.asarray(np.expm1(self.a * s) / np.expm1(self.a))
