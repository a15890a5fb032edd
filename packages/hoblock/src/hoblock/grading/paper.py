"""The gradings of the paper: uniform, quadratic, cubic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError

Array = NDArray[np.float64]

__all__ = ["Cubic", "Quadratic", "Uniform"]


@dataclass(frozen=True)
class Uniform:
    """Elements of equal parameter length."""

    def __call__(self, s: Array) -> Array:
        """Return ``s``."""
        return np.asarray(s, dtype=float)

    def reversed(self) -> Uniform:
        """Return itself."""
        return self

    def restricted(self, start: float, stop: float) -> Uniform:
        """Return itself."""
        return self


@dataclass(frozen=True)
class Quadratic:
    """The paper's quadratic grading (Fig. 3a): r + m (r² - 1)/2 on [-1, 1], m in (-1, 1).

    Positive m makes the elements near the *first* vertex small.
    """

    m: float

    def __post_init__(self) -> None:
        if not -1.0 < self.m < 1.0:
            raise GradingError(f"quadratic grading: m is {self.m:g}; expected a number in (-1, 1).")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        r = 2.0 * np.asarray(s, dtype=float) - 1.0
        return np.asarray((r + self.m * (r * r - 1.0) / 2.0 + 1.0) / 2.0)

    def reversed(self) -> Quadratic:
        """Return the grading walked from the other end."""
        return Quadratic(-self.m)


@dataclass(frozen=True)
class Cubic:
    """The paper's cubic grading (Fig. 3b): (1 + m/2) r - (m/2) r³ on [-1, 1], m in [0, 1).

    Makes the elements at both ends small.
    """

    m: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.m < 1.0:
            raise GradingError(f"cubic grading: m is {self.m:g}; expected a number in [0, 1).")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        r = 2.0 * np.asarray(s, dtype=float) - 1.0
        return np.asarray(((1.0 + self.m / 2.0) * r - self.m / 2.0 * r**3 + 1.0) / 2.0)

    def reversed(self) -> Cubic:
        """Return itself: it is symmetric."""
        return self
