"""Steps that were divided: why, how often, and how small they became."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any

from hofsi.case import Unsteady
from hofsi.records import StepRecord

__all__ = ["DivisionWatch"]

_TOLD = 3  # failures that are told one by one


class DivisionWatch:
    """Tells the user of steps that failed and were divided, and keeps count.

    Parameters
    ----------
    time : Unsteady
    tell : callable
        Takes a note.
    """

    def __init__(self, time: Unsteady, tell: Callable[[str], None]) -> None:
        self._time, self._tell = time, tell
        self._kinds: Counter[str] = Counter()
        self._smallest, self._largest = math.inf, 0.0
        self._failures = self._inaccurate = 0

    def observe(self, record: StepRecord) -> None:
        """Note what was rejected before a step, and whether the step itself is accurate enough."""
        for rejection in record.rejected:
            self._kinds[rejection.error] += 1
            if rejection.error == "LocalError":
                continue
            self._failures += 1
            if self._failures <= _TOLD:
                last = " Further failures are counted in steps.csv" if self._failures == _TOLD else ""
                self._tell(f"{rejection.reason} The step of {rejection.dt:.6g} was divided.{last}".rstrip("."))
        self._smallest, self._largest = min(self._smallest, record.dt), max(self._largest, record.dt)
        tolerance = self._time.tolerance
        if tolerance is not None and record.local_error is not None and record.local_error > tolerance:
            self._inaccurate += 1
            if self._inaccurate == 1:
                self._tell(
                    f"t = {record.time:g}: the local error is {record.local_error:.2g}, more than time.tolerance = "
                    f"{tolerance:g}, in a step of {record.dt:.6g}, the smallest allowed. Raise time.halvings, or lower "
                    "time.dt"
                )

    def close(self) -> None:
        """Nothing to do."""

    def memory(self) -> dict[str, Any]:
        """What was counted."""
        return {
            "kinds": dict(self._kinds),
            "smallest": self._smallest,
            "largest": self._largest,
            "failures": self._failures,
            "inaccurate": self._inaccurate,
        }

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Go on counting."""
        self._kinds = Counter(memory["kinds"])
        self._smallest, self._largest = memory["smallest"], memory["largest"]
        self._failures, self._inaccurate = memory["failures"], memory["inaccurate"]

    def summary(self) -> dict[str, object]:
        """Smallest and largest step, rejected attempts by kind, and steps that were too inaccurate all the same."""
        if not self._largest:
            return {}
        return {
            "dt_min": self._smallest,
            "dt_max": self._largest,
            "rejected": dict(self._kinds),
            "inaccurate": self._inaccurate,
        }
