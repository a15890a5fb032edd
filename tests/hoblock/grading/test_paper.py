import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import Cubic, Quadratic, Uniform, restrict, reverse

S = np.linspace(0.0, 1.0, 101)


def test_uniform_is_the_identity_whichever_way_one_walks():
    np.testing.assert_array_equal(Uniform()(S), S)
    assert reverse(Uniform()) == Uniform() == restrict(Uniform(), 0.25, 0.5)


def test_quadratic_is_the_papers_function_and_dense_at_the_first_end_for_positive_m():
    r = 2 * S - 1
    np.testing.assert_allclose(2 * Quadratic(0.6)(S) - 1, r + 0.6 * (r**2 - 1) / 2, atol=1e-15)
    assert np.all(np.diff(Quadratic(0.6)(S), 2) > 0)
    np.testing.assert_allclose(Quadratic(-0.6)(S), 1 - Quadratic(0.6)(1 - S), atol=1e-15)


def test_cubic_is_symmetric_and_dense_at_both_ends():
    r = Cubic(0.8)(S)
    np.testing.assert_allclose(r, 1 - r[::-1], atol=1e-15)
    np.testing.assert_allclose(2 * r - 1, (1 + 0.4) * (2 * S - 1) - 0.4 * (2 * S - 1) ** 3, atol=1e-15)
    assert np.diff(r)[0] < 0.5 * np.diff(r)[50]
    np.testing.assert_allclose(Cubic(0.0)(S), S, atol=1e-15)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Quadratic(1.0), r"quadratic grading: m is 1; expected a number in \(-1, 1\)"),
        (lambda: Quadratic(float("nan")), "quadratic grading: m is nan"),
        (lambda: Cubic(-0.1), r"cubic grading: m is -0.1; expected a number in \[0, 1\)"),
        (lambda: Cubic(1.0), "cubic grading: m is 1"),
    ],
)
def test_impossible_parameters_are_refused(make, match):
    with pytest.raises(GradingError, match=match):
        make()
