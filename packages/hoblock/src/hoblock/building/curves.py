"""From the curves of a scene to the geometry of block edges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hoblock.building.isolines import level_set
from hoblock.building.paths import Pair, at, edge_pairs, take
from hoblock.curves import (
    Arc,
    ArcLength,
    Bezier,
    BSpline,
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
from hoblock.scene import MeshScene, Path
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

_TOO_NEAR = 1e-3  # of the distance between neighbouring points: a point so near to a vertex is meant to be the vertex

__all__ = ["build_curves", "parametric", "whole_curve"]


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
    curve = whole_curve(entry, shape, vertices, allowed)
    path = entry.on[0]
    places = np.array([vertices[name] for name in path])
    with at(f"{entry.place} on {'–'.join(path)}"):
        check_ends(curve(np.array([0.0, 1.0])), places[[0, -1]], (path[0], path[-1]), allowed, "curve")
        parts = cut_at(curve, places[1:-1], tolerance=allowed, names=path[1:-1])
        return [ArcLength(part) if entry.by_length else part for part in parts]


def whole_curve(
    entry: CurveScene, shape: WholeShape, vertices: Mapping[str, tuple[float, float]], allowed: float
) -> Curve:
    """Return the curve that follows a whole path; only those that go through points are sure to meet its ends.

    Parameters
    ----------
    entry : CurveScene
    shape : WholeShape
        The entry's.
    vertices : mapping of name to (x, y)
    allowed : float
        Distance within which points coincide.

    Raises
    ------
    CurveError
        If it is given for several paths, or does not exist.
    """
    if len(entry.on) > 1:
        raise CurveError(
            f"{entry.place}: the curve is given for {len(entry.on)} paths; expected one, since it has two ends of its "
            "own. Write one [[mesh.curve]] for each path."
        )
    (path,) = entry.on
    with at(f"{entry.place} on {'–'.join(path)}"):
        return _whole(shape, path, np.array([vertices[name] for name in path]), allowed)


def _whole(shape: WholeShape, path: Path, places: Array, allowed: float) -> Curve:
    """A curve with an extent of its own; the vertices are the ends of those that go through points."""

    def through(points: tuple[tuple[float, float], ...]) -> Array:
        return _with_ends(points, (path[0], path[-1]), places[[0, -1]], allowed)

    match shape:
        case PolylineThrough(points, parameter):
            return Polyline(through(points), parameter)
        case SplineThrough(points, ends, tangents, parameter):
            return Spline(through(points), ends, tangents, parameter)
        case LagrangeThrough(points, nodes):
            return LagrangeEdge(through(points), nodes)
        case BezierOf(points, weights):
            return Bezier(np.array(points), None if weights is None else np.array(weights))
        case NurbsOf(points, None, degree, knots):
            return BSpline(np.array(points), degree, None if knots is None else np.array(knots))
        case NurbsOf(points, weights, degree, knots):
            return Nurbs(np.array(points), np.array(weights), degree, None if knots is None else np.array(knots))


def _with_ends(points: tuple[tuple[float, float], ...], names: Pair, ends: Array, allowed: float) -> Array:
    """Points from vertex to vertex, whether or not the ends are among them."""
    given = np.array(points, dtype=float).reshape(-1, 2)
    closed = bool((ends[0] == ends[1]).all())
    first, last = (np.hypot(*(given - end).T) for end in ends)  # distances of the points from the ends
    if not closed and len(given) > 1 and max(last[0], first[-1]) <= allowed:
        raise CurveError(
            f"the points run from '{names[1]}' to '{names[0]}', the path from '{names[0]}' to '{names[1]}'. Turn one "
            "of them round."
        )
    for k, neighbour, distance, name in ((0, 1, first, names[0]), (-1, -2, last, names[1])):
        if len(given) > 1 and allowed < distance[k] < _TOO_NEAR * np.hypot(*(given[neighbour] - given[k])):
            raise CurveError(
                f"the {'first' if k == 0 else 'last'} point ({given[k, 0]:.10g}, {given[k, 1]:.10g}) is only "
                f"{distance[k]:.2g} away from vertex '{name}', which would make a kink; must coincide with it within "
                f"{allowed:.1g}, or be left out. Move the vertex there, or remove the point."
            )
    inner = given[int((first[:1] <= allowed).sum()) : len(given) - int((last[-1:] <= allowed).sum())]
    return np.concatenate([ends[:1], inner, ends[1:]])


def parametric(formula: Formula) -> Parametric:
    """Return the curve of a formula in ``s``."""

    def points(s: Array) -> Array:
        return np.stack([formula.x.evaluate(s=s), formula.y.evaluate(s=s)], axis=-1)

    return Parametric(points)
