from __future__ import annotations

import numpy as np
import pytest

from hofsi.timestepping.schemes import bdf_weights, extrapolation_weights


def times_before(steps):
    return -np.concatenate(([0.0], np.cumsum(steps)))


def test_equal_steps_give_the_classical_weights():
    np.testing.assert_allclose(bdf_weights([0.1]), [10.0, -10.0], rtol=1e-14)
    np.testing.assert_allclose(bdf_weights([0.1, 0.1]), [15.0, -20.0, 5.0], rtol=1e-14)
    np.testing.assert_allclose(extrapolation_weights([0.2, 0.2], 1), [2.0, -1.0], rtol=1e-14)
    np.testing.assert_allclose(extrapolation_weights([0.2] * 3, 2), [3.0, -3.0, 1.0], rtol=1e-13)


@pytest.mark.parametrize("steps", [[0.3], [0.3, 0.1], [1e-5, 3e-5], [2.0, 0.7]])
def test_derivative_is_exact_for_polynomials_of_the_order(steps):
    weights, t = bdf_weights(steps), times_before(steps) / steps[0]
    for degree in range(len(steps) + 1):
        expected = 1.0 / steps[0] if degree == 1 else 0.0
        assert weights @ t**degree == pytest.approx(expected, abs=1e-12 / steps[0])
    assert abs(weights @ t ** (len(steps) + 1)) > 1e-3


@pytest.mark.parametrize("steps", [[0.3], [0.3, 0.1], [0.3, 0.1, 0.2], [1.0, 2.0, 0.5, 1.5]])
def test_extrapolation_is_exact_for_polynomials_of_the_order(steps):
    order = len(steps) - 1
    weights, t = extrapolation_weights(steps, order), times_before(steps)[1:]
    for degree in range(order + 1):
        assert weights @ t**degree == pytest.approx(0.0**degree, abs=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_observed_order_of_the_derivative(order):
    errors = []
    for dt in (0.02, 0.01):
        steps = [dt, 1.5 * dt][:order]
        errors.append(abs(bdf_weights(steps) @ np.exp(times_before(steps)) - 1.0))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.05)


def test_extra_steps_are_ignored_and_missing_ones_reported():
    np.testing.assert_array_equal(extrapolation_weights([0.1, 0.2, 9.0], 1), extrapolation_weights([0.1, 0.2], 1))
    with pytest.raises(ValueError, match="order 2 needs 3 steps; got 2"):
        extrapolation_weights([0.1, 0.1], 2)
