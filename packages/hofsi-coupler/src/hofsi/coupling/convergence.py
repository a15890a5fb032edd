"""When a coupled step has converged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["ConvergenceTest", "Residuals"]

_FLOOR = 1e-4  # of the largest value so far: increments below it count as this large
_SAFETY = 4.0  # the Wall–Ramm plate: forces changed by up to 3.4 times what the largest ratio made expect


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

    The displacement residual is ‖d̃ - d‖/‖d̃ - d_n‖. The force residual is ‖f⁺ - f‖/‖f - f_n‖: how much the force would
    change in another iteration. To measure f⁺ would take that iteration, and by then displacement and force are far
    better than asked for. It is estimated instead: what the residual d̃ - d of an iteration makes of the force in the
    next one is known from the iterations before; the largest ratio in the step, times a factor of safety, times the
    residual at hand is the estimate. If the last change that was measured is smaller, that counts.

    Where a step changes next to nothing, the increments are replaced by 1e-4 of the largest value of the run.

    Parameters
    ----------
    tolerance : float
        Of the displacement.
    force_tolerance : float
    """

    def __init__(self, tolerance: float, force_tolerance: float) -> None:
        self.tolerance, self.force_tolerance = tolerance, force_tolerance
        self._largest_d = self._largest_f = 0.0
        self._d_n: Array | float = 0.0
        self._f_n: Array | float = 0.0
        self._last: tuple[Array, float] | None = None
        self._ratio = 0.0

    @property
    def largest(self) -> tuple[float, float]:
        """Norms of the largest displacement and force of the run so far."""
        return self._largest_d, self._largest_f

    def recall(self, largest: tuple[float, float]) -> None:
        """Take back what ``largest`` was."""
        self._largest_d, self._largest_f = largest

    def begin_step(self, displacement: Array | float, force: Array | float) -> None:
        """Set the values at the beginning of the step."""
        self._d_n, self._f_n, self._last, self._ratio = displacement, force, None, 0.0

    def excess(self, residuals: Residuals) -> float:
        """The larger of the two as a multiple of its tolerance; at most 1 when both are met."""
        return max(residuals.displacement / self.tolerance, residuals.force / self.force_tolerance)

    def residuals(self, image: Array, residual: Array, force: Array) -> Residuals:
        """Residuals of an iteration with the image d̃, the residual d̃ - d and the interface force."""
        norm = np.linalg.norm
        self._largest_d = max(self._largest_d, float(norm(image)))
        self._largest_f = max(self._largest_f, float(norm(force)))
        moved = max(float(norm(image - self._d_n)), _FLOOR * self._largest_d)
        loaded = max(float(norm(force - self._f_n)), _FLOOR * self._largest_f)
        off = float(norm(residual))
        d = off / moved if moved > 0.0 else 0.0
        change = self._change(force, off)
        self._last = force.copy(), off
        if loaded == 0.0:
            return Residuals(d, 0.0 if d == 0.0 else np.inf)
        return Residuals(d, change / loaded)

    def confirms(self, force: Array, exact: Array) -> bool:
        """Whether a force that the displacement was computed from is that of the fields, within the tolerance."""
        loaded = max(float(np.linalg.norm(exact - self._f_n)), _FLOOR * self._largest_f)
        return bool(np.linalg.norm(exact - force) <= min(self.tolerance, self.force_tolerance) * loaded)

    def _change(self, force: Array, off: float) -> float:
        """How much the force will change in the next iteration after one with a residual of norm ``off``."""
        if self._last is None:
            return np.inf
        before, caused_by = self._last
        change = float(np.linalg.norm(force - before))
        if caused_by > 0.0:
            self._ratio = max(self._ratio, change / caused_by)
            return min(change, _SAFETY * self._ratio * off)
        return change
