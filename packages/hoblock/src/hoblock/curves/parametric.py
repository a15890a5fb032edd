"""Curves given by a function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Parametric"]


@dataclass(frozen=True)
class Parametric:
    """A curve given by a function of t that returns points of shape (n, 2)."""

    function: Callable[[Array], Array]

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise CurveError(f"parametric curve: got {self.function!r}; expected a function of t, shape (n,).")

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        t = np.asarray(t, dtype=float)
        points = np.asarray(self.function(t), dtype=float)
        if points.shape != (*t.shape, 2):
            raise CurveError(
                f"parametric curve: returned shape {points.shape} for {t.size} parameters; expected {(*t.shape, 2)}, "
                "a point a row. Stack x and y with np.stack([x, y], axis=-1)."
            )
        if not np.all(np.isfinite(points)):
            bad = t[~np.isfinite(points).all(axis=-1)][0]
            raise CurveError(f"parametric curve: not finite at t = {bad:g}.")
        return points
