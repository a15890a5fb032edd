"""The nearest points of isolines."""

import numpy as np
import pytest

from hoblock.curves.nearest import nearest_on_level_set
from hoblock.errors import CurveError


def circle(points):
    return np.exp(points[:, 0] ** 2 + points[:, 1] ** 2) - np.e


def ellipse(points):
    return (points[:, 0] / 2.0) ** 2 + points[:, 1] ** 2 - 1.0


def test_points_about_a_circle_move_along_its_radii(rng):
    angle, radius = rng.uniform(-np.pi, np.pi, 300), rng.uniform(0.4, 1.4, 300)
    on_it = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    found = nearest_on_level_set(circle, radius[:, None] * on_it)
    np.testing.assert_allclose(np.hypot(*found.T), 1.0, atol=1e-15)
    np.testing.assert_allclose(found, on_it, atol=1e-10)


@pytest.mark.parametrize("gradient", [None, lambda x: np.stack([x[:, 0] / 2.0, 2.0 * x[:, 1]], axis=-1)])
def test_way_to_the_nearest_point_is_normal_to_the_isoline(rng, gradient):
    angle = rng.uniform(-np.pi, np.pi, 100)
    near = 1.15 * np.stack([2.0 * np.cos(angle), np.sin(angle)], axis=-1)
    found = nearest_on_level_set(ellipse, near, gradient=gradient)
    np.testing.assert_allclose(ellipse(found), 0.0, atol=4e-15)
    g = np.stack([found[:, 0] / 2.0, 2.0 * found[:, 1]], axis=-1)
    cross = (near - found)[:, 0] * g[:, 1] - (near - found)[:, 1] * g[:, 0]
    np.testing.assert_allclose(cross, 0.0, atol=1e-9)


def test_other_levels_and_single_points():
    found = nearest_on_level_set(lambda p: np.hypot(p[:, 0], p[:, 1]), np.array([[3.0, 4.0]]), level=2.0)
    np.testing.assert_allclose(found, [[1.2, 1.6]], atol=1e-14)
    assert nearest_on_level_set(circle, np.zeros((0, 2))).shape == (0, 2)


def test_points_on_the_isoline_stay():
    angle = np.linspace(0.0, 6.0, 40)
    points = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    np.testing.assert_allclose(nearest_on_level_set(circle, points), points, atol=1e-14)


@pytest.mark.parametrize(
    ("function", "points", "options", "match"),
    [
        (
            circle,
            [(0.5, 0.0)],
            {"reach": 0.4},
            r"within 0\.4 of it from \(0\.5, 0\); .* Start closer to the isoline, take a larger reach or check",
        ),
        (circle, [(0.0, 0.0)], {}, r"none found from \(0, 0\); .* Start closer to the isoline or check the level"),
        (lambda p: circle(p) + 5.0, [(1.0, 1.0)], {"reach": 5.0}, "none found within 5"),
        (circle, [(np.nan, 0.0)], {}, r"points have shape \(1, 2\); expected finite coordinates \(n, 2\)"),
        (circle, [(1.0, 0.0, 0.0)], {}, r"points have shape \(1, 3\)"),
        (lambda p: p, [(1.0, 0.0)], {}, r"the function returned shape \(1, 2\) for 1 points"),
    ],
)
def test_errors(function, points, options, match):
    with pytest.raises(CurveError, match=match):
        nearest_on_level_set(function, np.array(points), **options)
