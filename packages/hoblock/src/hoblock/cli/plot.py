"""``hoblock plot``: a picture of a mesh."""

from __future__ import annotations

import argparse

from hoblock.cli.command import Command, UsageError
from hoblock.cli.source import add_scene_or_file, load
from hoblock.plot import MEASURES, plot_mesh

__all__ = ["COMMAND"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene_or_file(parser)
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help=".png, .svg or .pdf")
    parser.add_argument(
        "--color",
        choices=[*MEASURES, "groups"],
        default="scaled_jacobian",
        help="what the colours of the elements show (default: %(default)s)",
    )
    parser.add_argument("--names", action="store_true", help="write the names of the block vertices")
    parser.add_argument("--counts", action="store_true", help="write the number of elements on each block edge")
    parser.add_argument(
        "--numbers", action="store_true", help="write the numbers of the elements, as messages name them"
    )
    parser.add_argument("--nodes", action="store_true", help="draw the nodes of the elements")
    parser.add_argument("--blocks-only", action="store_true", help="draw the blocks without their elements")
    parser.add_argument("--no-edges", action="store_true", help="leave out the colours of the named edges")
    parser.add_argument(
        "--zoom", nargs=4, type=float, metavar=("X0", "X1", "Y0", "Y1"), help="draw this part of the plane only"
    )
    parser.add_argument("--width", type=float, default=10.0, metavar="INCHES", help="of the picture (default: 10)")
    parser.add_argument("--dpi", type=int, default=200, metavar="N", help="pixels an inch, for .png (default: 200)")


def _check(arguments: argparse.Namespace) -> None:
    if arguments.zoom is not None:
        x0, x1, y0, y1 = arguments.zoom
        if not (x0 < x1 and y0 < y1):
            raise UsageError(f"--zoom is {x0:g} {x1:g} {y0:g} {y1:g}; expected X0 < X1 and Y0 < Y1.")
    if not 1.0 <= arguments.width <= 100.0:
        raise UsageError(f"--width is {arguments.width:g}; expected 1 to 100 inches.")
    if not 10 <= arguments.dpi <= 2000:
        raise UsageError(f"--dpi is {arguments.dpi}; expected 10 to 2000.")


def _run(arguments: argparse.Namespace) -> None:
    _check(arguments)
    source = load(arguments)
    if source.structure is None:
        for option in ("names", "counts", "blocks_only"):
            if getattr(arguments, option):
                raise UsageError(
                    f"--{option.replace('_', '-')} needs blocks, but {source.name} is a mesh file; draw its scene."
                )
    plot_mesh(
        source.mesh,
        arguments.output,
        structure=source.structure,
        color=None if arguments.color == "groups" else arguments.color,
        vertex_names=arguments.names,
        counts=arguments.counts,
        element_numbers=arguments.numbers,
        nodes=arguments.nodes,
        edge_groups=not arguments.no_edges,
        blocks_only=arguments.blocks_only,
        zoom=None if arguments.zoom is None else tuple(arguments.zoom),
        title=source.title,
        width=arguments.width,
        dpi=arguments.dpi,
    )
    print(f"wrote {arguments.output}")
    source.raise_if_invalid()


COMMAND = Command(
    "plot", "draw a mesh; one that is not valid, too, with bad elements red and exit code 2", _add_arguments, _run
)
