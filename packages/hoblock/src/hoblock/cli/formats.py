"""Mesh files from the command line: the options for their format, and what a format cannot hold."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from hoblock.cli.command import UsageError
from hoblock.io.element_sides import transfinite_deviation
from hoblock.io.mesh_file import FORMATS, write_mesh
from hoblock.mesh import QuadMesh

__all__ = ["add_format", "add_output", "write"]

_SIDES_ONLY = ("abaqus", "ism", "ism-mm", "ism-v2")


def add_format(parser: argparse.ArgumentParser) -> None:
    """Add the options for the format of the file to be written."""
    parser.add_argument("--format", choices=sorted(FORMATS), help="of the file, where its suffix does not tell it")
    parser.add_argument(
        "--boundaries",
        nargs="+",
        metavar="NAME",
        help="named edges to write in order of precedence, where some share a side (abaqus and ism formats only)",
    )


def add_output(parser: argparse.ArgumentParser) -> None:
    """Add the options for the file to be written."""
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="mesh file; its suffix tells the format")
    add_format(parser)


def write(arguments: argparse.Namespace, mesh: QuadMesh) -> str:
    """Write the mesh to ``arguments.output`` and return what there is to say about it.

    Raises
    ------
    UsageError
        If boundaries are to be chosen for a format that holds them all.
    MeshFileError
        If the format is unknown or cannot hold the mesh.
    """
    path, format = arguments.output, arguments.format
    sides_only = format in _SIDES_ONLY or (format is None and Path(path).suffix.lower() == ".inp")
    if arguments.boundaries is None:
        write_mesh(path, mesh, format=format)
    elif sides_only:
        write_mesh(path, mesh, format=format, boundaries=arguments.boundaries)
    else:
        raise UsageError(f"--boundaries is for {', '.join(_SIDES_ONLY)}; other formats hold all names. Leave it out.")
    lines = [f"wrote {path}"]
    if sides_only:
        deviation = transfinite_deviation(mesh)
        if deviation > 1e-12 * float(np.ptp(mesh.points, axis=0).max()):
            lines.append(
                "the format holds the sides of the elements only: rebuilt from these, inner nodes are "
                f"up to {deviation:.3g} away"
            )
    return "\n".join(lines)
