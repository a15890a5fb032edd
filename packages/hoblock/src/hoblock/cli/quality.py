"""``hoblock quality``: certificate, measures, histograms and worst elements of a mesh."""

from __future__ import annotations

import argparse
import json

from hoblock.cli.command import Command, UsageError
from hoblock.cli.report import as_json, as_text
from hoblock.cli.source import add_scene_or_file, load
from hoblock.quality import quality_summary

__all__ = ["COMMAND"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene_or_file(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--worst",
        type=int,
        default=5,
        metavar="N",
        help="how many of the worst elements to list (default: %(default)s)",
    )


def _run(arguments: argparse.Namespace) -> None:
    if arguments.worst < 0:
        raise UsageError(f"--worst is {arguments.worst}; expected 0 or more.")
    source = load(arguments)
    summary = quality_summary(source.mesh, worst=arguments.worst)
    print(json.dumps(as_json(source, summary), indent=2) if arguments.json else as_text(source, summary))
    source.raise_if_invalid()


COMMAND = Command(
    "quality",
    "report the certificate and the quality of a mesh; of one that is not valid, too, but with exit code 2",
    _add_arguments,
    _run,
)
