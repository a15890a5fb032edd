"""Extrapolation of the interface displacement."""

import numpy as np
import pytest

from hofsi.coupling.predictors import predict


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_polynomials_of_the_order_are_predicted_exactly(order):
    steps = [0.1, 0.3, 0.2, 0.15]
    times = -np.cumsum([0.0, *steps[1:]])  # of the known values, the newest at 0
    c = np.random.default_rng(5).normal(size=(order + 1, 7, 2))

    def value(t):
        return sum(c[k] * t**k for k in range(order + 1))

    got = predict([value(t) for t in times], steps, order)
    np.testing.assert_allclose(got, value(steps[0]), atol=1e-13)


def test_a_short_history_lowers_the_order():
    a, b = np.array([[1.0, 2.0]]), np.array([[0.5, 1.0]])
    np.testing.assert_array_equal(predict([a], [0.1], 3), a)
    np.testing.assert_allclose(predict([a, b], [0.1, 0.1], 3), 2 * a - b)
    np.testing.assert_array_equal(predict([a, b], [0.1], 3), a)


def test_a_known_velocity_makes_the_first_prediction_linear():
    a, b, v = np.array([[1.0, 2.0]]), np.array([[0.5, 1.0]]), np.array([[10.0, -20.0]])
    np.testing.assert_allclose(predict([a], [0.1], 2, v), [[2.0, 0.0]])
    np.testing.assert_array_equal(predict([a], [0.1], 0, v), a)
    np.testing.assert_allclose(predict([a, b], [0.1, 0.1], 1, v), 2 * a - b)
