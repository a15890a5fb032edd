"""The parser of the command line, and where errors become messages and exit codes."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from hoblock.errors import HoblockError, SceneError
from hoblock.io.toml import repeat_option
from hofsi.cli import bench, check, run
from hofsi.cli.messages import complain
from hofsi.errors import HofsiError
from hofsi.interruptions import Terminated
from hofsi.version import __version__

__all__ = ["main"]

_COMMANDS = {"run": run, "check": check, "bench": bench}
_BAD_INPUT, _INTERRUPTED, _TERMINATED = 2, 130, 143


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; by default those of the process.

    Returns
    -------
    int
        0, or 1 for a benchmark that does not find what it has to, 2 for bad input, 3 for a run that did not converge,
        130 for one that was interrupted, 143 for one that was asked to end by SIGTERM.
    """
    options = _parser().parse_args(repeat_option(sys.argv[1:] if arguments is None else arguments))
    try:
        return int(_COMMANDS[options.command].execute(options))
    except (HoblockError, HofsiError) as error:
        complain(_named(error, getattr(options, "scene", "")))
        return error.exit_code if isinstance(error, HofsiError) else _BAD_INPUT
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        complain(f"{where}{error.strerror or error}. Check the output directory and its permissions.")
        return _BAD_INPUT
    except KeyboardInterrupt as interruption:
        complain(f"interrupted.{_COMMANDS[options.command].kept(options, 'interrupted')}")
        return _TERMINATED if isinstance(interruption, Terminated) else _INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="hofsi", description="Fluid-structure interaction on moving meshes.")
    parser.add_argument("--version", action="version", version=f"hofsi {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="run | check | bench")
    for name, command in _COMMANDS.items():
        command.add_arguments(commands.add_parser(name, help=command.SUMMARY, description=command.DESCRIPTION))
    return parser


def _named(error: Exception, scene: str) -> str:
    """The message, with the scene's name where there is one and the error does not know it."""
    return str(error) if not scene or (isinstance(error, SceneError) and error.file) else f"{scene}: {error}"
