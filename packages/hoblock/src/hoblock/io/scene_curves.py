"""``[[mesh.curve]]`` of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hoblock.errors import SceneError
from hoblock.io.scene_paths import paths_on
from hoblock.io.table import Table
from hoblock.scene import ArcAbout, ArcThrough, CurveScene, Formula, Path

__all__ = ["read_curve"]


def read_curve(
    table: Table, vertices: Mapping[str, Any], edges: Mapping[str, tuple[Path, ...]], constants: Mapping[str, float]
) -> CurveScene:
    """Read one table."""
    on = paths_on(table, vertices, edges)
    kind = table.string("kind", choices=("arc", "parametric"))
    shape = _arc(table, constants) if kind == "arc" else _formula(table, constants)
    table.finish()
    return CurveScene(on, shape, table.place)


def _arc(table: Table, constants: Mapping[str, float]) -> ArcAbout | ArcThrough:
    about, through = table.has("center"), table.has("through")
    if about == through:
        got = "both 'center' and 'through'" if about else "neither 'center' nor 'through'"
        raise SceneError(f"an arc with {got}; expected exactly one of them", table.place)
    if about:
        return ArcAbout(table.pair("center", constants=constants))
    return ArcThrough(table.pair("through", constants=constants))


def _formula(table: Table, constants: Mapping[str, float]) -> Formula:
    return Formula(table.expression("x", ("s",), constants), table.expression("y", ("s",), constants))
