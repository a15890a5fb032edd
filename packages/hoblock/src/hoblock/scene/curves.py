"""Curves as a scene states them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from hoblock.expressions import Expression
from hoblock.scene.paths import Path

__all__ = [
    "ArcAbout",
    "ArcOfAngle",
    "ArcThrough",
    "BezierOf",
    "CurveScene",
    "EllipseAbout",
    "Formula",
    "Isoline",
    "LagrangeThrough",
    "NurbsOf",
    "Point",
    "PolylineThrough",
    "Shape",
    "SingleShape",
    "SplineThrough",
    "WholeShape",
]

Point = tuple[float, float]


@dataclass(frozen=True)
class ArcAbout:
    """The shorter circular arc about a centre."""

    center: tuple[float, float]


@dataclass(frozen=True)
class ArcThrough:
    """The circular arc through a third point."""

    point: tuple[float, float]


@dataclass(frozen=True)
class Formula:
    """A parametric curve: x and y as expressions in ``s``, 0 at the first vertex, 1 at the second."""

    x: Expression
    y: Expression


@dataclass(frozen=True)
class ArcOfAngle:
    """The circular arc with an opening angle in radians, positive counter-clockwise."""

    angle: float


@dataclass(frozen=True)
class EllipseAbout:
    """The arc of an ellipse: centre, radii, angle of the first axis in radians, and whether the longer arc is meant."""

    center: Point
    radii: tuple[float, float]
    rotation: float
    long_way: bool


@dataclass(frozen=True)
class PolylineThrough:
    """Straight pieces through points; ``parameter`` as of `hoblock.curves.Polyline`."""

    points: tuple[Point, ...]
    parameter: Literal["length", "pieces"]


@dataclass(frozen=True)
class SplineThrough:
    """The cubic spline through points; ``ends``, ``tangents`` and ``parameter`` as of `hoblock.curves.Spline`."""

    points: tuple[Point, ...]
    ends: Literal["not-a-knot", "natural", "clamped", "periodic"]
    tangents: tuple[Point, Point] | None
    parameter: Literal["chord", "centripetal", "uniform"]


@dataclass(frozen=True)
class LagrangeThrough:
    """The polynomial through nodes, equispaced or Gauss–Lobatto–Legendre."""

    points: tuple[Point, ...]
    nodes: Literal["equispaced", "gll"]


@dataclass(frozen=True)
class BezierOf:
    """The Bézier curve of control points, rational with weights."""

    points: tuple[Point, ...]
    weights: tuple[float, ...] | None


@dataclass(frozen=True)
class NurbsOf:
    """The B-spline of control points, rational with weights; without knots they are equally spaced."""

    points: tuple[Point, ...]
    weights: tuple[float, ...] | None
    degree: int
    knots: tuple[float, ...] | None


@dataclass(frozen=True)
class Isoline:
    """The isoline of a function between the vertices.

    Attributes
    ----------
    function : Expression or callable
        In ``x`` and ``y``; or a field read from a file, a function of points (n, 2).
    level : float
    reach : float
        As of `hoblock.curves.LevelSet`.
    project : bool
        Whether the vertices are moved onto the isoline first.
    """

    function: Expression | Callable[[Any], Any]
    level: float
    reach: float
    project: bool


WholeShape = PolylineThrough | SplineThrough | LagrangeThrough | BezierOf | NurbsOf
"""Geometry with an extent of its own: on a path of several edges it is cut at the vertices."""

SingleShape = ArcAbout | ArcThrough | ArcOfAngle | EllipseAbout | Formula | Isoline
"""Geometry that every single edge of a path has by itself."""

Shape = SingleShape | WholeShape
"""The geometry of an edge, whatever its kind."""


@dataclass(frozen=True)
class CurveScene:
    """One ``[[mesh.curve]]``: the geometry of the edges along some paths, in the direction of the paths.

    Attributes
    ----------
    on : tuple of Path
        The paths; a name from ``[mesh.edges]`` is already replaced by its paths.
    shape : Shape
        The geometry of each single edge.
    place : str
        Where it stands in the scene.
    by_length : bool
        Whether elements are distributed by arc length instead of the curve's parameter.
    project : bool
        Whether the inner vertices of the path are moved onto a curve with an extent of its own first.
    """

    on: tuple[Path, ...]
    shape: Shape
    place: str
    by_length: bool = False
    project: bool = False
