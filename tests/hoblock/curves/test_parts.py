"""Curves made from curves: pieces, affine images, lines between, and curves cut at points."""

import numpy as np
import pytest

from hoblock.curves import (
    Affine,
    Arc,
    Between,
    LagrangeEdge,
    NodalCurve,
    Nurbs,
    Parametric,
    Piece,
    Polyline,
    Spline,
    closest_parameters,
    cut_at,
    piece,
    reverse,
    transformed,
    with_ends,
)
from hoblock.errors import CurveError

T = np.linspace(0.0, 1.0, 23)
SPLINE = Spline([(0, 0), (1, 2), (3, 1), (4, -1)])
ARC = Arc((1.0, 2.0), 3.0, 0.4, -2.0)
NODAL = NodalCurve(np.array([(0, 0), (1, 0.2), (2, 0), (3, -0.3), (4, 0.1)], dtype=float), 2)
TURN = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
MIRROR = np.array([[1.0, 0.0], [0.0, -1.0]])


@pytest.mark.parametrize("curve", [SPLINE, ARC, NODAL, reverse(ARC)])
def test_pieces_follow_the_whole(curve):
    for start, stop in ((0.1, 0.6), (0.5, 1.0), (0.0, 0.5)):
        part = piece(curve, start, stop)
        np.testing.assert_allclose(part(T), curve(start + (stop - start) * T), atol=1e-14)
    assert piece(curve, 0.0, 1.0) is curve


def test_kinds_that_pieces_keep():
    assert isinstance(piece(ARC, 0.2, 0.9), Arc)
    half = piece(NODAL, 0.5, 1.0)
    assert isinstance(half, NodalCurve)
    np.testing.assert_array_equal(half.points, NODAL.points[2:])
    assert isinstance(piece(NODAL, 0.3, 1.0), Piece)


def test_a_piece_of_a_piece_is_one_of_the_whole():
    part = Piece(Piece(SPLINE, 0.2, 0.8), 0.5, 1.0)
    assert part.curve is SPLINE
    assert (part.start, part.stop) == (0.5, 0.8)
    np.testing.assert_allclose(part.breaks, (SPLINE.breaks[SPLINE.breaks > 0.5] - 0.5) / 0.3)
    np.testing.assert_array_equal(part(np.array([0.0, 1.0])), SPLINE(np.array([0.5, 0.8])))


@pytest.mark.parametrize(("start", "stop"), [(0.5, 0.5), (0.6, 0.2), (-0.1, 1.0), (0.0, 1.1)])
def test_pieces_need_an_extent(start, stop):
    with pytest.raises(CurveError, match="expected 0 <= start < stop <= 1"):
        Piece(SPLINE, start, stop)


@pytest.mark.parametrize("curve", [SPLINE, ARC, NODAL, Polyline([(0, 0), (1, 1), (2, 0)])])
@pytest.mark.parametrize("matrix", [TURN, MIRROR, 2.5 * TURN, np.array([[1.0, 0.5], [0.0, 2.0]])])
def test_images_of_curves(curve, matrix):
    image = transformed(curve, matrix, np.array([3.0, -1.0]))
    np.testing.assert_allclose(image(T), curve(T) @ matrix.T + (3.0, -1.0), atol=1e-13)
    back = transformed(image, np.linalg.inv(matrix), np.linalg.inv(matrix) @ (-3.0, 1.0))
    np.testing.assert_allclose(back(T), curve(T), atol=1e-13)


def test_kinds_that_images_keep():
    assert isinstance(transformed(ARC, MIRROR @ TURN, np.zeros(2)), Arc)
    assert isinstance(transformed(NODAL, MIRROR, np.ones(2)), NodalCurve)
    twice = Affine(Affine(SPLINE, TURN, np.ones(2)), MIRROR, np.zeros(2))
    assert twice.curve is SPLINE
    np.testing.assert_array_equal(twice.breaks, SPLINE.breaks)


def test_an_end_can_slide_along_an_image_and_along_a_piece():
    sheared = Affine(ARC, np.array([[1.0, 0.5], [0.0, 2.0]]), np.ones(2))
    ends = sheared(np.array([0.1, 0.9]))
    moved = with_ends(sheared, tuple(ends - sheared(np.array([0.0, 1.0]))), tuple(ends))
    np.testing.assert_allclose(moved(T), sheared(0.1 + 0.8 * T), atol=1e-13)


def test_singular_maps_are_refused():
    with pytest.raises(CurveError, match="singular; expected a regular one"):
        Affine(SPLINE, np.ones((2, 2)), np.zeros(2))
    with pytest.raises(CurveError, match=r"shapes \(2, 2\) and \(3,\)"):
        Affine(SPLINE, np.eye(2), np.zeros(3))


def test_the_line_between_two_edges_is_that_of_the_transfinite_map():
    bottom = Parametric(lambda t: np.stack([2 * t, 0.3 * np.sin(np.pi * t)], axis=-1))
    top = Parametric(lambda t: np.stack([2 * t, 1 + 0.2 * t * (1 - t)], axis=-1))
    left = Parametric(lambda t: np.stack([-0.2 * t * (1 - t), t], axis=-1))
    right = Parametric(lambda t: np.stack([2 + 0.4 * t * (1 - t), t], axis=-1))
    v = 0.3
    ends = tuple(tuple(map(float, side(np.array([v]))[0])) for side in (left, right))
    line = Between(bottom, top, v, ends)
    u = T[:, None]
    corners = (1 - u) * (1 - v) * np.array([0, 0]) + u * (1 - v) * np.array([2, 0])
    corners = corners + u * v * np.array([2, 1]) + (1 - u) * v * np.array([0, 1])
    exact = (1 - v) * bottom(T) + v * top(T) + (1 - u) * np.array(ends[0]) + u * np.array(ends[1]) - corners
    np.testing.assert_allclose(line(T), exact, atol=1e-15)
    np.testing.assert_allclose(Between(None, None, v, ends)(T), (1 - u) * ends[0] + u * ends[1], atol=1e-15)


def test_closest_places(rng):
    angle = rng.uniform(0.05, 0.95, 20)
    offset = rng.uniform(-0.5, 2.0, 20)
    feet = ARC(angle)
    normal = (feet - ARC.center) / ARC.radius
    t, distance = closest_parameters(ARC, feet + offset[:, None] * normal)
    np.testing.assert_allclose(t, angle, atol=2e-8)
    np.testing.assert_allclose(distance, np.abs(offset), atol=1e-13)
    t, distance = closest_parameters(ARC, feet)  # on the curve the parameter itself is exact
    np.testing.assert_allclose(t, angle, atol=1e-14)
    assert distance.max() < 1e-14


def test_closest_places_on_curves_that_meander_and_come_near_themselves(rng):
    for _ in range(40):
        points = np.stack([np.sort(rng.uniform(0.0, 1.0, 7)), rng.uniform(-0.4, 0.4, 7)], axis=-1)
        for curve in (LagrangeEdge(points), Spline(points, parameter="uniform"), Polyline(points)):
            there = curve(rng.uniform(0.0, 1.0, 5))
            t, distance = closest_parameters(curve, there)
            assert distance.max() < 1e-12
            np.testing.assert_allclose(curve(t), there, atol=1e-12)


@pytest.mark.parametrize("number", [0, 1, 4000])
def test_closest_places_of_none_one_and_many_points(number, rng):
    points = rng.uniform(-5.0, 5.0, (number, 2))
    t, distance = closest_parameters(Arc((0.0, 0.0), 1.0, -1.0, 2.0), points)
    angle = np.clip(np.arctan2(points[:, 1], points[:, 0]), -1.0, 1.0)
    exact = np.hypot(points[:, 0] - np.cos(angle), points[:, 1] - np.sin(angle))
    np.testing.assert_allclose(distance, exact, atol=1e-13)
    assert t.shape == (number,)


def test_the_nearer_side_of_a_kink_is_found():
    kink = Polyline([(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)])
    t, distance = closest_parameters(kink, [(0.995, 0.98), (1.006, 0.98)])
    assert t[0] < 0.5 < t[1]
    np.testing.assert_allclose(distance, [0.015 / np.sqrt(2.0), 0.014 / np.sqrt(2.0)], atol=1e-14)


def test_points_that_are_not_finite_have_no_closest_place():
    with pytest.raises(CurveError, match=r"closest place on a curve: points\[1\] is \[1\.0, nan\]; expected finite"):
        closest_parameters(ARC, [(0.0, 0.0), (1.0, np.nan)])


def test_a_curve_cut_at_points_on_it():
    curve = Nurbs([(0, 0), (1, 2), (3, 2), (4, 0), (6, 0)], [1, 2, 1, 1, 1], 3)
    points = curve(np.array([0.3, 0.75]))
    parts = cut_at(curve, points, tolerance=1e-12)
    assert len(parts) == 3
    ends = np.array([part(np.array([0.0, 1.0])) for part in parts])
    np.testing.assert_allclose(ends[0, 1], points[0], atol=1e-14)
    np.testing.assert_array_equal(ends[:-1, 1], ends[1:, 0])
    assert cut_at(curve, np.zeros((0, 2)), tolerance=1e-12) == (curve,)
    with pytest.raises(CurveError, match=r"'q' at \(1, 1\.5\) is 0\.\d+ off the curve, whose closest point is \("):
        cut_at(curve, [(1, 1.5)], tolerance=1e-9, names=["q"])
    with pytest.raises(CurveError, match="expected ascending"):
        cut_at(curve, points[::-1], tolerance=1e-9)
