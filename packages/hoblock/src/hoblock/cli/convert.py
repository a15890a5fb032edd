"""``hoblock convert``: a mesh file in another format or of another order."""

from __future__ import annotations

import argparse
from pathlib import Path

from hoblock.cli.command import Command, UsageError
from hoblock.cli.formats import add_format, write
from hoblock.cli.source import Source
from hoblock.io.mesh_file import read_mesh
from hoblock.resampling import geometric_error, resample
from hoblock.scene import HIGHEST_ORDER

__all__ = ["COMMAND"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("source", metavar="IN", help="mesh file to read")
    parser.add_argument("output", metavar="OUT", help="mesh file to write; its suffix tells the format")
    add_format(parser)
    parser.add_argument(
        "--order",
        type=int,
        metavar="Q",
        help="order of the elements written: the same geometry upwards, interpolated downwards (the error is reported)",
    )
    parser.add_argument("--unchecked", action="store_true", help="write a mesh that is not valid, too")


def _run(arguments: argparse.Namespace) -> None:
    order = arguments.order
    if order is not None and not 1 <= order <= HIGHEST_ORDER:
        raise UsageError(f"--order is {order}; expected 1 to {HIGHEST_ORDER}.")
    if Path(arguments.source).suffix.lower() == ".toml":
        raise UsageError(
            f"{arguments.source} is a scene; expected a mesh file. For a scene use: "
            f"hoblock mesh {arguments.source} -o {arguments.output}."
        )
    mesh = read_mesh(arguments.source)
    result = mesh if order is None else resample(mesh, order)
    if not arguments.unchecked:
        Source(arguments.source, result).raise_if_invalid()
    lines = write(arguments, result)
    print(f"read {arguments.source}: {len(mesh.cells)} elements of order {mesh.order}, {len(mesh.points)} nodes")
    if result.order != mesh.order:
        error = geometric_error(mesh, result)
        what = "the same geometry" if result.order > mesh.order else f"points have moved by up to {error:.3g}"
        print(f"order {mesh.order} to {result.order}: {what}")
    print(lines)


COMMAND = Command(
    "convert", "write a mesh file in another format or with elements of another order", _add_arguments, _run
)
