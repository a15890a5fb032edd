import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import (
    Cosine,
    Cubic,
    Exponential,
    Quadratic,
    Reversed,
    Tanh,
    Uniform,
    element_corners,
    node_parameters,
)
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
    Tanh(30.0, "both"),
    Tanh(7.0, "second"),
    Cosine("second"),
]


@pytest.mark.parametrize("grading", ALL, ids=str)
def test_maps_the_unit_interval_onto_itself_increasingly(grading):
    r = grading(S)
    assert (r[0], r[-1]) == pytest.approx((0.0, 1.0), abs=1e-15)
    assert np.all(np.diff(r) > 0)
    assert hash(grading) == hash(type(grading)(**vars(grading)))


def test_element_corners_are_exact_at_the_ends():
    corners = element_corners(Exponential(1.3), 7)
    assert corners.shape == (8,)
    assert (corners[0], corners[-1]) == (0.0, 1.0)
    assert np.array_equal(element_corners(Uniform(), 4), [0, 0.25, 0.5, 0.75, 1])


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
