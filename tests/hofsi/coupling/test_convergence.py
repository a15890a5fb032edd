"""Relative residuals of displacement and force."""

import numpy as np
import pytest

from hofsi.coupling.convergence import ConvergenceTest


def test_residuals_are_relative_to_the_step():
    test = ConvergenceTest(1e-6)
    test.begin_step(np.array([1.0, 0.0]), np.array([10.0, 0.0]))
    first = test.residuals(np.array([1.5, 0.0]), np.array([0.05, 0.0]), np.array([12.0, 0.0]))
    assert first.displacement == pytest.approx(0.1)
    assert first.force == np.inf  # nothing to compare the first force with
    second = test.residuals(np.array([1.5, 0.0]), np.array([0.005, 0.0]), np.array([12.0, 0.5]))
    assert second.displacement == pytest.approx(0.01)
    assert second.force == pytest.approx(0.5 / np.hypot(2.0, 0.5))
    assert second.largest == second.force


def test_a_step_without_change_is_measured_against_the_run():
    test = ConvergenceTest(1e-6)
    test.begin_step(0.0, 0.0)
    test.residuals(np.array([2.0]), np.array([0.0]), np.array([4.0]))
    test.begin_step(np.array([2.0]), np.array([4.0]))
    test.residuals(np.array([2.0]), np.array([1e-9]), np.array([4.0]))
    last = test.residuals(np.array([2.0]), np.array([1e-9]), np.array([4.0 + 1e-9]))
    assert last.displacement == pytest.approx(1e-9 / 2e-4)
    assert last.force == pytest.approx(1e-9 / 4e-4, rel=1e-4)


def test_a_problem_at_rest_has_converged_at_once():
    test = ConvergenceTest(1e-6)
    test.begin_step(np.zeros(3), np.zeros(3))
    assert test.residuals(np.zeros(3), np.zeros(3), np.zeros(3)).largest == 0.0
