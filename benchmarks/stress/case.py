"""What a stress case is, what is expected of it, and how what happened is judged."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import process_time
from typing import TypeAlias

__all__ = ["AS_EXPECTED", "NOT_AS_EXPECTED", "Expectation", "Numbers", "Stops", "StressCase", "Within", "carried_out"]

Numbers: TypeAlias = Mapping[str, float]
"""What a case measured, by name."""

AS_EXPECTED, NOT_AS_EXPECTED = "as expected", "NOT as expected"

_LONGEST = 240  # characters of a message in a row


@dataclass(frozen=True)
class Within:
    """The case ends, and every number that has bounds is there and within them; nan never is.

    Attributes
    ----------
    bounds : mapping of str to float or pair of float
        Largest value, or smallest and largest.
    """

    bounds: Mapping[str, float | tuple[float, float]]

    def holds(self, outcome: Numbers | Exception) -> bool:
        """Whether what happened is this."""
        if isinstance(outcome, Exception):
            return False
        return all(low <= outcome.get(name, float("nan")) <= high for name, (low, high) in self._limits.items())

    @property
    def _limits(self) -> dict[str, tuple[float, float]]:
        pairs = {name: b if isinstance(b, tuple) else (float("-inf"), b) for name, b in self.bounds.items()}
        return {name: (float(low), float(high)) for name, (low, high) in pairs.items()}

    def __str__(self) -> str:
        return "; ".join(_bound(name, *limits) for name, limits in self._limits.items())


@dataclass(frozen=True)
class Stops:
    """The case is given up with the right error.

    Attributes
    ----------
    error : str
        Name of its class or of one above it.
    message : str
        A regular expression that is found in its message.
    """

    error: str
    message: str

    def holds(self, outcome: Numbers | Exception) -> bool:
        """Whether what happened is this."""
        if not isinstance(outcome, Exception):
            return False
        known = self.error in {kind.__name__ for kind in type(outcome).__mro__}
        return known and re.search(self.message, str(outcome)) is not None

    def __str__(self) -> str:
        return f"{self.error} /{self.message}/"


Expectation: TypeAlias = Within | Stops


@dataclass(frozen=True)
class StressCase:
    """One case.

    Attributes
    ----------
    name : str
        Within its group.
    stresses : str
        One sentence.
    expected : tuple of Within or Stops
        Fixed beforehand; one of them must hold.
    measure : callable
        Whether it must be quick → what was measured; it raises what the library raises.
    quick : bool
        Whether it belongs to the quick suite.
    """

    name: str
    stresses: str
    expected: tuple[Expectation, ...]
    measure: Callable[[bool], Numbers]
    quick: bool = False


def carried_out(group: str, case: StressCase, *, quick: bool) -> dict[str, object]:
    """Carry a case out and judge it: a row of the table, whatever happens. Seconds are the processor's."""
    began = process_time()
    outcome: Numbers | Exception
    try:
        outcome = case.measure(quick)
    except Exception as error:  # noqa: BLE001 - whatever a case raises is its result
        outcome = error
    met = any(expectation.holds(outcome) for expectation in case.expected)
    return {
        "group": group,
        "case": case.name,
        "expected": " or ".join("stops" if isinstance(one, Stops) else "ends" for one in case.expected),
        "found": _found(outcome),
        "bound": " or ".join(map(str, case.expected)),
        "verdict": AS_EXPECTED if met else NOT_AS_EXPECTED,
        "seconds": round(process_time() - began, 3),
    }


def _found(outcome: Numbers | Exception) -> str:
    """What happened in one line."""
    if isinstance(outcome, Exception):
        text = " ".join(traceback.format_exception_only(outcome)[-1].split()).rpartition("errors.")[2]
        return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} …"
    return "; ".join(f"{name} {value:.3g}" for name, value in outcome.items())


def _bound(name: str, low: float, high: float) -> str:
    if low == float("-inf"):
        return f"{name} ≤ {high:.3g}"
    return f"{name} ≥ {low:.3g}" if high == float("inf") else f"{low:.3g} ≤ {name} ≤ {high:.3g}"
