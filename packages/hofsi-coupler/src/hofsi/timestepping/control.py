"""Which step comes next: steps are halved when one fails or is not accurate enough, and doubled again."""

from __future__ import annotations

import math

from hofsi.case import Unsteady

__all__ = ["StepControl"]

_GROWTH = 8.0  # what doubling a step does to its local error, at most: that of BDF2 is of third order
_MARGIN = 0.8  # of the tolerance, that a doubled step is expected to keep


class StepControl:
    """Divides the steps of a case by powers of two.

    All steps have the size of the case's divided by 2^k, and a step is doubled only where the larger one would start
    anyway. So the ends of the case's steps are always met, times carry no rounding errors, and what belongs to a step
    size is needed again soon. Two neighbouring steps differ by a factor of two at most where they grow, which BDF2
    allows (its limit is 1 + √2).

    After a step that failed the size is doubled when one smaller step has succeeded; when that fails again, after twice
    as many, and so on. With a tolerance it is doubled when the local error is then expected to keep it.

    Parameters
    ----------
    time : Unsteady

    Attributes
    ----------
    finished : bool
    """

    def __init__(self, time: Unsteady) -> None:
        self._case = time
        self._level = 0 if time.first is None else max(0, math.ceil(math.log2(time.dt / time.first) - 1e-9))
        self._units = 1 << time.halvings  # parts of a whole step that times are counted in
        self._whole, self._parts = 1, 0  # the whole step at hand, and how much of it is behind
        self._patience, self._calm = 1, 0  # smaller steps after a failure, and how many are still to be made
        self._tried = False  # whether the step at hand was just doubled
        self.finished = False

    @property
    def _stride(self) -> int:
        return self._units >> self._level

    @property
    def time(self) -> float:
        """End of the step."""
        end, whole = self._case.step(self._whole)
        return end - whole * (1.0 - (self._parts + self._stride) / self._units)

    @property
    def size(self) -> float:
        """Size of the step."""
        return self._case.step(self._whole)[1] * self._stride / self._units

    @property
    def done(self) -> float:
        """Whole steps behind at the end of the step: an integer, or one and a part."""
        return self._whole - 1 + (self._parts + self._stride) / self._units

    def halve(self, *, failed: bool) -> bool:
        """Halve the step at hand; False if it cannot be halved any more.

        Parameters
        ----------
        failed : bool
            Whether it did not succeed at all; otherwise it was not accurate enough.
        """
        if self._stride == 1:
            return False
        self._level += 1
        if failed:
            self._patience = 2 * self._patience if self._tried else 1
            self._calm = self._patience
        self._tried = False
        return True

    def suffices(self, error: float | None) -> bool:
        """Whether a step with a local error, None if there is no estimate, keeps the tolerance, if there is one."""
        return error is None or self._case.tolerance is None or error <= self._case.tolerance

    def advance(self, error: float | None) -> None:
        """Go on to the next step.

        Parameters
        ----------
        error : float or None
            Local error of the step that was made; None if there is no estimate.
        """
        self._parts += self._stride
        self._calm = max(0, self._calm - 1)
        if self._parts == self._units:
            self._whole, self._parts = self._whole + 1, 0
            self.finished = self._whole > self._case.steps
        self._tried = self._may_grow(error)
        self._level -= self._tried

    def _may_grow(self, error: float | None) -> bool:
        if not self._level or self._calm or self._parts % (2 * self._stride):
            return False
        tolerance = self._case.tolerance
        return tolerance is None or (error is not None and _GROWTH * error <= _MARGIN * tolerance)
