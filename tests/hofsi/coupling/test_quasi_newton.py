"""IQN-ILS with reuse and the QR2 filter."""

import numpy as np

from hofsi.coupling.quasi_newton import InverseLeastSquares
from hofsi.coupling.relaxation import AitkenMemory


def problem(size, seed):
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(size, size))
    A *= 3.0 / np.abs(np.linalg.eigvals(A)).max()  # plain iteration diverges
    b = rng.normal(size=size)
    return A, b, np.linalg.solve(np.eye(size) - A, b)


def iterations(accelerator, A, b, exact, limit=50):
    accelerator.begin_step()
    d = np.zeros(len(b))
    for count in range(limit):
        if np.linalg.norm(d - exact) <= 1e-9 * np.linalg.norm(exact):
            accelerator.end_step()
            return count
        d = accelerator.next(d, A @ d + b - d)
    raise AssertionError("not converged")


def test_a_linear_problem_takes_one_iteration_more_than_its_size():
    A, b, exact = problem(6, 11)
    assert iterations(InverseLeastSquares(0, 0.0, 0.5), A, b, exact) <= 8


def test_secants_of_earlier_steps_are_worth_iterations():
    A, b, exact = problem(12, 12)
    reusing = InverseLeastSquares(5, 1e-8, 0.5)
    first = iterations(reusing, A, b, exact)
    second = iterations(reusing, A, 2.0 * b, 2.0 * exact)
    assert second <= 3 < first


def test_steps_older_than_the_reuse_are_forgotten():
    accelerator = InverseLeastSquares(2, 0.0, 0.5)
    A, b, exact = problem(4, 13)
    for k in range(4):
        iterations(accelerator, A, (k + 1) * b, (k + 1) * exact)
    assert len(accelerator._steps) == 2


def test_dependent_columns_are_dropped_for_good():
    accelerator = InverseLeastSquares(0, 1e-3, 0.5)
    accelerator.begin_step()
    r = np.array([1.0, 0.0, 0.0])
    d = np.zeros(3)
    for shift in ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 1e-9, 0.0], [3.0, 1.0, 0.0]):
        accelerator.next(d + np.array(shift), r + np.array(shift))
    assert accelerator.dropped >= 1
    assert accelerator.columns == 2


def test_more_columns_than_unknowns_are_no_harm():
    A, b, exact = problem(3, 14)
    accelerator = InverseLeastSquares(10, 1e-6, 0.5)
    for k in range(1, 6):
        assert iterations(accelerator, A, k * b, k * exact) <= 6
        assert accelerator.columns <= 3 + 4


def test_a_repeated_residual_makes_no_column():
    accelerator = InverseLeastSquares(0, 1e-3, 0.5)
    accelerator.begin_step()
    d, r = np.zeros(2), np.array([1.0, 1.0])
    first = accelerator.next(d, r)
    np.testing.assert_array_equal(accelerator.next(d, r), first)
    assert accelerator.columns == 0


def test_a_contradicting_secant_of_an_earlier_step_is_not_amplified():
    """Two steps with slightly different Jacobians and nearly the same secant: the newer one decides."""
    accelerator = InverseLeastSquares(5, 1e-3, 0.5)
    for tilt, slope in ((1e-3, 0.6), (0.0, 0.5)):
        accelerator.begin_step()
        for k in range(2):
            d = np.array([2.0 * k, 0.0])
            residual = np.array([1.0 - slope * 2.0 * k, tilt * k])
            last = accelerator.next(d, residual)
        accelerator.end_step()
    np.testing.assert_allclose(last, [2.0, 0.0], atol=1e-9)
    accelerator.begin_step()
    off = accelerator.next(np.array([2.0, 0.0]), np.array([0.0, 1e-3]))
    assert np.linalg.norm(off - last) < 0.05  # 0.4 by least squares alone, through the difference of the slopes


def test_what_is_forgotten_does_not_help_later_steps():
    A, b, exact = problem(12, 12)
    fresh, reused = InverseLeastSquares(5, 1e-8, 0.5), InverseLeastSquares(5, 1e-8, 0.5)
    iterations(reused, A, b, exact)
    reused.forget()
    assert reused.columns == 0
    assert abs(iterations(reused, A, 2.0 * b, 2.0 * exact) - iterations(fresh, A, 2.0 * b, 2.0 * exact)) <= 1


def test_with_the_columns_of_another_it_goes_on_as_that():
    A, b, exact = problem(12, 12)
    one, two = InverseLeastSquares(5, 1e-8, 0.5), InverseLeastSquares(5, 1e-8, 0.5)
    iterations(one, A, b, exact)
    memory = one.memory()
    two.recall(memory)
    one.begin_step()
    two.begin_step()
    d = np.linspace(0.0, 1.0, 12)
    for _ in range(3):
        r = A @ d + b - d
        following = one.next(d, r)
        np.testing.assert_array_equal(two.next(d, r), following)
        d = following
    one.end_step()
    assert sum(map(len, memory.steps)) == sum(map(len, one.memory().steps)) - 2


def test_the_memory_of_another_kind_of_accelerator_is_none():
    A, b, exact = problem(12, 12)
    accelerator = InverseLeastSquares(5, 1e-8, 0.5)
    iterations(accelerator, A, b, exact)
    accelerator.recall(AitkenMemory(0.2))
    assert accelerator.columns == 0


def test_columns_of_more_steps_than_are_reused_are_left_out():
    A, b, exact = problem(6, 11)
    one, two = InverseLeastSquares(3, 1e-8, 0.5), InverseLeastSquares(1, 1e-8, 0.5)
    for factor in (1.0, 2.0):
        iterations(one, A, factor * b, factor * exact)
    two.recall(one.memory())
    assert len(two.memory().steps) == 1


def test_after_failures_the_first_iterate_is_nearer_until_a_step_converges():
    accelerator = InverseLeastSquares(5, 1e-3, 0.5)
    d, r, moved = np.zeros(2), np.array([1.0, -1.0]), []
    for _ in range(3):
        accelerator.begin_step()
        moved.append(accelerator.next(d, r)[0])
        accelerator.forget()
    accelerator.begin_step()
    accelerator.end_step()
    accelerator.begin_step()
    moved.append(accelerator.next(d, r)[0])
    np.testing.assert_allclose(moved, [0.5, 0.05, 0.005, 0.5])
