import numpy as np
import pytest

from hoblock.grading.ends import steps_from_ends
from hoblock.grading.layer_heights import (
    capped_heights,
    constant_growth,
    elements_needed,
    grown_heights,
    layer_elements,
)


def test_steps():
    assert steps_from_ends(4, 1).tolist() == [0, 1, 2, 3]
    assert steps_from_ends(4, 2).tolist() == [0, 1, 1, 0]
    assert steps_from_ends(5, 2).tolist() == [0, 1, 2, 1, 0]


@pytest.mark.parametrize("growth", [1e-6, 0.3, 1.0, 1.0 + 1e-12, 1.2, 40.0])
@pytest.mark.parametrize("count", [3, 12, 60])
@pytest.mark.parametrize("sides", [1, 2])
def test_constant_growth_recovers_a_ratio(growth, count, sides):
    steps = steps_from_ends(count, sides)
    total = float((3e-4 * growth ** steps.astype(float)).sum())
    assert constant_growth(3e-4, steps, total) == pytest.approx(growth, rel=1e-9)


def test_constant_growth_does_not_overflow():
    steps = steps_from_ends(5000, 1)
    growth = constant_growth(1e-12, steps, 1e12)
    assert grown_heights(1e-12, growth, steps, 1e12).sum() == pytest.approx(1e12, rel=1e-9)
    assert constant_growth(1.0, steps_from_ends(2, 1), 1e200) == pytest.approx(1e200, rel=1e-12)


def test_heights_far_beyond_what_matters_stay_finite():
    found = grown_heights(1e-3, 2.0, steps_from_ends(5000, 1), 1.0)
    np.testing.assert_allclose(found[:9], 1e-3 * 2.0 ** np.arange(9), rtol=1e-14)
    assert found.max() == pytest.approx(2.0)


def test_capped_heights_that_no_cap_makes_fit():
    steps = steps_from_ends(4, 1)
    assert capped_heights(0.1, 1.5, steps, 0.1 * (1 + 1.5 + 2.25 + 3.375) * 1.001) is None
    assert capped_heights(0.9, 1.5, steps, 1.0) is None
    np.testing.assert_allclose(capped_heights(0.1, 1.5, steps, 0.8125), 0.1 * 1.5**steps, rtol=1e-12)
    np.testing.assert_allclose(capped_heights(0.25, 1.5, steps, 1.0), 0.25, rtol=1e-14)


@pytest.mark.parametrize("growth", [1.0, 1.01, 1.5])
def test_layer_elements_are_the_fewest(growth):
    for number in (1, 2, 7, 30):
        reach = (1e-3 * growth ** np.arange(number)).sum()
        assert layer_elements(1e-3, growth, reach) == number
        assert layer_elements(1e-3, growth, reach * 1.0001) == number + 1
    assert layer_elements(1e-3, growth, 1e-9) == 1


@pytest.mark.parametrize("sides", [1, 2])
@pytest.mark.parametrize("total", [0.0009, 0.01, 1.0, 1.7, 40.0])
def test_elements_needed_are_the_fewest(sides, total):
    count = elements_needed(1e-3, 1.3, sides, total)
    assert (1e-3 * 1.3 ** steps_from_ends(count, sides)).sum() >= total * (1 - 1e-11)
    assert count == 1 or (1e-3 * 1.3 ** steps_from_ends(count - 1, sides)).sum() < total
