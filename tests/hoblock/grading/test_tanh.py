import math

import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import Tanh, TanhSpacing, reverse

S = np.linspace(0.0, 1.0, 101)


@pytest.mark.parametrize("strength", [0.3, 2.0, 5.0])
def test_the_formulas_of_vinokur(strength):
    one = 1 + np.tanh(strength * (S - 1) / 2) / np.tanh(strength / 2)
    two = (1 + np.tanh(strength * (S - 0.5)) / np.tanh(strength / 2)) / 2
    np.testing.assert_allclose(Tanh(strength)(S), one, atol=1e-14)
    np.testing.assert_allclose(Tanh(strength, "second")(S), 1 - one[::-1], atol=1e-14)
    np.testing.assert_allclose(Tanh(strength, "both")(S), two, atol=1e-14)


@pytest.mark.parametrize("ends", ["first", "second", "both"])
def test_slope_at_dense_ends_and_limit_without_strength(ends):
    slope = 4.0 / math.sinh(4.0)
    h = 1e-6
    if ends != "second":
        assert Tanh(4.0, ends)(np.array(h)) / h == pytest.approx(slope, rel=1e-4)
    if ends != "first":
        assert (1 - Tanh(4.0, ends)(np.array(1 - h))) / h == pytest.approx(slope, rel=1e-4)
    np.testing.assert_allclose(Tanh(1e-7, ends)(S), S, atol=1e-14)
    np.testing.assert_allclose(Tanh(0.0, ends)(S), S, atol=1e-15)


def test_reversed():
    assert reverse(Tanh(2.0, "first")) == Tanh(2.0, "second")
    assert reverse(Tanh(2.0, "both")) == Tanh(2.0, "both")
    assert reverse(TanhSpacing(0.1, 0.2)) == TanhSpacing(0.2, 0.1)
    assert Tanh.spacing(0.1, unit="fraction") == TanhSpacing(0.1, None, "fraction")


@pytest.mark.parametrize("count", [3, 4, 11, 60])
@pytest.mark.parametrize(("first", "second"), [(1e-5, 0.02), (0.3, 0.6), (0.01, 0.01), (0.5, 1e-3), (1e-9, 1e-9)])
def test_sizes_at_both_ends_are_kept_on_edges_of_any_length(edge, heights, first, second, count):
    for length in (1.0, 0.93, 4.0):
        sizes = heights(Tanh.spacing(first, second), edge(length), count)
        assert sizes[0] == pytest.approx(first, abs=1e-14)
        assert sizes[-1] == pytest.approx(second, abs=1e-14)
        assert sizes.sum() == pytest.approx(length, rel=1e-14)
        assert np.all(sizes > 0)


@pytest.mark.parametrize("count", [2, 3, 17, 60])
@pytest.mark.parametrize("size", [1e-6, 0.04, 0.2, 0.9])
def test_size_at_one_end(edge, heights, size, count):
    sizes = heights(Tanh.spacing(size), edge(1.5), count)
    assert sizes[0] == pytest.approx(size, abs=1e-14)
    sizes = heights(Tanh.spacing(None, size), edge(1.5), count)
    assert sizes[-1] == pytest.approx(size, abs=1e-14)
    sizes = heights(Tanh.spacing(size, unit="fraction"), edge(1.5), count)
    assert sizes[0] == pytest.approx(1.5 * size, abs=1e-14)


@pytest.mark.parametrize("count", [5, 40, 160])
@pytest.mark.parametrize("slopes", [(0.2, 0.5), (0.01, 3.0), (1e-3, 1e-3)])
def test_the_sizes_in_between_are_those_of_vinokurs_function(heights, straight, slopes, count):
    a, b = math.sqrt(slopes[1] / slopes[0]), 1.0 / math.sqrt(slopes[0] * slopes[1])
    low, high = 1e-3, 30.0
    for _ in range(80):  # his sinh(δ)/δ = B
        delta = (low + high) / 2
        low, high = (delta, high) if math.sinh(delta) / delta < b else (low, delta)
    u = (1 + np.tanh(delta * (np.arange(count + 1) / count - 0.5)) / math.tanh(delta / 2)) / 2
    sizes = np.diff(u / (a + (1 - a) * u))
    np.testing.assert_allclose(heights(Tanh.spacing(sizes[0], sizes[-1]), straight(), count), sizes, rtol=1e-9)


def test_equal_sizes_are_met_by_the_uniform_grading(heights, straight):
    np.testing.assert_allclose(heights(Tanh.spacing(0.1, 0.1), straight(), 10), 0.1, rtol=1e-7)
    np.testing.assert_allclose(heights(Tanh.spacing(0.1), straight(), 10), 0.1, rtol=1e-7)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Tanh(-1.0), r"tanh grading: strength is -1; expected a number in \[0, 30\]"),
        (lambda: Tanh(float("nan")), "tanh grading: strength is nan"),
        (lambda: Tanh(1.0, "left"), "tanh grading: ends is 'left'"),
        (lambda: TanhSpacing(), "tanh spacing: neither first nor second is given; expected the size of an end"),
        (lambda: TanhSpacing(0.1, unit="m"), "tanh spacing: unit is 'm'; expected 'length' or 'fraction'"),
        (lambda: TanhSpacing(0.0), "tanh spacing: first is 0; expected a positive length"),
        (lambda: TanhSpacing(0.1, 1.0, "fraction"), r"tanh spacing: second is 1; expected a fraction in \(0, 1\)"),
    ],
)
def test_impossible_parameters_are_refused(make, match):
    with pytest.raises(GradingError, match=match):
        make()


@pytest.mark.parametrize(
    ("grading", "count", "match"),
    [
        (TanhSpacing(0.1), 1, "tanh spacing: 1 element with end sizes 0.1; take at least 2 elements"),
        (TanhSpacing(0.1, 0.2), 2, "tanh spacing: 2 elements with end sizes 0.1 and 0.2; take at least 3 elements"),
        (TanhSpacing(1.5, 0.5), 5, "sizes 1.5 and 0.5 leave nothing of an edge of length 2 to the other elements"),
        (TanhSpacing(0.5, 0.5, "fraction"), 5, "0.5 and 0.5 leave nothing of an edge to the other elements"),
        (TanhSpacing(1e-300), 5, "tanh spacing: an end size is 5e-301 of the edge; too small"),
    ],
)
def test_sizes_that_do_not_fit(straight, grading, count, match):
    with pytest.raises(GradingError, match=match):
        grading.resolved(straight(2.0), count)
