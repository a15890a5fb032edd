"""Numbers that a benchmark has to find, and what it found."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

__all__ = ["Check", "Finding", "Limit", "judged"]


@dataclass(frozen=True)
class Finding:
    """A number that was found, beside what was expected.

    Attributes
    ----------
    quantity : str
    value : float
        nan if there is none, for example of a run that was too short for a period.
    low, high : float
        Between which it passes.
    reference : float or None
        None where there are limits only.
    uncertainty : float or None
        Of the reference, relative: what its source leaves open.
    source : str
        Of the reference, or the reason of the limits.
    """

    quantity: str
    value: float
    low: float
    high: float
    reference: float | None
    uncertainty: float | None
    source: str

    @property
    def error(self) -> float | None:
        """Relative difference from the reference."""
        return None if self.reference is None else (self.value - self.reference) / abs(self.reference)

    @property
    def passed(self) -> bool:
        """Whether the number is within its limits; one that is missing is not."""
        return self.low <= self.value <= self.high


@dataclass(frozen=True)
class Check:
    """A number with a reference.

    Attributes
    ----------
    quantity : str
    reference : float
        Not 0.
    uncertainty : float
        Relative: what the source of the reference leaves open.
    allowed : float
        The largest relative error that passes.
    source : str
    """

    quantity: str
    reference: float
    uncertainty: float
    allowed: float
    source: str

    def judge(self, value: float | None) -> Finding:
        """Compare a number that was found."""
        width = self.allowed * abs(self.reference)
        low, high = self.reference - width, self.reference + width
        return Finding(self.quantity, _found(value), low, high, self.reference, self.uncertainty, self.source)


@dataclass(frozen=True)
class Limit:
    """A number that has limits.

    Attributes
    ----------
    quantity, reason : str
    at_least, at_most : float
    """

    quantity: str
    reason: str
    at_least: float = -math.inf
    at_most: float = math.inf

    def judge(self, value: float | None) -> Finding:
        """Compare a number that was found."""
        return Finding(self.quantity, _found(value), self.at_least, self.at_most, None, None, self.reason)


def _found(value: float | None) -> float:
    return math.nan if value is None else float(value)


def judged(checks: Sequence[Check | Limit], values: Mapping[str, float | None]) -> tuple[Finding, ...]:
    """What was found of everything that is asked for."""
    return tuple(check.judge(values.get(check.quantity)) for check in checks)
