"""The command line: ``hofsi run`` and ``hofsi check``."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hoblock.errors import HoblockError, SceneError
from hoblock.io.toml import repeat_option
from hofsi.errors import HofsiError
from hofsi.interruptions import Terminated
from hofsi.io.restart_file import RESTART_FILE
from hofsi.io.scene import load_case
from hofsi.io.summary import read_summary
from hofsi.version import __version__

__all__ = ["main"]

_BAD_INPUT, _NOT_CONVERGED, _INTERRUPTED, _TERMINATED = 2, 3, 130, 143
_COLUMNS = ("quantity", "last", "mean ± amplitude", "frequency", "phase")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; by default those of the process.

    Returns
    -------
    int
        0, or 2 for bad input, 3 for a run that did not converge, 130 for one that was interrupted, 143 for one that was
        asked to end by SIGTERM.
    """
    options = _parser().parse_args(repeat_option(sys.argv[1:] if arguments is None else arguments))
    try:
        return _check(options) if options.command == "check" else _run(options)
    except (HoblockError, HofsiError) as error:
        _complain(_named(error, options.scene))
        return error.exit_code if isinstance(error, HofsiError) else _BAD_INPUT
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        _complain(f"{where}{error.strerror or error}. Check the output directory and its permissions.")
        return _BAD_INPUT
    except KeyboardInterrupt as interruption:
        _complain(f"interrupted.{_kept(options, 'interrupted')}")
        return _TERMINATED if isinstance(interruption, Terminated) else _INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="hofsi", description="Fluid-structure interaction on moving meshes.")
    parser.add_argument("--version", action="version", version=f"hofsi {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="run | check")
    run = commands.add_parser("run", help="simulate a scene", description="Simulate a scene and write the results.")
    check = commands.add_parser(
        "check",
        help="validate a scene and say what would be done",
        description="Validate a scene completely, run nothing, and say what would be done.",
    )
    for command in (run, check):
        command.add_argument("scene", metavar="SCENE", help="the scene, a TOML file")
        command.add_argument(
            "--set",
            metavar="KEY=VALUE",
            action="append",
            default=[],
            dest="changes",
            help="change a key of the scene, for example mesh.order=6; more may follow",
        )
    run.add_argument("-o", "--output", metavar="DIR", required=True, help="directory for the results")
    run.add_argument(
        "--resume",
        metavar="FILE",
        nargs="?",
        const="",
        help=f"go on from a restart file, by default {RESTART_FILE} in the directory for the results",
    )
    run.add_argument("--quiet", action="store_true", help="show nothing but errors")
    return parser


def _check(options: argparse.Namespace) -> int:
    """Everything that a run does before its first step."""
    from hofsi.build import build
    from hofsi.notes import notes
    from hofsi.plan import plan
    from hofsi.quantities import evaluators

    case = load_case(options.scene, options.changes)
    lines = plan(case).lines()
    problem = build(case)
    evaluators(problem)
    known = notes(problem)
    print(case.title or Path(case.file).name)
    print("\n".join(lines))
    if known:
        print("\n".join(["notes:", *(f"  {text}." for text in known)]))
    return 0


def _run(options: argparse.Namespace) -> int:
    from hofsi.run import run

    case = load_case(options.scene, options.changes)
    progress, resume = None if options.quiet else sys.stderr, options.resume
    if resume == "":
        resume = Path(options.output) / RESTART_FILE
    result = run(case, options.output, progress=progress, changes=options.changes, resume=resume)
    if result.status != "completed":
        _complain(f"{options.scene}: {result.reason}{_kept(options, result.status)}")
    if not options.quiet:
        print("\n".join(_report(result.summary, result.directory)))
    return 0 if result.status == "completed" else _NOT_CONVERGED


def _named(error: Exception, scene: str) -> str:
    """The message, with the scene's name where the error does not know it."""
    return str(error) if isinstance(error, SceneError) and error.file else f"{scene}: {error}"


def _complain(message: str) -> None:
    print(f"hofsi: {message}", file=sys.stderr)


def _kept(options: argparse.Namespace, status: str) -> str:
    """Where the results are of a run that ended with some status, if it came that far."""
    if options.command != "run":
        return ""
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
