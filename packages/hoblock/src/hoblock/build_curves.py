"""From the curves of a scene to the geometry of block edges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hoblock.build_isolines import level_set
from hoblock.build_paths import Pair, at, edge_pairs, take
from hoblock.curves import (
    Arc,
    ArcLength,
    Bezier,
    Curve,
    Ellipse,
    LagrangeEdge,
    Nurbs,
    Parametric,
    Polyline,
    Spline,
    cut_at,
)
from hoblock.errors import CurveError
from hoblock.scene import MeshScene
from hoblock.scene.curves import (
    ArcAbout,
    ArcOfAngle,
    ArcThrough,
    BezierOf,
    CurveScene,
    EllipseAbout,
    Formula,
    Isoline,
    LagrangeThrough,
    NurbsOf,
    PolylineThrough,
    SingleShape,
    SplineThrough,
    WholeShape,
)
from hoblock.topology_checks import check_ends, tolerance

Array = NDArray[np.float64]
Ends = tuple[str | int, str | int]

__all__ = ["build_curves", "parametric"]


def build_curves(scene: MeshScene, sides: set[frozenset[str]]) -> dict[Ends, Curve]:
    """Curves of single edges; ``sides`` are the block edges there are."""
    places: dict[frozenset[str], str] = {}
    curves: dict[Ends, Curve] = {}
    allowed = tolerance(np.array(list(scene.vertices.values()))) if scene.curves else 0.0
    for entry in scene.curves:
        pairs = edge_pairs(entry.on, sides, entry.place)
        for pair in pairs:
            take(places, pair, entry.place, "curve")
        if isinstance(entry.shape, WholeShape):
            found = _along_path(entry, entry.shape, scene.vertices, allowed)
        else:
            found = [_single(entry, entry.shape, pair, scene.vertices, allowed) for pair in pairs]
        curves.update(zip(pairs, found, strict=True))
    return curves


def _single(
    entry: CurveScene, shape: SingleShape, pair: Pair, vertices: Mapping[str, tuple[float, float]], allowed: float
) -> Curve:
    """The curve of one edge, where every edge has one of its own."""
    ends = np.array([vertices[name] for name in pair])
    with at(f"{entry.place} on {pair[0]}–{pair[1]}"):
        curve: Curve
        match shape:
            case ArcAbout(center):
                curve = Arc.from_center(center, ends[0], ends[1])
            case ArcThrough(point):
                curve = Arc.through(ends[0], np.array(point), ends[1])
            case ArcOfAngle(angle):
                curve = Arc.with_angle(ends[0], ends[1], angle)
            case EllipseAbout(center, radii, rotation, long_way):
                curve = Ellipse.from_center(center, radii, rotation, ends[0], ends[1], long_way=long_way)
            case Formula() as formula:
                curve = parametric(formula)
                check_ends(curve(np.array([0.0, 1.0])), ends, pair, allowed, "curve")
            case Isoline() as isoline:
                curve = level_set(isoline, ends[0], ends[1])
                check_ends(curve(np.array([0.0, 1.0])), ends, pair, allowed, "curve")
        return ArcLength(curve) if entry.by_length else curve


def _along_path(
    entry: CurveScene, shape: WholeShape, vertices: Mapping[str, tuple[float, float]], allowed: float
) -> list[Curve]:
    """The curves of all edges of a path, where one curve follows the whole path."""
    if len(entry.on) > 1:
        raise CurveError(
            f"{entry.place}: the curve is given for {len(entry.on)} paths; expected one, since it has two ends of its "
            "own. Write one [[mesh.curve]] for each path."
        )
    (path,) = entry.on
    places = np.array([vertices[name] for name in path])
    with at(f"{entry.place} on {'–'.join(path)}"):
        curve = _whole(shape, places[0], places[-1], allowed)
        check_ends(curve(np.array([0.0, 1.0])), places[[0, -1]], (path[0], path[-1]), allowed, "curve")
        parts = cut_at(curve, places[1:-1], tolerance=allowed, names=path[1:-1])
        return [ArcLength(part) if entry.by_length else part for part in parts]


def _whole(shape: WholeShape, first: Array, second: Array, allowed: float) -> Curve:
    """A curve with an extent of its own; the vertices are the ends of those that go through points."""
    match shape:
        case PolylineThrough(points, parameter):
            return Polyline(_with_ends(points, first, second, allowed), parameter)
        case SplineThrough(points, ends, tangents, parameter):
            return Spline(_with_ends(points, first, second, allowed), ends, tangents, parameter)
        case LagrangeThrough(points, nodes):
            return LagrangeEdge(_with_ends(points, first, second, allowed), nodes)
        case BezierOf(points, weights):
            return Bezier(np.array(points), None if weights is None else np.array(weights))
        case NurbsOf(points, weights, degree, knots):
            arrays = [None if values is None else np.array(values) for values in (weights, knots)]
            return Nurbs(np.array(points).reshape(-1, 2), arrays[0], degree, arrays[1])


def _with_ends(points: tuple[tuple[float, float], ...], first: Array, second: Array, allowed: float) -> Array:
    """Points from vertex to vertex, whether or not the ends are among them."""
    inner = np.array(points, dtype=float).reshape(-1, 2)
    if len(inner) and np.hypot(*(inner[0] - first)) <= allowed:
        inner = inner[1:]
    if len(inner) and np.hypot(*(inner[-1] - second)) <= allowed:
        inner = inner[:-1]
    return np.concatenate([first[None], inner, second[None]])


def parametric(formula: Formula) -> Parametric:
    """Return the curve of a formula in ``s``."""

    def points(s: Array) -> Array:
        return np.stack([formula.x.evaluate(s=s), formula.y.evaluate(s=s)], axis=-1)

    return Parametric(points)
