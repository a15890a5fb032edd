import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import Listed, element_corners, restrict, reverse

FOUR = Listed((0.0, 0.1, 0.15, 0.8, 1.0))


def test_corners_are_the_listed_ones_to_the_last_bit():
    rng = np.random.default_rng(77)
    positions = (0.0, *np.sort(rng.random(40)).tolist(), 1.0)
    np.testing.assert_array_equal(element_corners(Listed(positions), 41), positions)
    assert Listed(np.array(positions)) == Listed(positions)
    assert hash(Listed(list(positions))) == hash(Listed(positions))


def test_sizes_are_in_the_given_ratio():
    np.testing.assert_allclose(element_corners(Listed.of_sizes((1, 1, 2, 4)), 4), np.array([0, 1, 2, 4, 8]) / 8)
    assert Listed.of_sizes([3]) == Listed((0, 1))


def test_at_lengths_places_corners_by_arc_length(edge):
    shape = edge(3.0)
    grading = Listed.at_lengths(shape, np.array([0.3, 0.5, 2.0]))
    np.testing.assert_allclose(shape.lengths(grading.positions), [0, 0.3, 0.5, 2, 3], atol=1e-15)


def test_reversed_lists():
    assert reverse(reverse(FOUR)) == FOUR
    np.testing.assert_allclose(element_corners(reverse(FOUR), 4), [0, 0.2, 0.85, 0.9, 1], atol=1e-15)


def test_parts_of_lists_are_lists():
    np.testing.assert_allclose(restrict(FOUR, 0.25, 0.75).positions, [0, 0.05 / 0.7, 1])
    back = restrict(reverse(FOUR), 0.25, 0.75)
    np.testing.assert_allclose(element_corners(back, 2), [0, 0.65 / 0.7, 1], atol=1e-15)
    with pytest.raises(GradingError, match=r"from 0 to 0.3 of the listed grading of 4 elements; .* multiples of 1/4"):
        restrict(FOUR, 0.0, 0.3)


@pytest.mark.parametrize("grading", [FOUR, reverse(FOUR)])
def test_another_number_of_elements_is_refused_with_the_edge(grading):
    message = (
        r"edge a–b: the grading lists 4 elements, the edge has 5\. List 6 positions or 5 sizes, or give the edge's "
        r"chain 4 elements\."
    )
    with pytest.raises(GradingError, match=message):
        element_corners(grading, 5, "edge a–b")


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Listed((0.1, 0.5, 1.0)), r"listed grading: the positions are \[0.1, 0.5, 1. \]; expected .* with 0"),
        (lambda: Listed((0.0, 0.5)), "begin with 0 and to end with 1. List every corner"),
        (lambda: Listed(()), "begin with 0 and to end with 1"),
        (lambda: Listed((0.0, 0.5, 0.4, 1.0)), "listed grading: position 2 is 0.4.* after 0.5; expected strictly"),
        (lambda: Listed((0.0, 0.5, 0.5, 1.0)), "position 2 is 0.5 after 0.5"),
        (lambda: Listed((0.0, float("nan"), 1.0)), "positions are .*nan.*; expected a sequence of finite numbers"),
        (lambda: Listed(0.5), "positions are 0.5; expected a sequence of numbers"),
        (lambda: Listed(("a", "b")), "expected a sequence of numbers"),
        (lambda: Listed.of_sizes((1, -1)), r"sizes are \[ 1., -1.\]; expected at least one, all of them positive"),
        (lambda: Listed.of_sizes(()), "expected at least one, all of them positive"),
    ],
)
def test_impossible_lists_are_refused(make, match):
    with pytest.raises(GradingError, match=match):
        make()
