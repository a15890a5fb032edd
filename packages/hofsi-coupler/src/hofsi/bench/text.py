"""What a benchmark found, as text for people."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from hofsi.bench.benchmark import Benchmark, Measured
from hofsi.bench.checks import Finding

__all__ = ["lines_of", "verdict"]

_COLUMNS = ("quantity", "found", "reference", "error", "allowed", "")


def lines_of(benchmark: Benchmark, measured: Measured) -> Iterator[str]:
    """The findings of a benchmark as a table, and its seconds."""
    yield f"{benchmark.name}: {benchmark.title}"
    yield f"  {measured.size}"
    if measured.failure:
        yield f"  did not come to its end: {measured.failure}"
    rows = [_COLUMNS, *map(_row, measured.findings)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(_COLUMNS))]
    for row in rows:
        yield ("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))).rstrip()
    yield f"  seconds: {_seconds(measured.seconds)}"


def verdict(finding: Finding) -> str:
    """Whether a number is as near, or as small, as it has to be."""
    return "pass" if finding.passed else "FAIL"


def _row(finding: Finding) -> tuple[str, ...]:
    value, reference, error = f"{finding.value:.7g}", finding.reference, finding.error
    if reference is None or error is None:
        return finding.quantity, value, "–", "–", _limits(finding), verdict(finding)
    known = f"{reference:.9g} ± {_percent(finding.uncertainty or 0.0)}"
    allowed = _percent((finding.high - reference) / abs(reference))
    return finding.quantity, value, known, f"{100.0 * error:+.2g} %", allowed, verdict(finding)


def _limits(finding: Finding) -> str:
    if math.isinf(finding.low):
        return f"at most {finding.high:g}"
    return f"at least {finding.low:g}" if math.isinf(finding.high) else f"{finding.low:g} to {finding.high:g}"


def _percent(value: float) -> str:
    return f"{100.0 * value:.2g} %"


def _seconds(seconds: Mapping[str, float]) -> str:
    total = seconds["total"]
    parts = sorted(((name, value) for name, value in seconds.items() if name != "total"), key=lambda item: -item[1])
    named = ", ".join(f"{name} {value:.2f}" for name, value in parts if value >= 0.01 * total)
    return f"{total:.2f}" + (f" ({named})" if named else "")
