"""The parser of the command line, and where errors become messages."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from hoblock.cli import check, convert, mesh, plot, quality, templates
from hoblock.cli.command import UsageError
from hoblock.errors import HoblockError, SceneError
from hoblock.io.toml import repeat_option

__all__ = ["COMMANDS", "main"]

COMMANDS = (check.COMMAND, mesh.COMMAND, quality.COMMAND, plot.COMMAND, convert.COMMAND, templates.COMMAND)
"""Subcommands in the order of the help text."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; default those of the process.

    Returns
    -------
    int
        0, or 2 if the scene, its mesh or a file is bad; then one message is on standard error.
    """
    arguments = _parser().parse_args(repeat_option(sys.argv[1:] if argv is None else argv))
    source, output = getattr(arguments, "source", ""), getattr(arguments, "output", "")
    try:
        arguments.command.run(arguments)
        sys.stdout.flush()
    except BrokenPipeError:  # whoever reads, as `head` does, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except UsageError as error:
        return _fail(f"{arguments.command.name}: {error}")
    except SceneError as error:
        return _fail(str(error) if error.file or not source else f"{source}: {error}")
    except HoblockError as error:
        named = any(name and str(error).startswith(name) for name in (source, output))
        return _fail(str(error) if named or not source else f"{source}: {error}")
    except OSError as error:
        return _fail(_system_message(error, str(error.filename or source), output))
    return 0


def _system_message(error: OSError, name: str, output: str | None) -> str:
    """What the system says about a file, and the way out."""
    folder = Path(name).parent
    remedy = ""
    if isinstance(error, FileNotFoundError | NotADirectoryError):
        remedy = "Check the name and the folder."
        if name == output and not folder.is_dir():
            remedy = f"There is no folder {folder}: make it first."
    elif isinstance(error, IsADirectoryError):
        remedy = "Give the name of a file."
    elif isinstance(error, PermissionError):
        remedy = "Check the rights of the file and its folder, or choose another folder."
    return f"{name}: {error.strerror or error}. {remedy}".rstrip()


def _fail(message: str) -> int:
    sys.stdout.flush()  # a report that is already there comes first
    print(f"hoblock: {message}", file=sys.stderr)
    return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="hoblock",
        description="High-order block-structured quad meshes.",
        epilog="hoblock COMMAND --help describes a command. The exit code is 0, or 2 if a scene, mesh or file is bad.",
    )
    parser.add_argument("--version", action="version", version=f"hoblock {_version()}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        subparser = commands.add_parser(command.name, help=command.summary, description=command.summary)
        command.add_arguments(subparser)
        subparser.set_defaults(command=command)
    return parser


def _version() -> str:
    from hoblock import __version__

    return __version__
