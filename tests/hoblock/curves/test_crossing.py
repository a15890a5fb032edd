"""Where isolines cross."""

import numpy as np
import pytest

from hoblock.curves.crossing import crossing_of_level_sets
from hoblock.errors import CurveError


def circle(points):
    return points[:, 0] ** 2 + points[:, 1] ** 2 - 1.0


def line(points):
    return points[:, 1] - 2.0 * points[:, 0]


def test_both_isolines_hold_at_the_crossing(rng):
    exact = np.array([1.0, 2.0]) / np.sqrt(5.0)
    for start in exact + rng.uniform(-0.3, 0.3, (30, 2)):
        np.testing.assert_allclose(crossing_of_level_sets((circle, line), start), exact, atol=1e-15)
    np.testing.assert_allclose(crossing_of_level_sets((line, circle), -exact), -exact, atol=1e-15)


def test_levels_and_gradients_of_the_functions_own():
    class Distance:
        def __call__(self, points):
            return np.hypot(points[:, 0], points[:, 1])

        def gradient(self, points):
            return points / np.hypot(points[:, 0], points[:, 1])[:, None]

    found = crossing_of_level_sets((Distance(), line), np.array([1.0, 1.0]), levels=(5.0, 5.0), reach=6.0)
    np.testing.assert_allclose(found, [0.0, 5.0], atol=1e-14)


@pytest.mark.parametrize(
    ("functions", "point", "reach", "match"),
    [
        ((circle, line), (0.5, 0.5), 0.1, r"none found within 0\.1 of it from \(0\.5, 0\.5\)\. Start closer"),
        ((circle, lambda p: circle(p) + 0.5), (0.5, 0.5), None, "the isolines are parallel; expected a crossing"),
        ((circle, lambda p: circle(p - 0.9) + 0.99), (0.0, 0.1), None, r"none found from \(0, 0\.1\)|are parallel"),
        ((circle, line), (0.5, np.nan), None, "expected two finite coordinates"),
        ((circle, lambda p: p), (0.5, 0.5), None, r"the function returned shape \(1, 2\) for 1 points"),
    ],
)
def test_errors(functions, point, reach, match):
    with pytest.raises(CurveError, match=match):
        crossing_of_level_sets(functions, np.array(point), reach=reach)
