"""What all benchmarks share: their result as a table for people and as JSON for programs."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from time import perf_counter

from hofsi.io.summary import machine, versions

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Result:
    """Rows of one benchmark, with what they were measured on."""

    benchmark: str
    settings: Mapping[str, object]
    rows: Sequence[Mapping[str, object]]
    machine: Mapping[str, object] = field(default_factory=machine)
    versions: Mapping[str, str] = field(default_factory=versions)
    date: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))

    def table(self) -> str:
        """The rows as a Markdown table."""
        names = list(self.rows[0])
        cells = [names, *([_text(row[name]) for name in names] for row in self.rows)]
        widths = [max(len(line[k]) for line in cells) for k in range(len(names))]
        padded = ([cell.rjust(w) for cell, w in zip(line, widths, strict=True)] for line in cells)
        lines = ["| " + " | ".join(line) + " |" for line in padded]
        rule = "|" + "|".join("-" * (w + 1) + ":" for w in widths) + "|"
        return "\n".join([lines[0], rule, *lines[1:]])

    def write(self, path: Path) -> None:
        """Write everything as JSON."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(asdict(self), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def _text(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def parser(description: str | None) -> argparse.ArgumentParser:
    """Return a parser of arguments that knows ``--json``."""
    options = argparse.ArgumentParser(description=description)
    options.add_argument("--json", type=Path, metavar="FILE", help="result; default results/NAME.json")
    return options


def report(result: Result, path: Path | None) -> Result:
    """Print the table and write the file."""
    path = path or ROOT / "results" / f"{result.benchmark}.json"
    result.write(path)
    print(f"{result.benchmark}, {result.date}\n\n{result.table()}\n\nwrote {path}")
    return result


def fastest(call: Callable[[], object], repeats: int) -> float:
    """Shortest of some measured times in seconds: the one that the machine's other work disturbed least."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return min(times)
