"""Weights of a fluid's load at the point of equilibrium."""

import numpy as np
import pytest

from hofsi.timestepping.second_order import load_weights


@pytest.mark.parametrize("share", [0.5, 1.0 / 1.8, 0.9, 1.0])
@pytest.mark.parametrize("ratio", [0.0, 0.5, 1.0, 2.0])
def test_loads_linear_in_time_are_taken_at_the_point(share, ratio):
    weights = np.array(load_weights(share, ratio))
    times = np.array([1.0, 0.0, -ratio])
    assert weights.sum() == pytest.approx(1.0, abs=1e-15)
    assert weights @ times == pytest.approx(share, abs=1e-15)


@pytest.mark.parametrize("share", [0.5, 1.0 / 1.8, 0.9, 1.0])
def test_with_equal_steps_they_are_an_average_made_twice(share):
    average = np.array([1.0 + share, 1.0 - share]) / 2.0
    np.testing.assert_allclose(load_weights(share, 1.0), np.convolve(average, average), atol=1e-15)
    assert np.dot(load_weights(share, 1.0), [1.0, -1.0, 1.0]) == pytest.approx(share**2)


def test_backward_differences_take_the_last_one():
    assert load_weights(1.0, 1.0) == (1.0, 0.0, 0.0)
