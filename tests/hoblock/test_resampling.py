import itertools

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.quality import det_jacobian
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_quadrature
from hoblock.resampling import geometric_error, resample


def area_of(mesh):
    points, weights = tensor_quadrature(mesh.order + 1)
    return float((det_jacobian(mesh, points) @ weights).sum())


@pytest.mark.parametrize(("order", "higher"), [(1, 2), (2, 7), (5, 6), (4, 16)])
def test_upwards_the_geometry_is_the_same(order, higher, layouts):
    mesh = generate(layouts.annulus(5, counts=2), order)
    finer = resample(mesh, higher)
    assert finer.order == higher
    assert geometric_error(mesh, finer) < 1e-14
    assert area_of(finer) == pytest.approx(area_of(mesh), rel=1e-13)
    places = np.random.default_rng(3).uniform(-1, 1, (5, 2))
    for m in (mesh, finer):
        m_x = tensor_basis(gauss_lobatto(m.order), places) @ m.coordinates
        np.testing.assert_allclose(m_x, tensor_basis(gauss_lobatto(order), places) @ mesh.coordinates, atol=1e-14)
    back = resample(finer, order)
    assert geometric_error(back, mesh) < 1e-14
    np.testing.assert_array_equal(back.points[back.corners], mesh.points[mesh.corners])


def test_downwards_the_error_falls_with_the_order(layouts):
    mesh = generate(layouts.annulus(5, counts=2), 12)
    errors = [geometric_error(mesh, resample(mesh, order)) for order in range(1, 8)]
    # The sagitta of an arc of 36° with radius 2 for order 1, then about a factor of ten an order.
    assert errors[0] == pytest.approx(2 * (1 - np.cos(np.pi / 10)), rel=0.05)
    assert all(after < 0.35 * before for before, after in itertools.pairwise(errors))
    assert errors[-1] < 1e-8


def test_neighbours_fit_and_names_stay(layouts):
    mesh = generate(layouts.annulus(5, counts=2), 6)
    coarse = resample(mesh, 3)
    fresh = generate(layouts.annulus(5, counts=2), 3)
    assert len(coarse.points) == len(fresh.points)
    for name, sides in mesh.edge_groups.items():
        np.testing.assert_array_equal(coarse.edge_groups[name], sides)
    assert resample(mesh, 6) is mesh


def test_bad_arguments(layouts):
    mesh = generate(layouts.square(counts=2), 2)
    with pytest.raises(ValueError, match="order is 0"):
        resample(mesh, 0)
    with pytest.raises(ValueError, match="4 and 9 elements; expected the same elements twice"):
        geometric_error(mesh, generate(layouts.square(counts=3), 2))
