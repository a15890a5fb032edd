"""Curves walked from the other end and curves with ends that have moved: their breaks, kinds and parameters."""

import numpy as np
import pytest

from hoblock.curves import (
    Affine,
    Arc,
    ArcLength,
    Between,
    Displaced,
    Ellipse,
    NodalCurve,
    Parametric,
    Piece,
    Polyline,
    Reversed,
    Spline,
    length_table,
    piece,
    reverse,
    with_ends,
)
from hoblock.errors import CurveError

T = np.linspace(0.0, 1.0, 17)
ENDS = np.array([0.0, 1.0])
BENT = Polyline([(0, 0), (1, 0), (1, 3)])
SHIFTS = np.array([0.1, 0.2]), np.array([-0.3, 0.0])


def moved(curve, shifts=SHIFTS):
    return with_ends(curve, shifts, tuple(curve(ENDS) + np.array(shifts)))


@pytest.mark.parametrize(
    "curve",
    [reverse(BENT), moved(BENT), moved(reverse(BENT)), reverse(moved(BENT)), Affine(reverse(BENT), np.eye(2), [1, 2])],
)
def test_breaks_are_where_the_kink_is(curve):
    (kink,) = curve.breaks
    before, at, after = curve(kink + np.array([-1e-3, 0.0, 1e-3]))
    first, second = at - before, after - at
    cosine = first @ second / np.hypot(*first) / np.hypot(*second)
    assert abs(cosine) < 0.4  # a right angle, bent somewhat by the motion
    for t in (kink - 0.01, kink + 0.01):
        steps = np.diff(curve(t + np.array([-1e-3, 0.0, 1e-3])), axis=0)
        assert np.abs(np.diff(steps, axis=0)).max() < 1e-12


def test_smooth_curves_have_no_breaks_however_derived():
    arc = Arc((0, 0), 1.0, 0.2, 1.0)
    for curve in (reverse(arc), moved(arc), ArcLength(reverse(arc)), Between(arc, None, 0.3, ((1, 0), (0, 1)))):
        assert curve.breaks.shape == (0,)


def test_breaks_of_both_edges_break_the_line_between_them():
    line = Between(BENT, reverse(BENT), 0.5, ((0, 0), (1, 3)))
    np.testing.assert_allclose(line.breaks, [0.25, 0.75])
    same = Between(BENT, Reversed(Reversed(Reversed(reverse(BENT)))), 0.5, ((0, 0), (1, 3)))
    assert same.breaks.shape == (1,)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Between(None, None, 1.5, ((0, 0), (1, 0))), r"fraction is 1\.5; expected one from 0 to 1"),
        (lambda: Between(None, None, 0.5, ((0, 0), (1, np.nan))), "expected two points of finite coordinates"),
        (lambda: Arc((0, 0), 0.0, 0.0, 1.0), "radius 0; expected a positive one"),
        (lambda: Arc((0, np.nan), 1.0, 0.0, 1.0), "expected finite numbers"),
        (lambda: Arc((0, 0), 1.0, 0.0, 0.0), "opening angle 0; expected one between"),
        (lambda: Arc((0, 0), 1.0, 0.0, 7.0), "opening angle 7; expected one between"),
        (lambda: Parametric(3.0), r"got 3\.0; expected a function of t"),
    ],
)
def test_impossible_ones_are_refused(make, match):
    with pytest.raises(CurveError, match=match):
        make()


@pytest.mark.parametrize("turn", [lambda curve: curve, reverse])
def test_a_curve_by_arc_length_stays_one_when_its_ends_move(turn):
    curve = turn(ArcLength(Parametric(lambda t: np.stack([t**2 + t, np.sin(2 * t)], axis=-1))))
    after = moved(curve)
    np.testing.assert_allclose(after(ENDS), curve(ENDS) + np.array(SHIFTS), atol=1e-14)
    halves = [length_table(Piece(after, *ends)).length for ends in ((0.0, 0.5), (0.5, 1.0))]
    assert halves[0] == pytest.approx(halves[1], rel=1e-12)


@pytest.mark.parametrize("turn", [lambda curve: curve, reverse])
def test_an_end_slides_along_a_circle_that_is_taken_by_arc_length(turn):
    arc = Arc((2.0, 1.0), 3.0, 0.3, 1.1)
    curve = turn(ArcLength(arc))
    goal = turn(Arc((2.0, 1.0), 3.0, 0.4, 0.8))
    after = with_ends(curve, tuple(goal(ENDS) - curve(ENDS)), tuple(goal(ENDS)))
    np.testing.assert_allclose(after(T), goal(T), atol=1e-13)


def test_moved_back_means_not_moved():
    there = moved(BENT)
    back = with_ends(there, tuple(-s for s in SHIFTS), tuple(BENT(ENDS)))
    assert isinstance(back, Displaced)
    assert back.curve is BENT
    np.testing.assert_allclose(back(T), BENT(T), atol=1e-15)


@pytest.mark.parametrize(
    "whole",
    [
        Arc((1.0, 2.0), 3.0, 0.4, -5.5),
        Ellipse((1.0, 2.0), (3.0, 1.0), 0.3, 0.4, 5.5),
        NodalCurve(np.array([(0, 0), (1, 0.2), (2, 0), (3, -0.3), (4, 0.1)], dtype=float), 2),
    ],
)
@pytest.mark.parametrize("turn", [lambda curve: curve, reverse])
def test_pieces_keep_the_kind_also_of_reversed_and_displaced_curves(whole, turn):
    def kind(curve):
        return type(curve.curve) if isinstance(curve, Reversed | Displaced) else type(curve)

    curve = turn(whole)
    for one in (curve, Displaced(curve, (0.1, 0.2), (-0.3, 0.5))):
        part = piece(one, 0.5, 1.0)
        np.testing.assert_allclose(part(T), one(0.5 + 0.5 * T), atol=1e-14)
        assert kind(part) is kind(one)
        assert kind(piece(part, 0.0, 1.0)) is kind(one)


@pytest.mark.parametrize("whole", [Arc((1.0, 2.0), 3.0, 0.4, -5.5), Ellipse((1.0, 2.0), (3.0, 1.0), 0.3, 0.4, 5.5)])
def test_the_end_of_a_piece_far_round_slides_on_it(whole):
    part = Piece(whole, 0.8, 0.9)
    ends = whole(np.array([0.82, 0.95]))
    after = with_ends(part, tuple(ends - part(ENDS)), tuple(ends))
    np.testing.assert_allclose(after(T), whole(0.82 + 0.13 * T), atol=1e-13)


def test_a_piece_of_a_spline_that_moves_is_displaced():
    part = piece(Spline([(0, 0), (1, 2), (3, 1), (4, -1)]), 0.2, 0.7)
    after = moved(part)
    assert isinstance(after, Displaced)
    np.testing.assert_allclose(after(ENDS), part(ENDS) + np.array(SHIFTS), atol=1e-15)
