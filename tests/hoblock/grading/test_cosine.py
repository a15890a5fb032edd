import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import Cosine, element_corners, reverse

S = np.linspace(0.0, 1.0, 101)


def test_both_ends_are_the_points_of_chebyshev_and_lobatto():
    np.testing.assert_allclose(element_corners(Cosine(), 8), (1 - np.cos(np.pi * np.arange(9) / 8)) / 2, atol=1e-15)
    assert reverse(Cosine()) == Cosine()


def test_one_end_is_half_of_both():
    np.testing.assert_allclose(Cosine("first")(S), 2 * Cosine()(S / 2), atol=1e-15)
    np.testing.assert_allclose(Cosine("second")(S), np.sin(np.pi / 2 * S), atol=1e-15)
    assert reverse(Cosine("first")) == Cosine("second")
    assert reverse(reverse(Cosine("first"))) == Cosine("first")


def test_unknown_ends_are_refused():
    with pytest.raises(GradingError, match="cosine grading: ends is 'left'; expected 'first', 'second' or 'both'"):
        Cosine("left")
