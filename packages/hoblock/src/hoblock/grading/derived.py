"""Gradings made from gradings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.grading.grading import Grading

Array = NDArray[np.float64]

__all__ = ["Reversed"]


@dataclass(frozen=True)
class Reversed:
    """A grading walked from the other end."""

    grading: Grading

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        return np.asarray(1.0 - self.grading(1.0 - np.asarray(s, dtype=float)))
