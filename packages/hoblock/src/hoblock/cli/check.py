"""``hoblock check``: a report on the mesh of a scene."""

from __future__ import annotations

import argparse

from hoblock.cli.command import Command
from hoblock.cli.report import overview
from hoblock.cli.source import add_scene, load_scene

__all__ = ["COMMAND"]


def _run(arguments: argparse.Namespace) -> None:
    source = load_scene(arguments)
    source.raise_if_invalid()
    print(overview(source))


COMMAND = Command("check", "make the mesh of a scene and report its size and quality", add_scene, _run)
