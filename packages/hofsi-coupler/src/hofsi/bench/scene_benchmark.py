"""Benchmarks that are scenes: a run of one, and the numbers in its summary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hofsi.bench.benchmark import Measured
from hofsi.bench.checks import Check, Limit, judged
from hofsi.io.scene import load_case
from hofsi.run import run

__all__ = ["SCENES", "Quick", "SceneBenchmark"]

SCENES = Path(__file__).parent / "scenes"
_TABLES_ONLY = ("output.fields=false", "output.plots=false")


@dataclass(frozen=True)
class Quick:
    """The smaller problem of a benchmark.

    Attributes
    ----------
    changes : tuple of str
        To the scene.
    allowed : mapping of str to float
        Relative errors that pass, where they are larger than those of the whole problem.
    """

    changes: tuple[str, ...]
    allowed: Mapping[str, float]


@dataclass(frozen=True)
class SceneBenchmark:
    """A scene whose quantities are known.

    Attributes
    ----------
    name, title : str
    scene : str
        A file in `SCENES`, without its ending.
    checks : tuple of Check or Limit
        Of quantities as ``"u_y amplitude"``, the part one of last, mean, amplitude and frequency, or of
        ``"iterations a step"``.
    changes : tuple of str
        To the scene.
    quick : Quick, optional
        By default the quick problem is the whole one.
    """

    name: str
    title: str
    scene: str
    checks: tuple[Check | Limit, ...]
    changes: tuple[str, ...] = ()
    quick: Quick | None = None

    def measure(self, folder: Path, *, quick: bool) -> Measured:
        """Run the scene; see `hofsi.bench.benchmark.Benchmark`."""
        changes, checks = self.changes, self.checks
        if quick and self.quick is not None:
            changes = (*changes, *self.quick.changes)
            checks = tuple(_relaxed(check, self.quick.allowed) for check in checks)
        case = load_case(SCENES / f"{self.scene}.toml", [*changes, *_TABLES_ONLY])
        result = run(case, folder, changes=changes)
        summary = result.summary
        return Measured(
            judged(checks, values_of(summary)),
            _size(summary["counts"]),
            {"scene": self.scene, "changes": list(changes)},
            summary["seconds"],
            summary["counts"],
            "" if result.status == "completed" else result.reason,
        )


def values_of(summary: Mapping[str, Any]) -> dict[str, float | None]:
    """The numbers of a summary by the names that checks have for them."""
    values = {f"{name} {part}": value for name, parts in summary["quantities"].items() for part, value in parts.items()}
    counts = summary["counts"]
    if counts["steps"]:
        values["iterations a step"] = counts["coupling_iterations"] / counts["steps"]
    return values


def _relaxed(check: Check | Limit, allowed: Mapping[str, float]) -> Check | Limit:
    if isinstance(check, Limit) or check.quantity not in allowed:
        return check
    return replace(check, allowed=allowed[check.quantity])


def _size(counts: Mapping[str, Any]) -> str:
    parts = [
        f"{name}: {counts[name]['elements']} elements, {counts[name]['unknowns']} unknowns"
        for name in ("fluid", "solid")
        if name in counts
    ]
    steps = counts["steps"]
    return "; ".join([*parts, "1 step" if steps == 1 else f"{steps} steps"])
