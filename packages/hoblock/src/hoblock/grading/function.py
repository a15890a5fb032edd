"""Gradings given by a function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError

Array = NDArray[np.float64]

__all__ = ["Function"]

_SAMPLES = np.linspace(0.0, 1.0, 257)


@dataclass(frozen=True)
class Function:
    """Any strictly increasing function of s in [0, 1]; its values are scaled to begin at 0 and to end at 1.

    Two of these are equal if their functions are, which for Python functions means the same object: use one function
    for all edges that shall be alike.

    Attributes
    ----------
    function : callable
        From an array of parameters to an array of the same shape.
    """

    function: Callable[[Array], Array]

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise GradingError(f"function grading: got {self.function!r}; expected a function of s in [0, 1].")
        values = self._values(_SAMPLES)
        if not np.all(np.isfinite(values)):
            k = int(np.argmin(np.isfinite(values)))
            raise GradingError(f"function grading: the value is {values[k]} at s = {_SAMPLES[k]:g}; must be finite.")
        if not np.all(np.diff(values) > 0.0):
            k = int(np.argmin(np.diff(values) > 0.0))
            raise GradingError(
                f"function grading: the value is {values[k]:.6g} at s = {_SAMPLES[k]:.4g}, but {values[k + 1]:.6g} at "
                f"s = {_SAMPLES[k + 1]:.4g}; must increase strictly."
            )

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        s = np.asarray(s, dtype=float)
        first, last = self._values(np.array([0.0, 1.0]))
        return np.asarray((self._values(s) - first) / (last - first))

    def _values(self, s: Array) -> Array:
        try:
            values = np.asarray(self.function(s), dtype=float)
        except (TypeError, ValueError) as error:
            raise GradingError(
                f"function grading: {self.function!r} fails on an array of parameters: {error}. Use NumPy's functions, "
                "or np.vectorize(function)."
            ) from error
        if values.shape != s.shape:
            raise GradingError(
                f"function grading: {self.function!r} returned shape {values.shape} for parameters of shape {s.shape}; "
                "expected the same shape."
            )
        return values
