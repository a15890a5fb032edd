"""Roots of many functions at once."""

import numpy as np
import pytest

from hoblock.curves.roots import bracketed_newton

TOLERANCE = 1e-15


def solve(function, derivative, low, high, start=None):
    calls = 0

    def evaluate(active, s):
        nonlocal calls
        calls += 1
        return function(active, s), derivative(active, s)

    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    root = bracketed_newton(evaluate, low, high, 0.5 * (low + high) if start is None else np.array(start), TOLERANCE)
    return root, calls


def test_many_simple_roots_take_few_calls():
    targets = np.linspace(0.1, 3.9, 400)
    root, calls = solve(
        lambda k, s: s**3 - targets[k] ** 3, lambda k, s: 3 * s**2, np.zeros(400), np.full(400, 4.0), targets + 0.01
    )
    np.testing.assert_allclose(root, targets, rtol=1e-15)
    assert calls <= 7


@pytest.mark.parametrize("slope", [lambda k, s: 0.0 * s, lambda k, s: np.full_like(s, np.nan), lambda k, s: -1e3 * s])
def test_useless_derivatives_leave_bisection(slope):
    root, calls = solve(lambda k, s: np.tanh(s - 0.3), slope, [-1.0, 0.0], [2.0, 0.9])
    np.testing.assert_allclose(root, 0.3, atol=1e-14)
    assert calls < 70


def test_newton_alone_would_run_away_from_this_start():
    root, _ = solve(lambda k, s: np.arctan(s), lambda k, s: 1 / (1 + s**2), [-50.0], [80.0], [60.0])
    np.testing.assert_allclose(root, 0.0, atol=1e-15)


def test_multiple_roots_and_roots_on_the_bracket_are_found():
    root, _ = solve(lambda k, s: (s - 0.25) ** 3, lambda k, s: 3 * (s - 0.25) ** 2, [0.0], [1.0])
    np.testing.assert_allclose(root, 0.25, atol=1e-14)
    root, _ = solve(lambda k, s: s, lambda k, s: np.ones_like(s), [0.0, -1.0], [1.0, 0.0])
    np.testing.assert_allclose(root, 0.0, atol=1e-15)


def test_no_function_at_all():
    assert solve(lambda k, s: s, lambda k, s: s, [], [])[0].shape == (0,)
