"""Constant and Aitken relaxation."""

import numpy as np
import pytest

from hofsi.coupling.relaxation import Aitken, AitkenMemory, ConstantRelaxation


def iterate(accelerator, image, d, count):
    accelerator.begin_step()
    for _ in range(count):
        d = accelerator.next(d, image(d) - d)
    accelerator.end_step()
    return d


def test_constant_relaxation_is_a_weighted_mean():
    d, r = np.array([1.0, 2.0]), np.array([0.5, -1.0])
    np.testing.assert_allclose(ConstantRelaxation(0.25).next(d, r), [1.125, 1.75])


@pytest.mark.parametrize("slope", [-3.0, -0.9, 0.5])
def test_aitken_solves_a_scalar_linear_problem_in_two_steps(slope):
    d = iterate(Aitken(0.3), lambda d: slope * d + 2.0, np.array([0.0]), 2)
    np.testing.assert_allclose(d, 2.0 / (1.0 - slope), rtol=1e-12)


def test_aitken_begins_a_step_with_at_most_the_first_factor():
    aitken = Aitken(0.3)
    iterate(aitken, lambda d: 0.9 * d + 1.0, np.array([0.0]), 4)  # the factor has grown to 10
    aitken.begin_step()
    np.testing.assert_allclose(aitken.next(np.array([0.0]), np.array([1.0])), 0.3)


def test_aitken_converges_where_plain_iteration_diverges():
    A = np.diag([-2.5, -1.5, 0.2])
    b = np.array([1.0, -2.0, 0.5])
    exact = np.linalg.solve(np.eye(3) - A, b)
    d = iterate(Aitken(0.2), lambda d: A @ d + b, np.zeros(3), 60)
    np.testing.assert_allclose(d, exact, atol=1e-8)


def test_aitken_that_forgets_begins_with_the_first_factor():
    aitken = Aitken(0.3)
    iterate(aitken, lambda d: -9.0 * d + 1.0, np.array([0.0]), 4)  # the factor has fallen to a tenth
    aitken.forget()
    aitken.begin_step()
    np.testing.assert_allclose(aitken.next(np.array([0.0]), np.array([1.0])), 0.3)


def test_aitken_goes_on_with_the_factor_of_another():
    one, two = Aitken(0.3), Aitken(0.3)
    iterate(one, lambda d: -3.0 * d + 2.0, np.array([0.0]), 4)
    two.recall(one.memory())
    d, r = np.array([1.0]), np.array([2.0])
    one.begin_step()
    two.begin_step()
    np.testing.assert_array_equal(one.next(d, r), two.next(d, r))
    assert two.next(d, r) != Aitken(0.3).next(d, r)
    two.recall(None)
    assert two.memory().factor == 0.3


def test_constant_relaxation_remembers_nothing():
    relaxation = ConstantRelaxation(0.25)
    assert relaxation.memory() is None
    relaxation.recall(AitkenMemory(0.7))
    np.testing.assert_allclose(relaxation.next(np.zeros(1), np.ones(1)), 0.25)
