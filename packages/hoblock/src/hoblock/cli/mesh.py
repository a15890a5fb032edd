"""``hoblock mesh``: the mesh of a scene in a file."""

from __future__ import annotations

import argparse

from hoblock.cli.command import Command
from hoblock.cli.formats import add_output, write
from hoblock.cli.report import overview
from hoblock.cli.source import add_scene, load_scene

__all__ = ["COMMAND"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    add_output(parser)


def _run(arguments: argparse.Namespace) -> None:
    source = load_scene(arguments)
    source.raise_if_invalid()
    written = write(arguments, source.mesh)
    print(overview(source))
    print(written)


COMMAND = Command("mesh", "make the mesh of a scene and write it to a file", _add_arguments, _run)
