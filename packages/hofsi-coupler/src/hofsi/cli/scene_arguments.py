"""Arguments that name a scene and change it."""

from __future__ import annotations

import argparse

__all__ = ["add_scene"]


def add_scene(parser: argparse.ArgumentParser) -> None:
    """Add the scene's file and ``--set``."""
    parser.add_argument("scene", metavar="SCENE", help="the scene, a TOML file")
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        dest="changes",
        help="change a key of the scene, for example mesh.order=6; more may follow",
    )
