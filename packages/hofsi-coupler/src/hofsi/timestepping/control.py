"""Which step comes next: steps are halved when one fails or is not accurate enough, and doubled again."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from hofsi.case import Unsteady

__all__ = ["ControlMemory", "StepControl"]

_GROWTH = 8.0  # what doubling a step does to its local error, at most: that of BDF2 is of third order
_WHOLE = 1e-6  # of a step: what is left of the time may be that much more than whole steps
_MARGIN = 0.8  # of the tolerance, that a doubled step is expected to keep


@dataclass(frozen=True)
class ControlMemory:
    """Where a control of step sizes is.

    Attributes
    ----------
    time : Unsteady
        The steps that it divides.
    whole, parts : int
        The whole step at hand, and how much of it is behind, in parts of ``dt / 2**halvings``.
    level : int
        How often the step is halved.
    patience, calm : int
        Smaller steps after a failure, and how many are still to be made.
    tried : bool
        Whether the step at hand was just doubled.
    before : int
        Whole steps of the run that are not among those of ``time``: it was resumed with others.
    """

    time: Unsteady
    whole: int
    parts: int
    level: int
    patience: int
    calm: int
    tried: bool
    before: int


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
        self._before = 0  # whole steps made before those of the case, of a run that was resumed with others
        self.finished = False

    def memory(self) -> ControlMemory:
        """Where it is."""
        return ControlMemory(
            self._case, self._whole, self._parts, self._level, self._patience, self._calm, self._tried, self._before
        )

    @staticmethod
    def resumed(time: Unsteady, memory: ControlMemory, now: float, last: float) -> StepControl:
        """Return a control that goes on from a time, as it would have or with other steps.

        Parameters
        ----------
        time : Unsteady
            Steps of the whole run, as they are asked for now.
        memory : ControlMemory
        now : float
            End of the last step.
        last : float
            Its size.

        Notes
        -----
        If ``dt`` or ``halvings`` is another one, or the last step was cut short by an end that is further away now,
        steps of ``dt`` are counted from ``now``. With a tolerance the first of them is not larger than the last one
        was.
        """
        steps = _continued(time, memory)
        if steps is None:
            control = StepControl(_counted_from(now, time))
            control._before = memory.before + memory.whole - (0 if memory.parts else 1)
            if time.tolerance is not None:
                control._level = min(time.halvings, max(0, math.ceil(math.log2(time.dt / last) - 1e-9)))
        else:
            control = StepControl(steps)
            control._whole, control._parts, control._level = memory.whole, memory.parts, memory.level
            control._patience, control._calm, control._tried = memory.patience, memory.calm, memory.tried
            control._before = memory.before
        control.finished = control._whole > control._case.steps
        return control

    @property
    def total(self) -> int:
        """Whole steps of the run, those behind included."""
        return self._before + self._case.steps

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
        return self._before + self._whole - 1 + (self._parts + self._stride) / self._units

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


def _continued(time: Unsteady, memory: ControlMemory) -> Unsteady | None:
    """The steps asked for, counted as those of a memory; None if they do not meet."""
    kept, number = memory.time, memory.whole
    if (time.dt, time.halvings) != (kept.dt, kept.halvings):
        return None
    steps = time if kept.start == time.start else _counted_from(kept.start, time)
    if memory.parts:
        return steps if steps.step(number) == kept.step(number) else None
    return steps if steps.step(number - 1)[0] == kept.step(number - 1)[0] else None


def _counted_from(start: float, time: Unsteady) -> Unsteady:
    """The same steps from another start; none if that is the end."""
    steps = (time.end - start) / time.dt
    return replace(time, start=start, steps=max(0, math.ceil(steps - _WHOLE * max(1.0, steps))), first=None)
