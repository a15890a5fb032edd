import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import Cubic, Exponential, Quadratic, Reversed, Uniform, element_corners, node_parameters
from hoblock.reference import gauss_lobatto

S = np.linspace(0.0, 1.0, 101)
ALL = [
    Uniform(),
    Quadratic(0.7),
    Quadratic(-0.95),
    Cubic(0.0),
    Cubic(0.9),
    Exponential(3.0),
    Exponential(-3.0),
    Exponential(0.0),
    Exponential(50.0),
    Reversed(Exponential(2.0)),
]


@pytest.mark.parametrize("grading", ALL, ids=str)
def test_maps_the_unit_interval_onto_itself_increasingly(grading):
    r = grading(S)
    assert (r[0], r[-1]) == pytest.approx((0.0, 1.0), abs=1e-15)
    assert np.all(np.diff(r) > 0)
    assert hash(grading) == hash(type(grading)(**vars(grading)))


def test_quadratic_is_the_papers_function_and_dense_at_the_first_end_for_positive_m():
    r = 2 * S - 1
    np.testing.assert_allclose(2 * Quadratic(0.6)(S) - 1, r + 0.6 * (r**2 - 1) / 2, atol=1e-15)
    sizes = np.diff(Quadratic(0.6)(S))
    assert np.all(np.diff(sizes) > 0)
    np.testing.assert_allclose(Quadratic(-0.6)(S), Reversed(Quadratic(0.6))(S), atol=1e-15)


def test_cubic_is_symmetric_and_dense_at_both_ends():
    r = Cubic(0.8)(S)
    np.testing.assert_allclose(r, 1 - r[::-1], atol=1e-15)
    np.testing.assert_allclose(2 * r - 1, (1 + 0.4) * (2 * S - 1) - 0.4 * (2 * S - 1) ** 3, atol=1e-15)
    assert np.diff(r)[0] < 0.5 * np.diff(r)[50]
    np.testing.assert_allclose(Cubic(0.0)(S), S, atol=1e-15)


@pytest.mark.parametrize("a", [1.8, -1.8, 1e-9, 30.0])
def test_exponential_sizes_grow_by_a_constant_ratio(a):
    sizes = np.diff(element_corners(Exponential(a), 8))
    np.testing.assert_allclose(sizes[1:] / sizes[:-1], np.exp(a / 8), rtol=1e-7)


def test_exponential_is_continuous_where_its_formula_changes():
    for a in (0.999e-8, 1.001e-8, -1.001e-8):
        np.testing.assert_allclose(Exponential(a)(S), S + a * S * (S - 1) / 2, rtol=0, atol=3e-16)


def test_reversed_twice_is_the_grading():
    np.testing.assert_allclose(Reversed(Reversed(Exponential(2.0)))(S), Exponential(2.0)(S), atol=1e-15)


def test_element_corners_are_exact_at_the_ends():
    corners = element_corners(Exponential(1.3), 7)
    assert corners.shape == (8,)
    assert (corners[0], corners[-1]) == (0.0, 1.0)
    assert np.array_equal(element_corners(Uniform(), 4), [0, 0.25, 0.5, 0.75, 1])


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Quadratic(1.0), r"quadratic grading: m is 1; expected a number in \(-1, 1\)"),
        (lambda: Quadratic(float("nan")), "quadratic grading: m is nan"),
        (lambda: Cubic(-0.1), r"cubic grading: m is -0.1; expected a number in \[0, 1\)"),
        (lambda: Cubic(1.0), "cubic grading: m is 1"),
        (lambda: Exponential(51.0), r"exponential grading: a is 51; expected a number in \[-50, 50\]"),
        (lambda: Exponential(float("nan")), "exponential grading: a is nan"),
    ],
)
def test_impossible_parameters_are_refused(make, match):
    with pytest.raises(GradingError, match=match):
        make()


def test_a_map_that_moves_the_ends_is_refused():
    with pytest.raises(GradingError, match=r"edge a–b: .* maps 0 and 1 to 0 and 0.5; must keep both"):
        element_corners(lambda s: 0.5 * s, 3, "edge a–b")


@pytest.mark.parametrize(
    "grading",
    [lambda s: s + 0.3 * np.sin(2 * np.pi * s), Exponential(-50.0), lambda s: np.where((s > 0) & (s < 1), np.nan, s)],
)
def test_a_map_that_is_not_increasing_is_refused(grading):
    with pytest.raises(GradingError, match=r"is not strictly increasing: corner .* Weaken the grading"):
        element_corners(grading, 200)


def test_node_parameters_scale_the_reference_nodes_to_graded_elements():
    t = node_parameters(Exponential(2.0), 3, 4)
    corners = element_corners(Exponential(2.0), 3)
    np.testing.assert_array_equal(t[::4], corners)
    for k in range(3):
        inside = corners[k] + (gauss_lobatto(4) + 1) / 2 * (corners[k + 1] - corners[k])
        np.testing.assert_allclose(t[4 * k : 4 * k + 5], inside, atol=1e-15)
