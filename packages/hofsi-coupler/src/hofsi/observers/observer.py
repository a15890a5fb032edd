"""What an observer is."""

from __future__ import annotations

from typing import Protocol

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
