"""``hofsi run``: a scene simulated, its results written and summed up."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hofsi.cli.messages import complain
from hofsi.cli.scene_arguments import add_scene
from hofsi.io.restart_file import RESTART_FILE
from hofsi.io.scene import load_case
from hofsi.io.summary import read_summary

__all__ = ["DESCRIPTION", "SUMMARY", "add_arguments", "execute", "kept"]

SUMMARY = "simulate a scene"
DESCRIPTION = "Simulate a scene and write the results."
_NOT_CONVERGED = 3
_COLUMNS = ("quantity", "last", "mean ± amplitude", "frequency", "phase")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    add_scene(parser)
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="directory for the results")
    parser.add_argument(
        "--resume",
        metavar="FILE",
        nargs="?",
        const="",
        help=f"go on from a restart file, by default {RESTART_FILE} in the directory for the results",
    )
    parser.add_argument("--quiet", action="store_true", help="show nothing but errors")


def execute(options: argparse.Namespace) -> int:
    """Simulate the scene."""
    from hofsi.run import run

    case = load_case(options.scene, options.changes)
    progress, resume = None if options.quiet else sys.stderr, options.resume
    if resume == "":
        resume = Path(options.output) / RESTART_FILE
    result = run(case, options.output, progress=progress, changes=options.changes, resume=resume)
    if result.status != "completed":
        complain(f"{options.scene}: {result.reason}{kept(options, result.status)}")
    if not options.quiet:
        print("\n".join(_report(result.summary, result.directory)))
    return 0 if result.status == "completed" else _NOT_CONVERGED


def kept(options: argparse.Namespace, status: str) -> str:
    """Where the results are of a run that ended with some status, if it came that far."""
    try:
        found = read_summary(Path(options.output) / "summary.json")["status"]
    except (OSError, ValueError, KeyError):
        return ""
    if found != status:
        return ""
    return f" What was computed until then is in {options.output}.{_way_on(options, status)}"


def _way_on(options: argparse.Namespace, status: str) -> str:
    """How to resume a run that left a restart file."""
    if not (Path(options.output) / RESTART_FILE).is_file():
        return ""
    changes = ["--set", *options.changes] if options.changes else []
    command = shlex.join(["hofsi", "run", options.scene, "-o", options.output, *changes, "--resume"])
    smaller = ", with a smaller --set time.dt=… for example" if status == "failed" else ""
    return f" Go on with: {command}{smaller}"


def _report(summary: Mapping[str, Any], directory: Path) -> list[str]:
    """What is printed in the end."""
    counts, seconds = summary["counts"], dict(summary["seconds"])
    steps = f"{counts['steps']} step" + ("" if counts["steps"] == 1 else "s")
    total = seconds.pop("total")
    parts = sorted(seconds.items(), key=lambda item: -item[1])
    lines = [f"{summary['status']}: {steps} in {total:.2f} s", *_table(summary["quantities"])]
    lines.append("seconds: " + ", ".join(f"{name} {value:.2f}" for name, value in parts if value >= 0.005))
    if backflows := counts.get("fluid", {}).get("backflows"):
        lines.append(f"back-flow: fluid came in through stabilised openings, in {backflows} matrices")
    files = sorted(path.name + ("/" if path.is_dir() else "") for path in directory.iterdir())
    lines.append(f"{directory}: " + ", ".join(name for name in files if not name.startswith(".")))
    return lines


def _table(quantities: Mapping[str, Mapping[str, float | None]]) -> list[str]:
    if not quantities:
        return []
    rows: list[tuple[str, ...]] = [_COLUMNS]
    for name, values in quantities.items():
        mean, amplitude, phase = values["mean"], values["amplitude"], values["phase"]
        oscillation = "–" if mean is None or amplitude is None else f"{mean:.6g} ± {amplitude:.6g}"
        ahead = "–" if phase is None else f"{phase:.2f}°"
        rows.append((name, _number(values["last"]), oscillation, _number(values["frequency"]), ahead))
    if all(values["phase"] is None for values in quantities.values()):
        rows = [row[:-1] for row in rows]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.7g}"
