"""Curves that are given by points: ellipses, polylines, splines, Lagrange, Bézier, B-splines and NURBS."""

import numpy as np
import pytest
from scipy.interpolate import BSpline as ScipyBSpline

from hoblock.curves import Arc, Bezier, BSpline, Ellipse, LagrangeEdge, Nurbs, Polyline, Spline, reverse, with_ends
from hoblock.errors import CurveError

T = np.linspace(0.0, 1.0, 41)
ENDS = np.array([0.0, 1.0])
POINTS = np.array([(0.0, 0.0), (1.0, 2.0), (3.0, 1.0), (4.0, -1.0), (6.0, 0.5)])
HALF = np.sqrt(0.5)

CURVES = {
    "polyline": Polyline(POINTS),
    "polyline by pieces": Polyline(POINTS, "pieces"),
    "spline": Spline(POINTS),
    "natural spline": Spline(POINTS, "natural", parameter="centripetal"),
    "clamped spline": Spline(POINTS, "clamped", ((1, 0), (0, 2)), "uniform"),
    "lagrange": LagrangeEdge(POINTS),
    "lagrange gll": LagrangeEdge(POINTS, "gll"),
    "lagrange given": LagrangeEdge(POINTS, [0, 0.1, 0.4, 0.8, 1]),
    "bezier": Bezier(POINTS),
    "rational bezier": Bezier(POINTS, [1, 2, 0.5, 3, 1]),
    "b-spline": BSpline(POINTS, 2),
    "nurbs": Nurbs(POINTS, [1, 2, 0.5, 3, 1], 3),
}


@pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES)
def test_they_run_from_the_first_point_to_the_last_and_back(curve):
    assert curve(T).shape == (41, 2)
    np.testing.assert_allclose(curve(ENDS), POINTS[[0, -1]], atol=1e-14)
    np.testing.assert_array_equal(reverse(curve)(T), curve(1.0 - T))


@pytest.mark.parametrize("kind", ["polyline", "spline", "natural spline", "clamped spline"])
def test_breaks_are_at_the_points(kind):
    curve = CURVES[kind]
    np.testing.assert_allclose(curve(curve.breaks), POINTS[1:-1], atol=1e-13)


def test_polylines_are_straight_between_their_points():
    by_length, by_pieces = CURVES["polyline"], CURVES["polyline by pieces"]
    np.testing.assert_allclose(by_pieces(np.array([0.125, 0.25])), [(0.5, 1.0), (1.0, 2.0)], atol=1e-15)
    steps = np.hypot(*np.diff(by_length(np.linspace(0, by_length.breaks[0], 5)), axis=0).T)
    assert np.ptp(steps) < 1e-14


@pytest.mark.parametrize("name", ["lagrange", "lagrange gll", "lagrange given"])
def test_lagrange_edges_are_polynomials_through_their_nodes(name):
    curve = CURVES[name]
    x = np.linspace(0, 1, 5)
    if name == "lagrange gll":
        x = (1 + np.array([-1, -np.sqrt(3 / 7), 0, np.sqrt(3 / 7), 1])) / 2
    if name == "lagrange given":
        x = np.array([0, 0.1, 0.4, 0.8, 1])
    np.testing.assert_allclose(curve(x), POINTS, atol=1e-13)
    for d in range(2):
        np.testing.assert_allclose(np.polyval(np.polyfit(T, curve(T)[:, d], 4), T), curve(T)[:, d], atol=1e-11)


def test_splines_are_twice_differentiable_and_keep_their_end_conditions():
    step = 1e-4
    for name in ("spline", "natural spline", "clamped spline"):
        curve = CURVES[name]
        for t in curve.breaks:
            left, right = (curve(t + sign * step * np.arange(4.0)) for sign in (-1, 1))
            seconds = [(2 * p[0] - 5 * p[1] + 4 * p[2] - p[3]) / step**2 for p in (left, right)]
            np.testing.assert_allclose(*seconds, rtol=0, atol=0.05 * np.abs(seconds).max())
    natural = CURVES["natural spline"](step * np.arange(4.0))
    assert np.abs(2 * natural[0] - 5 * natural[1] + 4 * natural[2] - natural[3]).max() / step**2 < 1.0
    first, last = (
        np.diff(CURVES["clamped spline"](t), axis=0)[0] for t in (np.array([0, 1e-6]), np.array([1 - 1e-6, 1]))
    )
    assert abs(first[1]) < 1e-4 * first[0]
    assert abs(last[0]) < 1e-4 * last[1]


def test_bezier_curves_are_bernstein_sums():
    from math import comb

    bernstein = np.stack([comb(4, k) * T**k * (1 - T) ** (4 - k) for k in range(5)], axis=-1)
    np.testing.assert_allclose(CURVES["bezier"](T), bernstein @ POINTS, atol=1e-14)
    weights = np.array([1, 2, 0.5, 3, 1])
    rational = (bernstein * weights) @ POINTS / (bernstein @ weights)[:, None]
    np.testing.assert_allclose(CURVES["rational bezier"](T), rational, atol=1e-14)


def test_nurbs_against_scipy_and_their_special_cases():
    knots = np.array([0, 0, 0, 0.3, 0.7, 2, 2, 2.0])
    curve = BSpline(POINTS, 2, knots)
    np.testing.assert_allclose(curve(T), ScipyBSpline(knots, POINTS, 2)(2 * T), atol=1e-14)
    np.testing.assert_allclose(curve.breaks, [0.15, 0.35])
    np.testing.assert_allclose(Nurbs(POINTS, degree=4)(T), Bezier(POINTS)(T), atol=1e-14)
    np.testing.assert_allclose(Nurbs(POINTS, np.full(5, 7.0), 3)(T), BSpline(POINTS, 3)(T), atol=1e-14)
    loose = BSpline(POINTS, 2, np.arange(8.0))  # not clamped: from knot 2 to knot 5
    np.testing.assert_allclose(loose(T), ScipyBSpline(np.arange(8.0), POINTS, 2)(2 + 3 * T), atol=1e-14)


def test_nurbs_and_rational_bezier_make_exact_circles():
    half = Nurbs([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)], [1, HALF, 1, HALF, 1], 2, [0, 0, 0, 1, 1, 2, 2, 2])
    np.testing.assert_allclose(np.hypot(*half(T).T), 1.0, atol=4e-16)
    quarter = Bezier([(1, 0), (1, 1), (0, 1)], [1, HALF, 1])
    np.testing.assert_allclose(np.hypot(*quarter(T).T), 1.0, atol=4e-16)


@pytest.mark.parametrize("rotation", [0.0, 0.7, -2.0])
@pytest.mark.parametrize(("start", "opening"), [(0.3, 1.2), (3.0, -2.5), (-0.1, 3.0)])
@pytest.mark.parametrize("long_way", [False, True])
def test_ellipses_between_two_of_their_points(rotation, start, opening, long_way):
    if long_way:
        opening -= np.copysign(2 * np.pi, opening)
    whole = Ellipse((1.0, -2.0), (3.0, 0.5), rotation, start, opening)
    found = Ellipse.from_center((1.0, -2.0), (3.0, 0.5), rotation, *whole(ENDS), long_way=long_way)
    np.testing.assert_allclose(found(T), whole(T), atol=1e-13)


def test_ellipses_with_equal_radii_are_arcs():
    arc = Arc((1.0, 2.0), 1.5, 0.4, -1.1)
    np.testing.assert_allclose(Ellipse((1.0, 2.0), (1.5, 1.5), 0.3, 0.1, -1.1)(T), arc(T), atol=1e-14)


def test_an_end_can_slide_along_its_ellipse_but_not_leave_it():
    curve = Ellipse((0, 0), (2, 1), 0.3, 0.2, 1.0)
    slid = Ellipse((0, 0), (2, 1), 0.3, 0.3, 0.8)
    ends = slid(ENDS)
    moved = with_ends(curve, tuple(ends - curve(ENDS)), tuple(ends))
    assert isinstance(moved, Ellipse)
    np.testing.assert_allclose(moved(T), slid(T), atol=1e-13)
    assert curve.cut(ends[0], ends[1] + 0.01) is None


@pytest.mark.parametrize("angle", [0.5, -0.5, np.pi, -np.pi, 4.0, -6.0])
def test_arcs_of_an_angle(angle):
    arc = Arc.with_angle((1.0, 1.0), (2.0, 3.0), angle)
    np.testing.assert_allclose(arc(ENDS), [(1, 1), (2, 3)], atol=1e-13)
    # The area between chord and arc: r²(θ - sin θ)/2, to the right of the chord for a positive angle.
    points = arc(np.linspace(0, 1, 20001))
    x, y = (points - points[0]).T
    area = 0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])
    assert area == pytest.approx(0.5 * arc.radius**2 * (angle - np.sin(angle)), rel=1e-6)


BAD = {
    "1 points; expected at least 2": lambda: Polyline([(0, 0)]),
    r"shape \(2, 3\); expected \(n, 2\)": lambda: Spline([(0, 0, 0), (1, 1, 1)]),
    "polyline: points are .*; expected pairs of numbers": lambda: Polyline([(0, 0), (1, "a")]),
    r"points\[1\] is \[nan, 0\.0\]; expected finite": lambda: Bezier([(0, 0), (np.nan, 0)]),
    r"points\[1\] and points\[2\] are both \(1, 0\)\. Remove": lambda: Polyline([(0, 0), (1, 0), (1, 0)]),
    "spline: points.*are both": lambda: Spline([(0, 0), (0, 0), (1, 0)]),
    "polyline: parameter is 'chord'": lambda: Polyline(POINTS, "chord"),
    "spline: ends is 'open'": lambda: Spline(POINTS, "open"),
    "spline: parameter is 'length'": lambda: Spline(POINTS, parameter="length"),
    "tangents go with ends = 'clamped'": lambda: Spline(POINTS, "clamped"),
    "expected two directions that are not zero": lambda: Spline(POINTS, "clamped", ((0, 0), (1, 0))),
    "lagrange edge: nodes is 'gauss'": lambda: LagrangeEdge(POINTS, "gauss"),
    "expected 5 numbers ascending from 0 to 1": lambda: LagrangeEdge(POINTS, [0, 0.5, 0.4, 0.9, 1]),
    r"weights have shape \(2,\); expected \(5,\)": lambda: Bezier(POINTS, [1, 1]),
    r"weights\[1\] is -1; expected a positive number": lambda: Nurbs(POINTS, [1, -1, 1, 1, 1]),
    "degree 5 with 5 control points; expected a degree from 1 to 4": lambda: BSpline(POINTS, 5),
    "degree is 2.0; expected an integer": lambda: BSpline(POINTS, 2.0),
    "7 knots; expected 8": lambda: BSpline(POINTS, 2, [0, 0, 0, 1, 2, 2, 2]),
    r"knots\[3\] is 2 and knots\[4\] is 1; expected finite numbers that": lambda: BSpline(
        POINTS, 2, [0, 0, 0, 2, 1, 3, 3, 3]
    ),
    "empty or breaks apart": lambda: (
        BSpline(POINTS, 1, [0, 0, 1, 1, 1, 2, 2]) and BSpline(POINTS, 2, [0, 0, 0, 0, 0, 0, 0, 0])
    ),
    "expected positive radii": lambda: Ellipse((0, 0), (1, 0), 0, 0, 1),
    "opening angle 7": lambda: Ellipse((0, 0), (1, 2), 0, 0, 7.0),
    r"at 1\.5 of the radius in its direction; expected 1": lambda: Ellipse.from_center(
        (0, 0), (2, 1), 0, (2, 0), (0, 1.5)
    ),
    "lie opposite each other": lambda: Ellipse.from_center((0, 0), (2, 1), 0, (2, 0), (-2, 0)),
    "the end points coincide": lambda: Ellipse.from_center((0, 0), (2, 1), 0, (2, 0), (2, 0)),
    "arc of angle 0: expected an angle": lambda: Arc.with_angle((0, 0), (1, 0), 0.0),
    r"both end points are \(1, 0\)": lambda: Arc.with_angle((1, 0), (1, 0), 1.0),
}


@pytest.mark.parametrize(("match", "make"), BAD.items(), ids=range(len(BAD)))
def test_what_makes_no_curve_is_refused(match, make):
    with pytest.raises(CurveError, match=match):
        make()
