import numpy as np
import pytest
from scipy.special import ellipe

from hoblock.curves import Arc, ArcLength, Ellipse, NodalCurve, Parametric, Polyline, Reversed, Spline, length_table
from hoblock.errors import CurveError


def test_lengths_of_known_curves():
    assert length_table(Arc((1e3, 2.0), 1.3, 0.3, -2.0)).length == pytest.approx(2.6, rel=3e-14)
    quarter = Ellipse((0, 0), (3, 1), 0.4, 0.0, np.pi / 2)
    assert length_table(quarter).length == pytest.approx(3 * ellipe(1 - 1 / 9), rel=1e-14)
    parabola = Parametric(lambda t: np.stack([t, t**2], axis=-1))
    assert length_table(parabola).length == pytest.approx(np.sqrt(5) / 2 + np.arcsinh(2) / 4, rel=1e-14)
    root = Parametric(lambda t: np.stack([t, np.sqrt(t)], axis=-1))  # endless speed at its first end
    assert length_table(root).length == pytest.approx(np.sqrt(5) / 2 + np.arcsinh(2) / 4, rel=1e-10)


@pytest.mark.parametrize("place", [1e2, 1e4, -1e6])
def test_lengths_far_from_the_origin(place):
    table = length_table(Arc((place, 2.0), 0.7, 0.1, 2.5))
    assert table.length == pytest.approx(1.75, rel=1e-14 * abs(place))
    assert len(table.speeds) < 20


def test_lengths_add_up_over_breaks_and_over_hidden_corners():
    zigzag = [(0, 0), (1, 0), (1, 2), (0.5, 2)]
    assert length_table(Polyline(zigzag)).length == pytest.approx(3.5, rel=1e-14)
    hidden = Parametric(lambda t: np.stack([t, np.abs(t - 0.3)], axis=-1))
    assert length_table(hidden).length == pytest.approx(np.sqrt(2), rel=1e-12)


def test_parameters_are_where_the_length_is(rng):
    curve = Parametric(lambda t: np.stack([np.exp(2 * t), np.sin(5 * t)], axis=-1))
    table = length_table(curve)
    t = np.sort(rng.uniform(0.0, 1.0, 40))
    passed = [length_table(Parametric(lambda s, end=end: curve(s * end))).length for end in t]
    np.testing.assert_allclose(table.parameters(np.array(passed)), t, atol=2e-13)
    np.testing.assert_array_equal(table.parameters(np.array([0.0, table.length])), [0.0, 1.0])
    np.testing.assert_array_equal(table.parameters(np.array([[-1.0], [99.0]])), [[0.0], [1.0]])


def test_by_arc_length_equal_steps_are_equally_long(rng):
    uneven = Parametric(lambda t: np.stack([np.cos(t**3 + t), np.sin(t**3 + t)], axis=-1))
    even = ArcLength(uneven)
    t = rng.uniform(0.0, 1.0, 30)
    np.testing.assert_allclose(even(t), np.stack([np.cos(2 * t), np.sin(2 * t)], axis=-1), atol=1e-13)
    np.testing.assert_array_equal(even(np.array([0.0, 1.0])), uneven(np.array([0.0, 1.0])))
    assert not even.breaks.size


def test_breaks_go_over_to_fractions_of_the_length():
    line = ArcLength(Polyline([(0, 0), (1, 0), (1, 3)], "pieces"))
    np.testing.assert_allclose(line.breaks, [0.25], atol=1e-15)
    np.testing.assert_allclose(line(line.breaks), [[1.0, 0.0]], atol=1e-14)
    spline = Spline([(0, 0), (1, 1), (3, 0), (4, 2)])
    by_length = ArcLength(spline)
    np.testing.assert_allclose(by_length(by_length.breaks), spline.points[1:-1], atol=1e-13)


def test_other_curves_inside():
    nodal = NodalCurve(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]), 1)
    assert length_table(nodal).length == pytest.approx(2.0, rel=1e-13)
    arc = Arc((0, 0), 2.0, 0.0, 1.0)
    backwards = ArcLength(Reversed(arc))
    np.testing.assert_allclose(backwards(np.array([0.25])), arc(np.array([0.75])), atol=1e-14)


def test_curves_without_a_length():
    with pytest.raises(CurveError, match="no length"):
        length_table(Parametric(lambda t: np.zeros((len(t), 2))))
    with pytest.raises(CurveError, match="not finite"):
        length_table(lambda t: np.full((len(t), 2), np.inf))
    rough = Parametric(lambda t: np.stack([t, np.sin(1 / np.maximum(t, 1e-300))], axis=-1))
    with pytest.raises(CurveError, match="does not settle"):
        length_table(rough)
