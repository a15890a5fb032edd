"""``hofsi bench``: cases with known results, what is found of them, and how long it takes."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from hofsi.cli.messages import complain

if TYPE_CHECKING:
    from hofsi.bench.benchmark import Measured

__all__ = ["DESCRIPTION", "SUMMARY", "add_arguments", "execute", "kept"]

SUMMARY = "run cases with known results and judge what is found"
DESCRIPTION = (
    "Run cases with known results, one after the other: each says what it found beside the reference, whether that is "
    "near enough, and its seconds. Without names all are run, half an hour; --quick takes some minutes. The "
    "exit code is 1 if one of them fails."
)
_FAILED = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("cases", metavar="CASE", nargs="*", help="a benchmark; --list shows their names")
    parser.add_argument("--json", metavar="FILE", type=Path, help="also write everything to a file")
    parser.add_argument("--quick", action="store_true", help="smaller problems, held to wider limits")
    parser.add_argument(
        "--jobs", metavar="N", type=_positive, default=1, help="how many to run side by side (default: 1)"
    )
    parser.add_argument("--list", action="store_true", help="show the benchmarks and run none")


def execute(options: argparse.Namespace) -> int:
    """Run the benchmarks."""
    from hofsi.bench import BENCHMARKS, chosen, lines_of, measurements, protocol
    from hofsi.io.summary import write_summary

    names = chosen(options.cases)
    if options.list:
        width = max(map(len, names))
        print("\n".join(f"{name:<{width}}  {BENCHMARKS[name].title}" for name in names))
        return 0
    found: dict[str, Measured] = {}

    def write() -> None:
        if options.json:
            write_summary(options.json, protocol(found, quick=options.quick, jobs=options.jobs))

    write()  # a place that cannot be written to is known before anything runs
    for name, measured in measurements(names, quick=options.quick, jobs=options.jobs):
        found[name] = measured
        print("\n".join(lines_of(BENCHMARKS[name], measured)), end="\n\n", flush=True)
        write()
    failed = [name for name in names if not found[name].passed]
    print(f"{len(names) - len(failed)} of {len(names)} benchmarks passed")
    if failed:
        complain(f"not near enough, or not to the end: {', '.join(failed)}.")
    return _FAILED if failed else 0


def kept(options: argparse.Namespace, status: str) -> str:
    """Where the benchmarks are that were finished before an interruption."""
    return f" What was finished is in {options.json}." if options.json and options.json.is_file() else ""


def _positive(text: str) -> int:
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"got {text!r}; must be a positive integer")
    return number
