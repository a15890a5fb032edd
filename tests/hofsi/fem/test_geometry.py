from __future__ import annotations

import numpy as np
import pytest

from hofsi.errors import MeshMotionError
from hofsi.fem.element import element_table, side_table
from hofsi.fem.geometry import element_geometry, physical_gradients, side_geometry


def all_sides(mesh):
    return np.concatenate([mesh.edge_groups[name] for name in ("bottom", "right", "top", "left")])


@pytest.mark.parametrize("order", [1, 2, 4])
def test_gradients_of_linear_functions_are_exact_on_curved_elements(distorted, order):
    mesh = distorted(order)
    table = element_table(order, order + 2)
    geometry = element_geometry(mesh.coordinates, table)
    gx, gy = physical_gradients(geometry, table)
    u = mesh.coordinates @ [3.0, -2.0]
    np.testing.assert_allclose((gx @ u[:, :, None])[..., 0], 3.0, rtol=1e-11)
    np.testing.assert_allclose((gy @ u[:, :, None])[..., 0], -2.0, rtol=1e-11)


def test_jacobian_inverse_is_the_derivative_of_the_reference_coordinates(distorted):
    mesh = distorted(3)
    table = element_table(3, 4)
    geometry = element_geometry(mesh.coordinates, table)
    jacobian = np.einsum("eid,qic->eqdc", mesh.coordinates, table.dN)
    np.testing.assert_allclose(geometry.J_inv @ jacobian, np.broadcast_to(np.eye(2), jacobian.shape), atol=1e-12)
    np.testing.assert_allclose(geometry.weights, np.linalg.det(jacobian) * table.weights, rtol=1e-12)
    np.testing.assert_allclose(geometry.x, np.einsum("qi,eid->eqd", table.N, mesh.coordinates), atol=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_divergence_theorem_holds_to_rounding(distorted, order):
    mesh = distorted(order)
    geometry = element_geometry(mesh.coordinates, element_table(order, 2 * order + 2))
    sides = side_geometry(mesh.coordinates, all_sides(mesh), side_table(order, 2 * order + 2))
    # ∫ ∇·(x², x y) = ∫ 3 x
    flux = sum(np.sum((s.x[..., 0] ** 2) * s.normals[..., 0] + s.x.prod(axis=-1) * s.normals[..., 1]) for s in sides)
    assert flux == pytest.approx(np.sum(geometry.weights * 3.0 * geometry.x[..., 0]), rel=1e-12)
    closed = sum(s.normals.sum(axis=(0, 1)) for s in sides)
    np.testing.assert_allclose(closed, 0.0, atol=1e-14)


def test_normals_point_out_and_lengths_add_up(distorted):
    mesh = distorted(1, 2, 2)
    mesh = mesh.with_points(np.stack([2.0 * np.round(mesh.points[:, 0] * 2) / 2, mesh.points[:, 1]], axis=-1))
    for name, outward in (("right", 1.0), ("left", -1.0)):
        sides = side_geometry(mesh.coordinates, mesh.edge_groups[name], side_table(1, 3))
        assert all((outward * s.normals[..., 0] > 0.0).all() for s in sides)
        y = mesh.points[mesh.edge_nodes(name), 1]
        assert sum(s.lengths.sum() for s in sides) == pytest.approx(np.ptp(y), rel=1e-13)


def test_side_jacobians_agree_with_those_of_the_element(distorted):
    mesh = distorted(2)
    for side in side_geometry(mesh.coordinates, all_sides(mesh), side_table(2, 3)):
        u = mesh.coordinates[side.elements] @ [0.5, 4.0]
        along = np.einsum("ei,qic->eqc", u, side.table.dN)
        gradient = np.einsum("eqc,eqcd->eqd", along, side.J_inv)
        np.testing.assert_allclose(gradient, np.broadcast_to([0.5, 4.0], gradient.shape), rtol=1e-11)


def test_turned_over_element_is_named(distorted):
    mesh = distorted(2)
    points = mesh.points.copy()
    points[mesh.cells[4]] = points[mesh.cells[4]][:, ::-1]
    with pytest.raises(MeshMotionError, match=r"element \d+: det J = -.* must be positive"):
        element_geometry(points[mesh.cells], element_table(2, 4))


def test_nan_positions_are_refused(distorted):
    mesh = distorted(2)
    X = mesh.coordinates.copy()
    X[3] = np.nan
    with pytest.raises(MeshMotionError, match="element 3: det J = nan"):
        element_geometry(X, element_table(2, 4))
