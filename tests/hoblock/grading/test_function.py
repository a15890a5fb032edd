import math

import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import Function, element_corners, reverse

S = np.linspace(0.0, 1.0, 101)


def square(s):
    return s**2


def test_values_are_scaled_to_the_unit_interval():
    np.testing.assert_array_equal(Function(square)(S), S**2)
    np.testing.assert_allclose(Function(lambda s: 3 - np.exp(-2 * s))(S), np.expm1(-2 * S) / np.expm1(-2), atol=1e-15)
    np.testing.assert_allclose(element_corners(reverse(Function(square)), 3), 1 - np.array([1, 4 / 9, 1 / 9, 0]))


def test_equal_if_the_function_is_the_same():
    assert Function(square) == Function(square)
    assert hash(Function(square)) == hash(Function(square))
    assert Function(square) != Function(lambda s: s**2)


def test_scalar_functions_can_be_vectorised():
    np.testing.assert_allclose(Function(np.vectorize(math.sqrt))(S), np.sqrt(S))


@pytest.mark.parametrize(
    ("function", "match"),
    [
        (3, r"function grading: got 3; expected a function of s in \[0, 1\]"),
        (lambda s: s * (1 - s), r"the value is .* at s = 0\.5\d*, but .*; must increase strictly"),
        (lambda s: 1 - s, "the value is 1 at s = 0, but 0.99.*; must increase strictly"),
        (lambda s: np.where(s < 0.5, s, np.nan), "the value is nan at s = 0.5; must be finite"),
        (math.sqrt, r"fails on an array of parameters: .*Use NumPy's functions, or np\.vectorize"),
        (lambda s: 1.0, r"returned shape \(\) for parameters of shape \(257,\); expected the same shape"),
    ],
)
def test_functions_that_are_no_grading(function, match):
    with pytest.raises(GradingError, match=match):
        Function(function)
