"""Clustering like the points of Chebyshev."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.grading.ends import Ends, check_ends, opposite

Array = NDArray[np.float64]

__all__ = ["Cosine"]


@dataclass(frozen=True)
class Cosine:
    """Corners at Chebyshev–Lobatto points: sizes fall linearly towards the ends, without a parameter.

    ``"both"``: (1 - cos(π s))/2; ``"first"``: 1 - cos(π s/2), small elements at the first vertex; ``"second"``:
    sin(π s/2).

    Attributes
    ----------
    ends : {"both", "first", "second"}
        Where the elements are small.
    """

    ends: Ends = "both"

    def __post_init__(self) -> None:
        check_ends(self.ends, "cosine grading")

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        s = np.asarray(s, dtype=float)
        if self.ends == "both":
            return np.asarray(np.sin(np.pi / 2.0 * s) ** 2)
        if self.ends == "first":
            return np.asarray(2.0 * np.sin(np.pi / 4.0 * s) ** 2)
        return np.asarray(np.sin(np.pi / 2.0 * s))

    def reversed(self) -> Cosine:
        """Return the grading walked from the other end."""
        return Cosine(opposite(self.ends))
