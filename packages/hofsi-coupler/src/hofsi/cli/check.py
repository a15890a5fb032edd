"""``hofsi check``: whether a scene is complete, and what would be done."""

from __future__ import annotations

import argparse
from pathlib import Path

from hofsi.cli.scene_arguments import add_scene
from hofsi.io.scene import load_case

__all__ = ["DESCRIPTION", "SUMMARY", "add_arguments", "execute", "kept"]

SUMMARY = "validate a scene and say what would be done"
DESCRIPTION = "Validate a scene completely, run nothing, and say what would be done."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    add_scene(parser)


def execute(options: argparse.Namespace) -> int:
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


def kept(options: argparse.Namespace, status: str) -> str:
    """Nothing is left by a check."""
    return ""
