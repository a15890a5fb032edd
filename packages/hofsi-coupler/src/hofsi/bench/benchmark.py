"""What a benchmark is: a name, and a way to measure what it has to find."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from hofsi.bench.checks import Finding

__all__ = ["Benchmark", "Measured"]


@dataclass(frozen=True)
class Measured:
    """What a benchmark found and what it took.

    Attributes
    ----------
    findings : sequence of Finding
    size : str
        Of the problem, for people.
    settings : mapping of str to object
        What was run.
    seconds : mapping of str to float
        By phase, with the ``"total"``.
    counts : mapping of str to object
        How often expensive things were done.
    failure : str
        Why it did not come to its end; empty if it did.
    """

    findings: Sequence[Finding]
    size: str
    settings: Mapping[str, Any]
    seconds: Mapping[str, float]
    counts: Mapping[str, Any] = field(default_factory=dict)
    failure: str = ""

    @property
    def passed(self) -> bool:
        """Whether it came to its end and found everything."""
        return not self.failure and all(finding.passed for finding in self.findings)


class Benchmark(Protocol):
    """A case with known results."""

    @property
    def name(self) -> str:
        """What it is called on the command line."""

    @property
    def title(self) -> str:
        """What it is, in a line."""

    def measure(self, folder: Path, *, quick: bool) -> Measured:
        """Run it.

        Parameters
        ----------
        folder : Path
            For files, empty.
        quick : bool
            Whether a smaller problem, held to wider limits, will do.
        """
