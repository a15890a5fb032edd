"""What every solver of linear systems offers."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["Solver"]

Array = NDArray[np.float64]


class Solver(Protocol):
    """Whatever solves, exactly or not, A x = b for a matrix that it was made with."""

    def solve(self, b: Array, /) -> Array:
        """Return x, or an approximation to it."""
        ...
