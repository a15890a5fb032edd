import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.io.equispaced import equispaced_points, equispaced_values, resampled
from hoblock.reference import equispaced, gauss_lobatto, tensor_basis


@pytest.mark.parametrize("order", [1, 2, 3, 5, 8])
@pytest.mark.parametrize("kind", ["disc", "star"])
def test_the_geometry_stays_the_same(order, kind, layouts, rng):
    mesh = generate(layouts.random(kind, rng), order)
    points = equispaced_points(mesh)
    where = rng.uniform(-1, 1, (7, 2))
    before = tensor_basis(gauss_lobatto(order), where) @ mesh.coordinates
    after = tensor_basis(equispaced(order), where) @ points[mesh.cells]
    np.testing.assert_allclose(after, before, atol=1e-12)
    assert (np.abs(points - mesh.points).max() > 1e-3) == (order > 2)


def test_nodes_of_a_straight_mesh_are_equally_far_apart(layouts):
    points = equispaced_points(generate(layouts.square(counts=2), 4))
    np.testing.assert_allclose(np.unique(np.round(points[:, 0], 12)), np.linspace(0, 1, 9), atol=1e-12)


def test_points_of_the_mesh_are_not_touched(layouts):
    mesh = generate(layouts.square(), 1)
    points = equispaced_points(mesh)
    points[0] = 5.0
    assert mesh.points[0, 0] == 0.0


@pytest.mark.parametrize("shape", [(), (3,), (2, 2)])
def test_values_of_any_shape(shape, layouts, rng):
    mesh = generate(layouts.random("disc", rng), 4)
    values = rng.normal(size=(len(mesh.points), *shape))
    result = equispaced_values(mesh, values)
    assert result.shape == values.shape
    where = rng.uniform(-1, 1, (7, 2))
    before = np.tensordot(tensor_basis(gauss_lobatto(4), where), values[mesh.cells], (1, 1))
    after = np.tensordot(tensor_basis(equispaced(4), where), result[mesh.cells], (1, 1))
    np.testing.assert_allclose(after, before, atol=1e-12)
    back = resampled(result, mesh.cells, 4, equispaced(4), gauss_lobatto(4))
    np.testing.assert_allclose(back, values, atol=1e-13)
