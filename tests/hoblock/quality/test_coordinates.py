"""Coordinates relative to the element and scaled."""

import numpy as np
import pytest

from hoblock.mesh import QuadMesh
from hoblock.quality import certify
from hoblock.quality.coordinates import chunks, element_coordinates


@pytest.mark.parametrize("order", [1, 2, 5])
@pytest.mark.parametrize("scale", [1e-310, 1e-200, 3.0, 1e300])
def test_coordinates_are_scaled_and_can_be_restored(order, scale, elements, rng):
    mesh = elements.perturbed(rng, order, 0.3, 7)
    mesh = mesh.with_points(mesh.points * [scale, 1.0])
    found = element_coordinates(mesh, slice(2, 6))
    size = np.abs(found.x).max(axis=1)
    assert size.max() < 1.0
    assert size.min() >= 0.5
    restored = np.ldexp(found.x, found.exponents[:, None])
    middle = mesh.coordinates[2:6, (order + 1) ** 2 // 2, None]
    expected = (mesh.coordinates[2:6] - middle).transpose(2, 1, 0)
    np.testing.assert_array_equal(restored, expected)


def test_isotropic_coordinates_keep_angles(elements):
    mesh = elements.bilinear([(0, 0), (1, 0.001), (0.9, 0.011), (0, 0.01)], 2)
    x = element_coordinates(mesh, slice(0, 1)).isotropic[..., 0]
    ratio = np.ptp(x[1]) / np.ptp(x[0])
    assert ratio == pytest.approx(0.011)


def test_chunks_cover_all_elements():
    for order, count in ((1, 0), (1, 10_000), (4, 1), (8, 1001)):
        found = [k for some in chunks(order, count) for k in range(some.start, some.stop)]
        assert found == list(range(count))


def test_any_array_of_points_will_do(elements, rng):
    mesh = elements.perturbed(rng, 3, 0.3, 20)
    status = certify(mesh).status
    columns = np.asfortranarray(mesh.points)
    wide = np.zeros((len(mesh.points), 3))
    wide[:, :2] = mesh.points
    for points in (columns, wide[:, :2], mesh.points[::-1].copy()[::-1]):
        other = QuadMesh(points, mesh.cells, 3, {}, {})
        np.testing.assert_array_equal(certify(other).status, status)
    whole = QuadMesh(np.array([(0, 0), (1, 0), (0, 1), (1, 1)]), np.array([(0, 1, 2, 3)]), 1, {}, {})
    assert certify(whole).valid
