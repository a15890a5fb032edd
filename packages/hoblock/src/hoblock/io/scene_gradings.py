"""``[[mesh.grading]]`` of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from hoblock.io.scene_paths import paths_on
from hoblock.io.table import Table
from hoblock.scene import GradingScene, Path

__all__ = ["read_grading"]


def read_grading(table: Table, vertices: Mapping[str, Any], edges: Mapping[str, tuple[Path, ...]]) -> GradingScene:
    """Read one table."""
    on = paths_on(table, vertices, edges)
    name = table.string("kind", choices=("uniform", "quadratic", "cubic", "exponential"))
    kind: Literal["uniform", "quadratic", "cubic", "exponential"]
    parameter = 0.0
    match name:
        case "quadratic":
            kind, parameter = "quadratic", table.number("m", above=-1.0, below=1.0)
        case "cubic":
            kind, parameter = "cubic", table.number("m", minimum=0.0, below=1.0)
        case "exponential":
            kind, parameter = "exponential", table.number("a", minimum=-50.0, maximum=50.0)
        case _:
            kind = "uniform"
    table.finish()
    return GradingScene(on, kind, parameter, table.place)
