import re

import numpy as np
import pytest

from hoblock.errors import GradingError
from hoblock.grading import EdgeGrading, Exponential, Geometric, element_corners, restrict, reverse

S = np.linspace(0.0, 1.0, 101)


@pytest.mark.parametrize("a", [1.8, -1.8, 1e-9, 30.0])
def test_exponential_sizes_grow_by_a_constant_ratio(a):
    sizes = np.diff(element_corners(Exponential(a), 8))
    np.testing.assert_allclose(sizes[1:] / sizes[:-1], np.exp(a / 8), rtol=1e-7)


def test_exponential_is_continuous_where_its_formula_changes():
    for a in (0.999e-8, 1.001e-8, -1.001e-8):
        np.testing.assert_allclose(Exponential(a)(S), S + a * S * (S - 1) / 2, rtol=0, atol=3e-16)


def test_a_part_of_an_exponential_is_one():
    part = restrict(Exponential(3.0), 0.2, 0.7)
    assert isinstance(part, Exponential)
    assert part.a == pytest.approx(1.5, rel=1e-15)
    whole = Exponential(3.0)(np.array([0.2, 0.45, 0.7]))
    np.testing.assert_allclose(part(np.array([0.5])), (whole[1] - whole[0]) / (whole[2] - whole[0]), rtol=1e-14)


@pytest.mark.parametrize("count", [2, 3, 10])
@pytest.mark.parametrize("ratio", [0.2, 1.0, 3.0])
def test_geometric_ratios_are_those_of_the_last_to_the_first_and_of_neighbours(edge, heights, straight, ratio, count):
    total = heights(Geometric(total=ratio), straight(7.0), count)
    assert total[-1] / total[0] == pytest.approx(ratio, rel=1e-12)
    np.testing.assert_allclose(total[1:] / total[:-1], ratio ** (1 / (count - 1)), rtol=1e-8)
    growth = heights(Geometric(growth=ratio), straight(7.0), count)
    np.testing.assert_allclose(growth[1:] / growth[:-1], ratio, rtol=1e-8)


def test_geometric_of_one_element_and_reversed(straight):
    assert Geometric(total=5.0).resolved(straight(), 1) == Exponential(0.0)
    turned = reverse(Geometric(growth=1.3))
    assert isinstance(turned, EdgeGrading)
    assert reverse(turned) == Geometric(growth=1.3)
    np.testing.assert_allclose(
        turned.resolved(straight(), 6)(S), Geometric(growth=1 / 1.3).resolved(straight(), 6)(S), atol=1e-14
    )


def test_the_growth_that_an_error_allows_is_allowed(straight):
    with pytest.raises(
        GradingError, match=r"60 elements growing by 4 differ by a factor of 3.3e\+35; take a growth b"
    ) as e:
        Geometric(growth=4.0).resolved(straight(), 60)
    low, high = map(float, re.search(r"between (\S+) and (\S+),", str(e.value)).groups())
    Geometric(growth=high).resolved(straight(), 60)
    Geometric(growth=low).resolved(straight(), 60)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Exponential(51.0), r"exponential grading: a is 51; expected a number in \[-50, 50\]"),
        (lambda: Exponential(float("nan")), "exponential grading: a is nan"),
        (
            lambda: Geometric(),
            "geometric grading: got neither total nor growth; expected exactly one of them: total is",
        ),
        (lambda: Geometric(total=2.0, growth=1.1), "geometric grading: got both total and growth"),
        (
            lambda: Geometric(total=0.0),
            "geometric grading: total is 0.0; expected a positive number, above 1 for small",
        ),
        (lambda: Geometric(growth=-1.2), "geometric grading: growth is -1.2; expected a positive number"),
        (lambda: Geometric(growth=float("inf")), "geometric grading: growth is inf"),
    ],
)
def test_impossible_parameters_are_refused(make, match):
    with pytest.raises(GradingError, match=match):
        make()
