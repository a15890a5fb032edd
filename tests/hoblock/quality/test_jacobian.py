"""Jacobians at reference points."""

import numpy as np
import pytest

from hoblock.quality import det_jacobian, jacobian, minimum_det_jacobian


def test_jacobian_of_a_known_map(elements):
    mesh = elements.mapped(lambda xi, eta: (xi + 0.1 * xi * eta**2, eta + 0.2 * xi**3), 3)
    points = np.array([(0.3, -0.4), (1.0, 1.0)])
    xi, eta = points.T
    expected = np.stack([np.stack([1 + 0.1 * eta**2, 0.2 * xi * eta]), np.stack([0.6 * xi**2, 1 + 0 * xi])])
    np.testing.assert_allclose(jacobian(mesh, points)[0], expected.transpose(2, 0, 1), atol=1e-14)
    np.testing.assert_allclose(det_jacobian(mesh, points)[0], 1 + 0.1 * eta**2 - 0.12 * xi**3 * eta, atol=1e-14)


def test_minimum_is_that_of_the_samples(elements, rng):
    mesh = elements.perturbed(rng, 3, 0.2, 300)  # more than a chunk
    grid = elements.grid(np.linspace(-1, 1, 7))
    assert minimum_det_jacobian(mesh) <= det_jacobian(mesh, grid).min()
    points = np.array(mesh.points)
    points[5] = np.nan
    assert np.isnan(minimum_det_jacobian(mesh.with_points(points)))


def test_digits_are_kept_far_from_the_origin(elements):
    square = elements.bilinear([(0, 0), (1, 0), (1, 1), (0, 1)], 8)
    moved = square.with_points(square.points + 2.0**20)
    assert minimum_det_jacobian(moved) == pytest.approx(0.25, abs=1e-7)
