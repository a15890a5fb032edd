"""``[[mesh.curve]]`` of a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path as File
from typing import Any, Literal, cast

from hoblock.errors import SceneError
from hoblock.io.point_file import read_points
from hoblock.io.scene_isoline import read_isoline
from hoblock.io.scene_paths import paths_on
from hoblock.io.table import Table
from hoblock.io.values import Limits, describe, integer_of, number_or_constant_of, pair_of
from hoblock.scene import Path
from hoblock.scene.curves import (
    ArcAbout,
    ArcOfAngle,
    ArcThrough,
    BezierOf,
    CurveScene,
    EllipseAbout,
    Formula,
    LagrangeThrough,
    NurbsOf,
    Point,
    PolylineThrough,
    Shape,
    SplineThrough,
    WholeShape,
)

__all__ = ["read_curve"]


def read_curve(
    table: Table,
    vertices: Mapping[str, Any],
    edges: Mapping[str, tuple[Path, ...]],
    constants: Mapping[str, float],
    folder: File,
) -> CurveScene:
    """Read one table; files it names are looked for in ``folder``."""
    on = paths_on(table, vertices, edges)
    kind = table.string("kind", choices=tuple(_READERS))
    shape = _READERS[kind](_Keys(table, constants, folder))
    by_length = table.string("distribution", "parameter", choices=("parameter", "arc-length")) == "arc-length"
    # a level set, which moves all its vertices, has read its own key of that name
    project = table.boolean("project", False) if isinstance(shape, WholeShape) else False
    table.finish()
    return CurveScene(on, shape, table.place, by_length, project)


@dataclass(frozen=True)
class _Keys:
    """The keys of one curve; numbers may be expressions of the constants."""

    table: Table
    constants: Mapping[str, float]
    folder: File

    def pair(self, key: str) -> Point:
        return self.table.pair(key, constants=self.constants)

    def number(self, key: str, limits: Limits | None = None) -> float:
        return number_or_constant_of(self.table.raw(key), self.table.place_of(key), self.constants, limits)

    def items(self, key: str, what: str) -> list[tuple[object, str]]:
        place, values = self.table.place_of(key), self.table.raw(key)
        if not isinstance(values, list):
            raise SceneError(f"got {describe(values)}; expected a list of {what}", place)
        return [(value, f"{place}[{k}]") for k, value in enumerate(values)]

    def numbers(self, key: str) -> tuple[float, ...] | None:
        if not self.table.has(key):
            return None
        return tuple(number_or_constant_of(*item, self.constants) for item in self.items(key, "numbers"))

    def points(self) -> tuple[Point, ...]:
        listed, filed = self.table.has("points"), self.table.has("file")
        if listed == filed:
            got = "both 'points' and 'file'" if listed else "neither 'points' nor 'file'"
            misspelt = "" if listed else self.table.misspelt("points", "file")
            raise SceneError(f"a curve with {got}; expected exactly one of them{misspelt}", self.table.place)
        if filed:
            return read_points(self.folder / self.table.string("file"), self.table.place_of("file"))
        return tuple(pair_of(*item, self.constants) for item in self.items("points", "points [x, y]"))


def _arc(keys: _Keys) -> Shape:
    given = [key for key in ("center", "through", "angle") if keys.table.has(key)]
    if len(given) != 1:
        got = " and ".join(map(repr, given)) or "none of 'center', 'through' and 'angle'"
        misspelt = keys.table.misspelt("center", "through", "angle") if not given else ""
        raise SceneError(
            f"an arc with {got}; expected exactly one of 'center', 'through', 'angle'{misspelt}", keys.table.place
        )
    if given == ["angle"]:
        return ArcOfAngle(keys.number("angle"))
    return ArcAbout(keys.pair("center")) if given == ["center"] else ArcThrough(keys.pair("through"))


def _ellipse(keys: _Keys) -> Shape:
    rotation = keys.number("rotation") if keys.table.has("rotation") else 0.0
    return EllipseAbout(keys.pair("center"), keys.pair("radii"), rotation, keys.table.boolean("long_way", False))


def _polyline(keys: _Keys) -> Shape:
    parameter = keys.table.string("parameter", "length", choices=("length", "pieces"))
    return PolylineThrough(keys.points(), cast('Literal["length", "pieces"]', parameter))


def _spline(keys: _Keys) -> Shape:
    ends = keys.table.string("ends", "not-a-knot", choices=("not-a-knot", "natural", "clamped", "periodic"))
    parameter = keys.table.string("parameter", "chord", choices=("chord", "centripetal", "uniform"))
    tangents = None
    if keys.table.has("tangents"):
        directions = [pair_of(*item, keys.constants) for item in keys.items("tangents", "two directions [x, y]")]
        if len(directions) != 2:
            raise SceneError(
                f"got {len(directions)} directions; expected two, one at each end", keys.table.place_of("tangents")
            )
        tangents = directions[0], directions[1]
    if (ends == "clamped") != (tangents is not None):
        raise SceneError("expected both ends = 'clamped' and tangents, or neither", keys.table.place)
    return SplineThrough(
        keys.points(),
        cast('Literal["not-a-knot", "natural", "clamped", "periodic"]', ends),
        tangents,
        cast('Literal["chord", "centripetal", "uniform"]', parameter),
    )


def _lagrange(keys: _Keys) -> Shape:
    nodes = keys.table.string("nodes", "equispaced", choices=("equispaced", "gll"))
    return LagrangeThrough(keys.points(), cast('Literal["equispaced", "gll"]', nodes))


def _bezier(keys: _Keys) -> Shape:
    return BezierOf(keys.points(), keys.numbers("weights"))


def _b_spline(keys: _Keys) -> Shape:
    degree = (
        integer_of(keys.table.raw("degree"), keys.table.place_of("degree"), Limits(1))
        if keys.table.has("degree")
        else 3
    )
    return NurbsOf(keys.points(), None, degree, keys.numbers("knots"))


def _nurbs(keys: _Keys) -> Shape:
    weights = keys.numbers("weights")
    polynomial = cast(NurbsOf, _b_spline(keys))
    return NurbsOf(polynomial.points, weights, polynomial.degree, polynomial.knots)


def _formula(keys: _Keys) -> Shape:
    return Formula(
        keys.table.expression("x", ("s",), keys.constants), keys.table.expression("y", ("s",), keys.constants)
    )


def _level_set(keys: _Keys) -> Shape:
    return read_isoline(keys.table, keys.constants, keys.folder)


_READERS: dict[str, Callable[[_Keys], Shape]] = {
    "arc": _arc,
    "b-spline": _b_spline,
    "bezier": _bezier,
    "ellipse": _ellipse,
    "lagrange": _lagrange,
    "level-set": _level_set,
    "nurbs": _nurbs,
    "parametric": _formula,
    "polyline": _polyline,
    "spline": _spline,
}
