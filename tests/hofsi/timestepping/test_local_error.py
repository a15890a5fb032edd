"""Estimates of what one step adds to the error."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi.timestepping.local_error import LocalErrors, error_share
from hofsi.timestepping.schemes import bdf_weights, extrapolation_weights

STEPS = ([0.1, 0.1, 0.1], [0.2, 0.1, 0.1], [0.05, 0.1, 0.2], [0.1, 0.05, 0.1])


def bdf2(f, rate, steps):
    """One step from exact values of y' = rate, which depends on the time alone."""
    ends = -np.cumsum(steps)
    c = bdf_weights(steps[:2])
    return (rate(0.0) - c[1:] @ f(ends[:2])) / c[0]


@pytest.mark.parametrize("steps", STEPS)
def test_share_is_exact_where_the_third_derivative_is_constant(steps):
    made = bdf2(lambda t: 2.0 * t**3 - t, lambda t: 6.0 * t**2 - 1.0, steps)
    expected = extrapolation_weights(steps, 2) @ (2.0 * (ends := -np.cumsum(steps)) ** 3 - ends)
    assert error_share(steps) * (made - expected) == pytest.approx(made, rel=1e-10)  # the exact value at 0 is 0


def test_equal_steps_have_the_classical_share():
    assert error_share([0.3, 0.3, 0.3]) == pytest.approx(2.0 / 11.0)


@pytest.mark.parametrize("steps", STEPS)
def test_estimate_is_near_the_error_of_a_smooth_function(steps):
    """Relative to the largest value, and of third order."""
    found = []
    for factor in (1.0, 0.5):
        h = [factor * step for step in steps]
        errors = LocalErrors({"fluid": np.array([0.5, 0.5])})
        made = bdf2(lambda t: np.exp(2.0 * t), lambda t: 2.0 * np.exp(2.0 * t), h)
        for time in (-np.cumsum(h))[::-1]:
            errors.keep({"fluid": np.full((2, 2), np.exp(2.0 * time))})
        estimate = errors.estimate({"fluid": np.full((2, 2), made)}, h)
        assert estimate == pytest.approx((made - 1.0) / made, rel=0.5)
        found.append(estimate)
    assert found[0] / found[1] == pytest.approx(8.0, rel=0.4)


def test_there_is_no_estimate_before_the_fourth_step_and_of_nothing():
    errors = LocalErrors({"solid": np.ones(3)})
    steps = [0.1] * 4
    for step in range(5):
        found = errors.estimate({"solid": np.zeros((3, 2))}, steps)
        assert found == (None if step < 3 else 0.0)
        errors.keep({"solid": np.zeros((3, 2))})
    assert LocalErrors({}).estimate({}, steps) is None


def test_the_worst_field_counts():
    errors = LocalErrors({"fluid": np.ones(1), "solid": np.ones(1)})
    for value in (1.0, 1.0, 1.0):
        errors.keep({"fluid": np.full((1, 2), value), "solid": np.full((1, 2), 1e-3 * value)})
    found = errors.estimate({"fluid": np.full((1, 2), 1.01), "solid": np.full((1, 2), 1.1e-3)}, [0.1] * 4)
    assert found == pytest.approx(2.0 / 11.0 * 0.1 / 1.1)


def test_what_is_remembered_can_be_taken_back():
    errors, others = (LocalErrors({"fluid": np.ones(1)}) for _ in range(2))
    for value in (1.0, 3.0, 2.0):
        errors.keep({"fluid": np.full((1, 2), value)})
    memory = errors.memory()
    errors.keep({"fluid": np.full((1, 2), 9.0)})  # which the memory does not notice
    others.recall(memory)
    found = others.estimate({"fluid": np.full((1, 2), 1.0)}, [0.1] * 4)
    assert found == pytest.approx(2.0 / 11.0 * (1.0 - (3.0 * 2.0 - 3.0 * 3.0 + 1.0)) / 3.0)
