"""When a coupled step has converged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["ConvergenceTest", "Residuals"]

_FLOOR = 1e-4  # of the largest value so far: increments below it count as this large


@dataclass(frozen=True)
class Residuals:
    """Displacement and force residual of one iteration, relative to the step's increments."""

    displacement: float
    force: float

    @property
    def largest(self) -> float:
        """The larger of the two."""
        return max(self.displacement, self.force)


class ConvergenceTest:
    """Both residuals relative to what changes in the step.

    The displacement residual is ‖d̃ - d‖/‖d̃ - d_n‖, the force residual ‖f - f_last‖/‖f - f_n‖ between iterations.
    Where a step changes next to nothing, the increments are replaced by 1e-4 of the largest value of the run.
    """

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self._largest_d = self._largest_f = 0.0
        self._d_n: Array | float = 0.0
        self._f_n: Array | float = 0.0
        self._last: Array | None = None

    def begin_step(self, displacement: Array | float, force: Array | float) -> None:
        """Set the values at the beginning of the step."""
        self._d_n, self._f_n, self._last = displacement, force, None

    def residuals(self, image: Array, residual: Array, force: Array) -> Residuals:
        """Residuals of an iteration with the image d̃, the residual d̃ - d and the interface force."""
        norm = np.linalg.norm
        self._largest_d = max(self._largest_d, float(norm(image)))
        self._largest_f = max(self._largest_f, float(norm(force)))
        moved = max(float(norm(image - self._d_n)), _FLOOR * self._largest_d)
        loaded = max(float(norm(force - self._f_n)), _FLOOR * self._largest_f)
        change = np.inf if self._last is None else float(norm(force - self._last))
        self._last = force.copy()
        d = float(norm(residual)) / moved if moved > 0.0 else 0.0
        if loaded == 0.0:
            return Residuals(d, 0.0 if d == 0.0 else np.inf)
        return Residuals(d, change / loaded)
