"""Every kind of ``[[mesh.curve]]``, read into plain data."""

import pytest

from hoblock.errors import ExpressionError, SceneError
from hoblock.io.scene_curves import read_curve
from hoblock.io.table import Table
from hoblock.scene.curves import (
    ArcAbout,
    ArcOfAngle,
    ArcThrough,
    BezierOf,
    CurveScene,
    EllipseAbout,
    LagrangeThrough,
    NurbsOf,
    PolylineThrough,
    SplineThrough,
)

CONSTANTS = {"r": 2.0}
LISTED = [[1, "r"], ["r/4", 0]]
POINTS = ((1.0, 2.0), (0.5, 0.0))


def read(folder, **keys):
    table = Table({"on": [["a", "b", "c"]]} | keys, "mesh.curve[2]")
    return read_curve(table, dict.fromkeys("abcd"), {"wall": (("a", "b"),)}, CONSTANTS, folder)


@pytest.mark.parametrize(
    ("keys", "shape"),
    [
        ({"kind": "arc", "center": ["r", 0]}, ArcAbout((2.0, 0.0))),
        ({"kind": "arc", "through": [0, 1]}, ArcThrough((0.0, 1.0))),
        ({"kind": "arc", "angle": "-pi/2 + r"}, ArcOfAngle(0.42920367320510344)),
        ({"kind": "ellipse", "center": [0, 0], "radii": ["r", 1]}, EllipseAbout((0.0, 0.0), (2.0, 1.0), 0.0, False)),
        (
            {"kind": "ellipse", "center": [0, 0], "radii": [3, 1], "rotation": "r", "long_way": True},
            EllipseAbout((0.0, 0.0), (3.0, 1.0), 2.0, True),
        ),
        ({"kind": "polyline", "points": LISTED}, PolylineThrough(POINTS, "length")),
        ({"kind": "polyline", "points": [], "parameter": "pieces"}, PolylineThrough((), "pieces")),
        ({"kind": "spline", "points": LISTED}, SplineThrough(POINTS, "not-a-knot", None, "chord")),
        (
            {"kind": "spline", "points": LISTED, "ends": "clamped", "tangents": [[1, 0], [0, "r"]]},
            SplineThrough(POINTS, "clamped", ((1.0, 0.0), (0.0, 2.0)), "chord"),
        ),
        (
            {"kind": "spline", "points": LISTED, "ends": "natural", "parameter": "centripetal"},
            SplineThrough(POINTS, "natural", None, "centripetal"),
        ),
        ({"kind": "lagrange", "points": LISTED}, LagrangeThrough(POINTS, "equispaced")),
        ({"kind": "lagrange", "points": LISTED, "nodes": "gll"}, LagrangeThrough(POINTS, "gll")),
        ({"kind": "bezier", "points": LISTED}, BezierOf(POINTS, None)),
        ({"kind": "bezier", "points": LISTED, "weights": [1, "sqrt(r)/2"]}, BezierOf(POINTS, (1.0, 2**0.5 / 2))),
        ({"kind": "b-spline", "points": LISTED, "degree": 1}, NurbsOf(POINTS, None, 1, None)),
        (
            {"kind": "nurbs", "points": LISTED, "degree": 1, "weights": [1, 3], "knots": [0, 0, "r", "r"]},
            NurbsOf(POINTS, (1.0, 3.0), 1, (0.0, 0.0, 2.0, 2.0)),
        ),
        ({"kind": "nurbs", "points": LISTED}, NurbsOf(POINTS, None, 3, None)),
    ],
)
def test_kinds(keys, shape, tmp_path):
    assert read(tmp_path, **keys) == CurveScene((("a", "b", "c"),), shape, "mesh.curve[2]", False)


@pytest.mark.parametrize("kind", ["polyline", "spline", "lagrange", "bezier", "b-spline", "nurbs"])
def test_points_of_a_file_beside_the_scene(kind, tmp_path):
    (tmp_path / "walls").mkdir()
    (tmp_path / "walls" / "lower.csv").write_text("x,y\n1,2\n0.5,0\n", encoding="utf-8")
    assert read(tmp_path, kind=kind, file="walls/lower.csv").shape.points == POINTS


def test_expressions_of_a_parameter(tmp_path):
    formula = read(tmp_path, kind="parametric", x="r*s", y="1").shape
    assert (formula.x.evaluate(s=0.25), formula.y.value) == (0.5, 1.0)


@pytest.mark.parametrize("kind", ["arc", "polyline"])
def test_distribution_by_arc_length(kind, tmp_path):
    keys = {"kind": kind, "angle": 1} if kind == "arc" else {"kind": kind, "points": LISTED}
    assert read(tmp_path, **keys, distribution="arc-length").by_length
    assert not read(tmp_path, **keys, distribution="parameter").by_length


@pytest.mark.parametrize(
    ("keys", "match"),
    [
        ({"kind": "nurb"}, r"kind: got 'nurb'\. Did you mean 'nurbs'\? Expected one of 'arc', 'b-spline', 'bezier'"),
        ({"kind": "arc", "center": [0, 0], "angle": 1}, "an arc with 'center' and 'angle'; expected exactly one of"),
        ({"kind": "arc", "throgh": [0, 0]}, r"exactly one of 'center', .*\. Is it misspelt as 'throgh'\?$"),
        ({"kind": "arc", "distribution": "arc-length"}, r"an arc with none of .* one of 'center', 'through', 'angle'$"),
        (
            {"kind": "nurbs", "piont": LISTED, "degree": 2},
            r"neither .*exactly one of them\. Is it misspelt as 'piont'\?$",
        ),
        ({"kind": "ellipse", "center": [0, 0]}, r"radii: the required key is missing"),
        ({"kind": "ellipse", "center": [0, 0], "radii": 2}, r"radii: got the number 2"),
        (
            {"kind": "ellipse", "center": [0, 0], "radii": [1, 2], "long_way": 1},
            "long_way: got the number 1; expected true or false",
        ),
        ({"kind": "spline"}, "a curve with neither 'points' nor 'file'; expected exactly one of them"),
        ({"kind": "spline", "points": LISTED, "file": "x.csv"}, "a curve with both 'points' and 'file'"),
        ({"kind": "spline", "points": 3}, r"points: got the number 3; expected a list of points \[x, y\]"),
        ({"kind": "spline", "points": [[1, 2], [1]]}, r"points\[1\]: got a list of 1"),
        ({"kind": "spline", "points": LISTED, "ends": "open"}, r"ends: got 'open'"),
        ({"kind": "spline", "points": LISTED, "ends": "clamped"}, "expected both ends = 'clamped' and tangents"),
        (
            {"kind": "spline", "points": LISTED, "ends": "clamped", "tangents": [[1, 0]]},
            "tangents: got 1 directions; expected two, one at each end",
        ),
        ({"kind": "lagrange", "points": LISTED, "nodes": "gauss"}, r"nodes: got 'gauss'"),
        ({"kind": "bezier", "points": LISTED, "weights": 1}, "weights: got the number 1; expected a list of numbers"),
        ({"kind": "bezier", "points": LISTED, "degree": 2}, "degree: unknown key"),
        ({"kind": "b-spline", "points": LISTED, "weights": [1, 1]}, "weights: unknown key"),
        ({"kind": "nurbs", "points": LISTED, "degree": 0}, r"degree: got 0; expected an integer"),
        ({"kind": "nurbs", "points": LISTED, "degree": 2.0}, r"degree: got the number 2; expected an integer"),
        ({"kind": "nurbs", "points": LISTED, "knots": [0, True]}, r"knots\[1\]: got the boolean true"),
        ({"kind": "arc", "angle": 1, "distribution": "length"}, "distribution: got 'length'.*expected one of"),
        ({"kind": "polyline", "file": "gone.csv"}, r"file: the file .*gone\.csv cannot be read: No such file"),
    ],
)
def test_errors_name_the_key(keys, match, tmp_path):
    with pytest.raises(SceneError, match=r"(?i)^mesh\.curve\[2\].*" + match):
        read(tmp_path, **keys)


def test_only_constants_may_stand_for_numbers(tmp_path):
    with pytest.raises(ExpressionError, match=r"mesh\.curve\[2\]\.points\[0\]\[1\]: .*'s'"):
        read(tmp_path, kind="polyline", points=[[0, "s"]])
