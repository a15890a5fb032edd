import numpy as np
import pytest

from hoblock.curves import Arc, Displaced, NodalCurve, Parametric, Reversed, reverse, with_ends
from hoblock.errors import CurveError
from hoblock.reference import gauss_lobatto

T = np.linspace(0.0, 1.0, 11)


def polar(radius, angle, center=(0.3, -0.2)):
    return np.array([center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle)])


@pytest.mark.parametrize(("start", "stop"), [(0.2, 1.9), (1.9, 0.2), (3.0, -3.0), (-0.1, 0.1), (2.0, -1.0)])
def test_arc_from_center_takes_the_shorter_way_at_constant_speed(start, stop):
    arc = Arc.from_center((0.3, -0.2), polar(0.7, start), polar(0.7, stop))
    points = arc(T)
    np.testing.assert_allclose(points[[0, -1]], [polar(0.7, start), polar(0.7, stop)], atol=1e-15)
    np.testing.assert_allclose(np.hypot(*(points - [0.3, -0.2]).T), 0.7, atol=1e-15)
    assert abs(arc.opening) < np.pi
    np.testing.assert_allclose(
        np.diff(T) * abs(arc.opening), 2 * np.arcsin(np.hypot(*np.diff(points, axis=0).T) / 1.4), atol=1e-14
    )


@pytest.mark.parametrize(
    ("start", "middle", "stop"),
    [(0.0, 1.0, 2.0), (2.0, 1.0, 0.0), (0.0, 3.0, 6.0), (0.0, -2.0, 1.0), (2.9, 3.2, -2.9), (-2.9, 0.0, 2.9)],
)
def test_arc_through_passes_its_middle_point_and_no_further(start, middle, stop):
    arc = Arc.through(polar(1.3, start), polar(1.3, middle), polar(1.3, stop))
    np.testing.assert_allclose(arc([0.0, 1.0]), [polar(1.3, start), polar(1.3, stop)], atol=1e-14)
    np.testing.assert_allclose(arc.center, (0.3, -0.2), atol=1e-14)
    t = ((middle - arc.start) / arc.opening) % (2 * np.pi / abs(arc.opening))
    assert 0 < t < 1
    np.testing.assert_allclose(arc([t])[0], polar(1.3, middle), atol=1e-14)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Arc.from_center((0, 0), (1, 0), (0, 1.1)), "end points are 1 and 1.1 away from the centre"),
        (lambda: Arc.from_center((0, 0), (0, 0), (0, 0)), "must be equal and positive"),
        (lambda: Arc.from_center((0, 0), (1, 0), (-1, 0)), "lie opposite each other, so two arcs fit. Give a"),
        (lambda: Arc.through((0, 0), (1, 1), (2, 2)), "three points lie on a line. Leave the curve out"),
        (lambda: Arc.through((0, 0), (0, 0), (2, 2)), "three points lie on a line"),
        (lambda: Parametric(lambda t: t)(T), r"parametric curve: returned shape \(11,\) for 11 parameters"),
        (lambda: Parametric(lambda t: np.stack([t, np.where(t > 0.45, np.inf, t)], -1))(T), "not finite at t = 0.5"),
        (lambda: NodalCurve(np.zeros((6, 2)), 2), r"points have shape \(6, 2\); expected \(n\*2 \+ 1, 2\)"),
        (lambda: NodalCurve(np.zeros((1, 2)), 1), r"points have shape \(1, 2\)"),
        (lambda: NodalCurve(np.zeros((5, 3)), 2), r"points have shape \(5, 3\)"),
    ],
)
def test_errors(make, match):
    with pytest.raises(CurveError, match=match):
        make()


def test_reversed_walks_the_other_way():
    arc = Arc((0.0, 0.0), 1.0, 0.0, 1.0)
    np.testing.assert_allclose(Reversed(arc)(T), arc(1.0 - T))
    np.testing.assert_allclose(Reversed(Reversed(arc))(T), arc(T), atol=1e-15)


def test_displaced_blends_the_motion_of_the_ends():
    arc = Arc((0.0, 0.0), 1.0, 0.0, 1.0)
    moved = Displaced(arc, (0.1, 0.2), (-0.3, 0.4))(T)
    np.testing.assert_allclose(moved[0] - arc([0.0])[0], [0.1, 0.2], atol=1e-15)
    np.testing.assert_allclose(moved[-1] - arc([1.0])[0], [-0.3, 0.4], atol=1e-15)
    np.testing.assert_allclose(moved[5] - arc([0.5])[0], [-0.1, 0.3], atol=1e-15)


def test_nodal_curve_interpolates_its_nodes_and_is_a_polynomial_in_each_element(rng):
    order, count = 3, 4
    points = rng.standard_normal((order * count + 1, 2))
    curve = NodalCurve(points, order)
    assert curve.count == count
    t = np.append(((np.arange(count)[:, None] + (gauss_lobatto(order)[:-1] + 1) / 2) / count).ravel(), 1.0)
    np.testing.assert_allclose(curve(t), points, atol=1e-12)
    inside = np.linspace(0.26, 0.49, 9)  # all in the second element: a cubic
    differences = np.diff(curve(inside), n=4, axis=0)
    np.testing.assert_allclose(differences, 0.0, atol=1e-11)


def test_nodal_curve_has_points_of_its_own():
    points = np.zeros((5, 2))
    curve = NodalCurve(points, 2)
    points[0] = 1.0
    assert not curve.points.any()
    assert not curve.points.flags.writeable


def test_reversed_nodal_curves_stay_nodal():
    nodes = np.array([(0, 0), (0.2, 0.1), (1, 0)])
    turned = reverse(NodalCurve(nodes, 2))
    assert isinstance(turned, NodalCurve)
    np.testing.assert_array_equal(turned.points, nodes[::-1])
    arc = Arc((0.0, 0.0), 1.0, 0.0, 1.0)
    assert reverse(reverse(arc)) is arc
    np.testing.assert_allclose(reverse(arc)(T), arc(1 - T))


@pytest.mark.parametrize("place", [1e4, 1e6, -3e7])
def test_arcs_far_from_the_origin(place):
    center = np.array([place, -place])
    first, second = (center + 0.05 * np.array([np.cos(a), np.sin(a)]) for a in (0.3, 1.4))
    arc = Arc.from_center(tuple(center), first, second)
    assert arc.opening == pytest.approx(1.1, rel=1e-6)


def test_nodal_curves_need_an_order_and_finite_nodes():
    with pytest.raises(CurveError, match="nodal curve: order is 0; expected an integer >= 1"):
        NodalCurve(np.zeros((5, 2)), 0)
    with pytest.raises(CurveError, match=r"nodal curve: points\[1\] is \[nan, 0.0\]; expected finite coordinates"):
        NodalCurve(np.array([(0, 0), (np.nan, 0), (1, 0)]), 2)


def on_circle(angle):
    return np.array([2.0 + 3.0 * np.cos(angle), 1.0 + 3.0 * np.sin(angle)])


@pytest.mark.parametrize(("start", "stop"), [(0.3, 1.1), (1.1, 0.3), (3.0, 3.5), (0.2, 5.5)])
@pytest.mark.parametrize("turn", [Reversed, None])
def test_an_arc_whose_ends_slide_along_its_circle_is_cut_anew(start, stop, turn):
    arc = Arc((2.0, 1.0), 3.0, start, stop - start)
    curve, old = (arc, (start, stop)) if turn is None else (Reversed(arc), (stop, start))
    new = old[0] + 0.1, old[1] - 0.05
    ends = on_circle(new[0]), on_circle(new[1])
    moved = with_ends(curve, tuple(end - on_circle(angle) for end, angle in zip(ends, old, strict=True)), ends)
    t = np.linspace(0.0, 1.0, 9)
    np.testing.assert_allclose(np.hypot(*(moved(t) - [2.0, 1.0]).T), 3.0, rtol=1e-14)
    np.testing.assert_allclose(
        moved(t), on_circle(new[0] + (new[1] - new[0]) * t[:, None].T).reshape(2, -1).T, atol=1e-13
    )


def test_an_arc_whose_end_leaves_its_circle_is_displaced():
    arc = Arc((0.0, 0.0), 1.0, 0.0, 1.0)
    ends = np.array([1.1, 0.0]), arc(np.array([1.0]))[0]
    moved = with_ends(arc, (np.array([0.1, 0.0]), np.zeros(2)), ends)
    assert isinstance(moved, Displaced)
    np.testing.assert_allclose(moved(np.array([0.0, 1.0])), ends)
