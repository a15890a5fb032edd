"""What an observer is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from hofsi.records import StepRecord

__all__ = ["Observer"]


class Observer(Protocol):
    """Looks at finished steps; it never steers."""

    def observe(self, record: StepRecord) -> None:
        """Look at a step."""
        ...

    def close(self) -> None:
        """Finish: after the last step, also of a run that failed."""
        ...

    def memory(self) -> Mapping[str, Any]:
        """What it knows after a step: plain values and arrays. All it has written is on the disk by then."""
        ...

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Take back what it knew after a step, in a run that goes on after it."""
        ...
