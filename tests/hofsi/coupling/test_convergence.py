"""Relative residuals of displacement and force."""

import numpy as np
import pytest

from hofsi.coupling.convergence import ConvergenceTest, Residuals


def test_residuals_are_relative_to_the_step():
    test = ConvergenceTest(1e-6, 1e-6)
    test.begin_step(np.array([1.0, 0.0]), np.array([10.0, 0.0]))
    first = test.residuals(np.array([1.5, 0.0]), np.array([0.05, 0.0]), np.array([12.0, 0.0]))
    assert first.displacement == pytest.approx(0.1)
    assert first.force == np.inf  # nothing to compare the first force with
    second = test.residuals(np.array([1.5, 0.0]), np.array([0.025, 0.0]), np.array([12.0, 0.5]))
    assert second.displacement == pytest.approx(0.05)
    assert second.force == pytest.approx(0.5 / np.hypot(2.0, 0.5))
    assert second.largest == second.force


def test_a_step_without_change_is_measured_against_the_run():
    test = ConvergenceTest(1e-6, 1e-6)
    test.begin_step(0.0, 0.0)
    test.residuals(np.array([2.0]), np.array([0.0]), np.array([4.0]))
    test.begin_step(np.array([2.0]), np.array([4.0]))
    test.residuals(np.array([2.0]), np.array([1e-9]), np.array([4.0]))
    last = test.residuals(np.array([2.0]), np.array([1e-9]), np.array([4.0 + 1e-9]))
    assert last.displacement == pytest.approx(1e-9 / 2e-4)
    assert last.force == pytest.approx(1e-9 / 4e-4, rel=1e-4)


def test_a_problem_at_rest_has_converged_at_once():
    test = ConvergenceTest(1e-6, 1e-6)
    test.begin_step(np.zeros(3), np.zeros(3))
    assert test.residuals(np.zeros(3), np.zeros(3), np.zeros(3)).largest == 0.0


def test_the_force_residual_foresees_the_next_iteration():
    """A force proportional to the displacement, whose residual falls by a factor of 100 in each iteration."""
    test = ConvergenceTest(1e-6, 1e-6)
    test.begin_step(0.0, 0.0)
    forces, residuals = [], []
    for k in range(6):
        off = 100.0**-k
        forces.append(50.0 + 7.0 * off)
        residuals.append(test.residuals(np.array([2.0]), np.array([0.01 * off]), np.array([forces[-1]])).force)
    next_changes = np.abs(np.diff(forces)) / forces[:-1]
    ratio = np.array(residuals[1:5]) / next_changes[1:]
    assert (ratio > 1.0).all()  # never less than what comes
    assert (ratio < 5.0).all()  # the change before it is 100 times as large


def test_a_force_that_has_stopped_changing_has_converged():
    test = ConvergenceTest(1e-6, 1e-6)
    test.begin_step(0.0, 0.0)
    for off, force in ((1e-2, 5.0), (1e-4, 4.0)):
        test.residuals(np.array([2.0]), np.array([off]), np.array([force]))
    assert test.residuals(np.array([2.0]), np.array([1e-3]), np.array([4.0])).force == 0.0


def test_the_largest_values_of_a_run_can_be_taken_back():
    one, two = ConvergenceTest(1e-6, 1e-6), ConvergenceTest(1e-6, 1e-6)
    one.begin_step(0.0, 0.0)
    one.residuals(np.array([2.0]), np.array([0.0]), np.array([4.0]))
    assert one.largest == (2.0, 4.0)
    two.recall(one.largest)
    for test in (one, two):
        test.begin_step(np.array([2.0]), np.array([4.0]))
        test.residuals(np.array([2.0]), np.array([1e-9]), np.array([4.0]))
    values = np.array([2.0]), np.array([1e-9]), np.array([4.0 + 1e-9])
    assert one.residuals(*values) == two.residuals(*values)


def test_each_residual_has_a_tolerance_of_its_own():
    test = ConvergenceTest(1e-6, 1e-3)
    assert test.excess(Residuals(5e-7, 2e-4)) == pytest.approx(0.5)
    assert test.excess(Residuals(5e-7, 2e-3)) == pytest.approx(2.0)
    assert test.excess(Residuals(3e-6, 2e-4)) == pytest.approx(3.0)
    assert test.excess(Residuals(0.0, np.inf)) == np.inf
