import re

import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import BoundaryLayer, reverse

LENGTHS = (1.0, 0.87, 2.5)


@pytest.mark.parametrize("ends", ["first", "second", "both"])
@pytest.mark.parametrize("count", [56, 57, 80])
@pytest.mark.parametrize(("growth", "thickness"), [(None, None), (1.35, None), (1.35, 0.03), (1.0, 0.002)])
def test_first_height_is_kept_on_edges_of_any_length(edge, heights, growth, thickness, count, ends):
    for length in LENGTHS:
        found = heights(BoundaryLayer(2e-4, growth, thickness, ends), edge(length), count)
        assert found.sum() == pytest.approx(length, rel=1e-14)
        assert np.all(found > 0)
        if ends != "second":
            assert found[0] == pytest.approx(2e-4, abs=1e-15 * length)
        if ends != "first":
            assert found[-1] == pytest.approx(2e-4, abs=1e-15 * length)
        if ends == "both":
            np.testing.assert_allclose(found, found[::-1], rtol=0, atol=2e-15 * length)


@pytest.mark.parametrize("first", [1e-3, 0.05, 0.1, 0.3, 0.7])
@pytest.mark.parametrize("count", [2, 3, 10, 31])
def test_without_growth_one_ratio_fills_the_edge(heights, straight, first, count):
    found = heights(BoundaryLayer(first), straight(), count)
    large = found[found > 1e-6]
    np.testing.assert_allclose(large[1:] / large[:-1], (found[1] / found[0]), rtol=1e-8)
    assert (found[1] < found[0]) == (first > 1 / count)


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("count", [45, 60, 200])
def test_growth_ends_in_equal_elements_no_larger_than_the_next_height(heights, straight, length, count):
    first, growth = 1e-3, 1.18
    found = heights(BoundaryLayer(first, growth), straight(length), count)
    series = first * growth ** np.arange(count)
    layer = int(np.sum(np.abs(found / series - 1) < 1e-9))
    np.testing.assert_allclose(found[:layer], series[:layer], rtol=1e-11)
    np.testing.assert_allclose(found[layer:], found[-1], rtol=1e-9)
    assert series[layer - 1] * (1 - 1e-12) <= found[-1] <= series[layer] * (1 + 1e-12)
    # The smallest such number: one element of the layer less, and the rest would be larger than the next height.
    assert (length - series[: layer - 1].sum()) / (count - layer + 1) > series[layer - 1]


@pytest.mark.parametrize("count", [28, 29])
def test_growth_at_both_ends(heights, straight, count):
    found = heights(BoundaryLayer(1e-3, 1.5, ends="both"), straight(0.9), count)
    ratios = found[1:] / found[:-1]
    assert np.all(ratios[: (count - 1) // 2] >= 1 - 1e-12)
    assert np.all(ratios <= 1.5 + 1e-9)
    assert np.all(ratios >= 1 / 1.5 - 1e-9)
    np.testing.assert_allclose(ratios[:8], 1.5, rtol=1e-9)


def test_a_first_height_above_the_even_one_shrinks(heights, straight):
    found = heights(BoundaryLayer(0.15, 1.2), straight(), 9)
    assert found[0] == 0.15
    ratios = found[1:] / found[:-1]
    assert np.all(ratios <= 1 + 1e-12)
    assert np.all(ratios >= 1 / 1.2 - 1e-12)
    np.testing.assert_allclose(found[3:], found[-1], rtol=1e-12)


@pytest.mark.parametrize("ends", ["first", "both"])
def test_thickness_is_reached_by_as_few_elements_as_can_be(heights, straight, ends):
    first, growth, thickness = 1e-3, 1.3, 0.05
    found = heights(BoundaryLayer(first, growth, thickness, ends), straight(), 34)
    ratios = found[1:] / found[:-1]
    layer = 1 + int(np.argmin(np.abs(ratios - growth) < 1e-9))
    assert found[: layer - 1].sum() < thickness <= found[:layer].sum()
    outside = ratios[layer - 1 : 16 if ends == "both" else None]
    np.testing.assert_allclose(outside, outside[0], rtol=1e-8)
    assert abs(outside[0] - growth) > 1e-3


def test_thickness_that_a_whole_number_of_elements_makes(heights, straight):
    found = heights(BoundaryLayer(0.01, 1.0, 0.07), straight(), 20)
    np.testing.assert_allclose(found[:7], 0.01, rtol=1e-12)
    assert found[7] > 0.0101


@pytest.mark.parametrize("ends", ["first", "second", "both"])
@pytest.mark.parametrize("options", [{}, {"growth": 1.3}, {"growth": 1.3, "thickness": 0.1}])
@pytest.mark.parametrize("length", [0.31, 1.0, 20.0])
def test_least_count(straight, options, length, ends):
    layer = BoundaryLayer(1e-3, **options, ends=ends)
    least = layer.least_count(length)
    layer.resolved(straight(length), least)
    with pytest.raises(GradingError, match="take at least"):
        layer.resolved(straight(length), least - 1)


def test_reversed_layers():
    assert reverse(BoundaryLayer(0.1, 1.2, 0.3, "first")) == BoundaryLayer(0.1, 1.2, 0.3, "second")
    assert reverse(BoundaryLayer(0.1, ends="both")) == BoundaryLayer(0.1, ends="both")


# --- what does not fit ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ends", ["first", "second", "both"])
@pytest.mark.parametrize("count", [8, 9, 30, 41])
@pytest.mark.parametrize("growth", [1.02, 1.2])
def test_each_way_out_that_an_error_offers_is_one(straight, count, ends, growth):
    shape = straight(1.0)
    grading = BoundaryLayer(1e-4, growth, ends=ends)
    with pytest.raises(
        GradingError, match=r"elements from 0\.0001 growing by .* reach .* of 1; take at least"
    ) as caught:
        grading.resolved(shape, count)
    pattern = r"at least (\d+) elements, a growth of (\S+) or a first height of (\S+)\."
    needed, other, height = re.search(pattern, str(caught.value)).groups()
    grading.resolved(shape, int(needed))
    with pytest.raises(GradingError, match="take at least"):
        grading.resolved(shape, int(needed) - 1)
    BoundaryLayer(1e-4, float(other), ends=ends).resolved(shape, count)
    BoundaryLayer(float(height), growth, ends=ends).resolved(shape, count)


@pytest.mark.parametrize("ends", ["first", "both"])
def test_each_way_out_of_too_large_a_height_is_one(straight, ends):
    grading = BoundaryLayer(0.4, 1.2, ends=ends)
    with pytest.raises(
        GradingError, match=r"11 elements from 0.4 shrinking by 1.2 reach .*, beyond the edge's 1;"
    ) as c:
        grading.resolved(straight(), 11)
    other, height = re.search(r"a growth of (\S+) or a first height of (\S+)\.", str(c.value)).groups()
    BoundaryLayer(0.4, float(other), ends=ends).resolved(straight(), 11)
    BoundaryLayer(float(height), 1.2, ends=ends).resolved(straight(), 11)


@pytest.mark.parametrize(
    ("grading", "count", "match"),
    [
        (
            BoundaryLayer(1e-4, 1.2),
            9,
            r"9 elements from 0\.0001 growing by 1\.2 reach 0\.00208 of 1; take at least 42 el",
        ),
        (BoundaryLayer(0.4), 1, "1 element of first height 0.4 on an edge of length 1; take at least 2 elements, or a"),
        (
            BoundaryLayer(0.4, 1.2, ends="both"),
            2,
            "2 elements of first height 0.4 .*; take at least 3 .* height of 0.5",
        ),
        (BoundaryLayer(1.0), 4, "the first height 1 does not fit into the edge's length 1. Take a smaller one"),
        (BoundaryLayer(0.5, ends="both"), 4, "the first height 0.5 does not fit twice into the edge's length 1"),
        (
            BoundaryLayer(1e-3, 1.2, 0.9),
            9,
            "29 elements from 0.001 .* thickness of 0.9, the edge has 9 elements in all; t",
        ),
        (BoundaryLayer(1e-3, 1.2, 0.1, "both"), 9, "9 elements in all for two such layers; take at least 35 elements"),
        (
            BoundaryLayer(0.4, 1.2, 0.9),
            9,
            "3 elements from 0.4 growing by 1.2 take 1.456 of the edge's 1; take a smaller",
        ),
        (
            BoundaryLayer(0.2, 1.2, 0.5, "both"),
            9,
            "3 elements from 0.2 growing by 1.2 at each end take 1.456 of the edge",
        ),
    ],
)
def test_layers_that_do_not_fit(straight, grading, count, match):
    with pytest.raises(GradingError, match=f"^boundary layer: .*{match}"):
        grading.resolved(straight(), count)


def test_elements_that_rounding_swallows(edge):
    with pytest.raises(
        GradingError, match=r"element \d+ of 60 would have the length .*which rounding swallows\. Take la"
    ):
        BoundaryLayer(0.95).resolved(edge(), 60)
    with pytest.raises(GradingError, match=r"element 4 of 5 would have the length 0 on an edge of length 1"):
        BoundaryLayer(1e-20, ends="second").resolved(edge(), 5)


def test_a_single_element_of_the_edges_length(straight):
    assert BoundaryLayer(0.7, 1.2).resolved(straight(0.7), 1).positions == (0.0, 1.0)
    assert BoundaryLayer(0.35, ends="both").resolved(straight(0.7), 2).positions == (0.0, 0.5, 1.0)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: BoundaryLayer("1e-3"), "boundary layer: first_height is '1e-3'; expected a number"),
        (lambda: BoundaryLayer(None), "boundary layer: first_height is None; expected a number"),
        (lambda: BoundaryLayer(0.1, growth="1.2"), r"boundary layer: growth is '1\.2'; expected a number"),
        (lambda: BoundaryLayer(0.0), "boundary layer: first height is 0; expected a positive length"),
        (lambda: BoundaryLayer(float("nan")), "boundary layer: first height is nan"),
        (
            lambda: BoundaryLayer(0.1, 1.0),
            r"boundary layer: growth is 1; expected a number above 1 \(or 1 with a thick",
        ),
        (lambda: BoundaryLayer(0.1, 0.8, 0.2), "boundary layer: growth is 0.8; .* Heights grow away from the wall"),
        (lambda: BoundaryLayer(0.1, thickness=0.2), "boundary layer: a thickness without a growth; give the growth in"),
        (lambda: BoundaryLayer(0.1, 1.2, -0.2), "boundary layer: thickness is -0.2; expected a positive length"),
        (lambda: BoundaryLayer(0.1, ends="top"), "boundary layer: ends is 'top'; expected 'first', 'second' or 'both'"),
    ],
)
def test_impossible_parameters_are_refused(make, match):
    with pytest.raises(GradingError, match=match):
        make()
