"""Certified bounds of det J."""

import numpy as np
import pytest

from hoblock.quality import det_jacobian, det_jacobian_bounds


@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("amplitude", [0.1, 0.4])
def test_bernstein_bounds_bracket_sampled_values(order, amplitude, rng, elements):
    mesh = elements.perturbed(rng, order, amplitude)
    lower, upper = det_jacobian_bounds(mesh)
    sampled = det_jacobian(mesh, elements.grid(np.linspace(-1, 1, 41)))
    assert np.all(lower <= sampled.min(axis=1) + 1e-11)
    assert np.all(upper >= sampled.max(axis=1) - 1e-11)
    finer, same = det_jacobian_bounds(mesh, 3)
    np.testing.assert_array_equal(same, upper)
    assert np.all(finer >= lower - 1e-12)
    assert np.all(np.where(lower <= 0, finer, lower) <= sampled.min(axis=1) + 1e-11)
    if order == 1:  # det J is linear in ξ and η up to ξη, its extrema are at the corners
        np.testing.assert_allclose(lower, sampled.min(axis=1), atol=1e-13)


def test_subdivision_sharpens_the_bound(rng, elements):
    mesh = elements.perturbed(rng, 4, 0.33)
    sampled = det_jacobian(mesh, elements.grid(np.linspace(-1, 1, 81))).min(axis=1)
    inverted = sampled < 0
    gaps = [np.max((sampled - det_jacobian_bounds(mesh, k)[0])[inverted]) for k in (0, 2, 5)]
    assert inverted.sum() > 20
    # The bound converges quadratically in the size of the pieces: 4 and 8 times smaller.
    assert gaps[0] > 10 * gaps[1]
    assert gaps[2] < 0.05


@pytest.mark.parametrize("order", [8, 10, 12, 16, 24, 32])
def test_bounds_are_sharp_at_high_orders(order, elements):
    """det J of a trapezium is linear, between 0.25 and 0.3, whatever the order of the element."""
    lower, upper = det_jacobian_bounds(elements.bilinear([(0, 0), (1, 0), (1.2, 1), (0, 1)], order))
    # The bounds include rounding errors, of which high orders have more.
    assert 0.25 - 1e-4 < lower[0] <= 0.25
    assert 0.3 <= upper[0] < 0.3 + 1e-4


@pytest.mark.parametrize("order", [9, 12])
def test_bounds_hold_where_high_modes_are_strong(order, rng, elements):
    mesh = elements.perturbed(rng, order, 0.4)
    sampled = det_jacobian(mesh, elements.grid(np.linspace(-1, 1, 41)))
    for subdivisions in (0, 2):
        lower, upper = det_jacobian_bounds(mesh, subdivisions)
        assert np.all(lower <= sampled.min(axis=1))
        assert np.all(upper >= sampled.max(axis=1))
