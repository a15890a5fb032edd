"""Continuation on problems of one or two unknowns."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi.errors import LinearSolverError, NewtonError
from hofsi.solvers.continuation import approach

FAILURE = NewtonError("Newton's method failed.", "max_iterations", "there")


class Near:
    """x = (share², 3 share): found only from a start that is near enough."""

    def __init__(self, reach: float, error: type[Exception] = NewtonError) -> None:
        self.reach, self.error = reach, error
        self.shares: list[float] = []
        self.starts: list[np.ndarray] = []

    def __call__(self, start: np.ndarray, share: float) -> np.ndarray:
        self.shares.append(share)
        self.starts.append(start)
        exact = np.array([share**2, 3.0 * share])
        if share and np.abs(start - exact).max() > self.reach:
            raise self.error("too far away")
        return exact


@pytest.mark.parametrize("error", [NewtonError, LinearSolverError])
@pytest.mark.parametrize("reach", [10.0, 0.35, 0.1, 0.05])
def test_the_end_is_reached(reach: float, error: type[Exception]) -> None:
    solve = Near(reach, error)
    np.testing.assert_allclose(approach(solve, np.array([5.0, 5.0]), FAILURE, "of it"), [1.0, 3.0], rtol=1e-14)
    assert solve.shares[0] == 0.0
    assert solve.shares[-1] == 1.0
    assert max(solve.shares) == 1.0


def test_steps_are_doubled_after_success_and_halved_after_failure() -> None:
    easy = Near(10.0)
    approach(easy, np.zeros(2), FAILURE, "of it")
    np.testing.assert_allclose(easy.shares, [0.0, 0.1, 0.3, 0.7, 1.0], rtol=1e-14)
    hard = Near(0.16)
    approach(hard, np.zeros(2), FAILURE, "of it")
    np.testing.assert_allclose(hard.shares[:4], [0.0, 0.1, 0.05, 0.15], rtol=1e-14)


def test_a_step_starts_from_the_line_through_the_last_two_solutions() -> None:
    solve = Near(10.0)
    approach(solve, np.zeros(2), FAILURE, "of it")
    # x = share² at 0.1 and 0.3, continued to 0.7
    np.testing.assert_allclose(solve.starts[3], [0.09 + 0.4 * 0.4, 2.1], rtol=1e-13)


def test_the_error_says_how_far_it_came() -> None:
    def solve(start: np.ndarray, share: float) -> np.ndarray:
        if share > 0.4321:
            raise LinearSolverError("singular")
        return start

    with pytest.raises(NewtonError, match=r"there: Newton's .* little by little, 0\.43\d? of it was reached") as caught:
        approach(solve, np.zeros(1), FAILURE, "of it")
    assert caught.value.reason == "max_iterations"
    assert isinstance(caught.value.__cause__, LinearSolverError)


def test_if_the_easy_problem_fails_the_first_error_counts() -> None:
    def solve(start: np.ndarray, share: float) -> np.ndarray:
        raise LinearSolverError("singular")

    with pytest.raises(NewtonError) as caught:
        approach(solve, np.zeros(1), FAILURE, "of it")
    assert caught.value is FAILURE
