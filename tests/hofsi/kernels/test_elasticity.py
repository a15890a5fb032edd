from __future__ import annotations

import numpy as np
import pytest

from hofsi.kernels import elasticity as kernel

LAME, MU = 3.0, 1.7
I2 = np.eye(2)


def dense(S):
    """(…, 3) to (…, 2, 2)."""
    return np.stack([S[..., 0], S[..., 2], S[..., 2], S[..., 1]], axis=-1).reshape(*S.shape[:-1], 2, 2)


def law(H, m=1.0):
    """The definition, one tensor at a time."""
    E = (H + H.T + m * H.T @ H) / 2.0
    return LAME * np.trace(E) * I2 + 2.0 * MU * E


def parameters(count):
    """λ, μ and m of elements that alternate between the two laws."""
    one = np.ones((count, 1))
    return LAME * one, MU * one, (np.arange(count)[:, None] % 2).astype(float)


def element_data(elements=4, nodes=5, points=6, seed=401):
    """Elements with arbitrary basis values and Jacobians: the kernels do not care where these come from."""
    rng = np.random.default_rng(seed)
    dN = rng.standard_normal((points, nodes, 2))
    J_inv = kernel.components_outermost(rng.standard_normal((elements, points, 2, 2)))
    return rng, dN, J_inv, rng.uniform(0.5, 1.5, (elements, points))


def force(u, dN, J_inv, weights):
    lame, mu, m = parameters(len(u))
    H = kernel.displacement_gradient(u, dN, J_inv)
    return kernel.internal_force(kernel.deformation_gradient(H, m), kernel.stress(H, lame, mu, m), dN, J_inv, weights)


def gradient_field(*tensors):
    return np.array(tensors)[:, None]


@pytest.mark.parametrize("m", [0.0, 1.0])
def test_stress_follows_its_definition(m):
    rng = np.random.default_rng(402)
    H = rng.standard_normal((3, 2, 2, 2))
    S = dense(kernel.stress(H, LAME * np.ones((3, 1)), MU * np.ones((3, 1)), m * np.ones((3, 1))))
    for element in range(3):
        for q in range(2):
            np.testing.assert_allclose(S[element, q], law(H[element, q], m), rtol=1e-13)


def test_rigid_rotation_gives_no_stress():
    angles = np.array([0.3, 2.0, -1.1])
    R = np.stack([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]]).transpose(2, 0, 1)
    one = np.ones((3, 1))
    np.testing.assert_allclose(kernel.stress((R - I2)[:, None], LAME * one, MU * one, one), 0.0, atol=1e-15)
    linear = kernel.stress((R - I2)[:, None], LAME * one, MU * one, 0.0 * one)
    assert (np.abs(linear[..., 0]) > 0.1).all()  # the linear law does see rotations


def test_stress_is_objective():
    rng = np.random.default_rng(403)
    H, angle, one = rng.standard_normal((1, 1, 2, 2)), 0.9, np.ones((1, 1))
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = R @ (H + I2) - I2
    first, second = (kernel.stress(gradient, LAME * one, MU * one, one) for gradient in (H, turned))
    np.testing.assert_allclose(second, first, rtol=1e-12)


def test_uniaxial_strain_and_simple_shear():
    e, g, one = 0.2, 0.4, np.ones((2, 1))
    H = gradient_field([[e, 0.0], [0.0, 0.0]], [[0.0, g], [0.0, 0.0]])
    S = kernel.stress(H, LAME * one, MU * one, one)[:, 0]
    E = e + e**2 / 2.0
    np.testing.assert_allclose(S[0], [(LAME + 2.0 * MU) * E, LAME * E, 0.0], rtol=1e-14)
    np.testing.assert_allclose(S[1], [LAME * g**2 / 2.0, (LAME + 2.0 * MU) * g**2 / 2.0, MU * g], rtol=1e-14)


def test_plane_stress_leaves_nothing_out_of_plane():
    E, nu = 2.5, 0.3
    lame, mu = kernel.plane_lame_parameters(E, nu, stress=False)
    assert (lame, mu) == (pytest.approx(E * nu / (1.3 * 0.4)), pytest.approx(E / 2.6))
    # The three-dimensional law with the transverse strain that cancels S_zz, against the plane one.
    exx, eyy = 0.11, -0.04
    ezz = -lame * (exx + eyy) / (lame + 2.0 * mu)
    plane, same_mu = kernel.plane_lame_parameters(E, nu, stress=True)
    assert same_mu == mu
    assert plane * (exx + eyy) + 2.0 * mu * exx == pytest.approx(lame * (exx + eyy + ezz) + 2.0 * mu * exx)
    assert lame * (exx + eyy + ezz) + 2.0 * mu * ezz == pytest.approx(0.0, abs=1e-15)


def test_components_outermost_changes_the_layout_only():
    T = np.random.default_rng(404).standard_normal((3, 4, 2, 2))
    moved = kernel.components_outermost(T)
    np.testing.assert_array_equal(moved, T)
    assert moved[..., 0, 1].flags.c_contiguous


def test_displacement_gradient_sums_over_nodes():
    rng, dN, J_inv, _ = element_data()
    u = rng.standard_normal((4, 5, 2))
    expected = np.einsum("eia,qic,eqcd->eqad", u, dN, J_inv)
    np.testing.assert_allclose(kernel.displacement_gradient(u, dN, J_inv), expected, atol=1e-12)


def test_internal_force_is_the_derivative_of_the_energy():
    rng, dN, J_inv, weights = element_data()
    lame, mu, m = parameters(4)
    u, du = rng.standard_normal((2, 4, 5, 2))

    def energy(v):
        H = kernel.displacement_gradient(v, dN, J_inv)
        E = (H + H.swapaxes(-1, -2) + m[..., None, None] * H.swapaxes(-1, -2) @ H) / 2.0
        return np.sum(weights * (lame / 2.0 * np.trace(E, axis1=2, axis2=3) ** 2 + mu * np.sum(E * E, axis=(2, 3))))

    step = 1e-5
    difference = (energy(u + step * du) - energy(u - step * du)) / (2.0 * step)
    assert np.sum(force(u, dN, J_inv, weights) * du) == pytest.approx(difference, rel=1e-8)


def tangent(u, dN, J_inv, weights, S=None):
    lame, mu, m = parameters(len(u))
    H = kernel.displacement_gradient(u, dN, J_inv)
    S = kernel.stress(H, lame, mu, m) if S is None else S
    products = kernel.gradient_products(dN)
    return kernel.stiffness(kernel.deformation_gradient(H, m), S, lame, mu, m, products, J_inv, weights)


def test_stiffness_is_the_derivative_of_the_internal_force():
    rng, dN, J_inv, weights = element_data()
    u, du = rng.standard_normal((2, 4, 5, 2))
    K = tangent(u, dN, J_inv, weights)
    step = 1e-5
    difference = (force(u + step * du, dN, J_inv, weights) - force(u - step * du, dN, J_inv, weights)) / (2.0 * step)
    product = (K @ du.reshape(4, -1, 1)).reshape(4, 5, 2)
    np.testing.assert_allclose(product, difference, rtol=1e-6, atol=1e-6 * np.abs(product).max())
    np.testing.assert_allclose(K, K.transpose(0, 2, 1), atol=1e-12 * np.abs(K).max())


def test_given_stress_enters_the_geometric_stiffness_only():
    rng, dN, J_inv, weights = element_data()
    u, S = rng.standard_normal((4, 5, 2)), rng.standard_normal((4, 6, 3))
    change = tangent(u, dN, J_inv, weights, S) - tangent(u, dN, J_inv, weights, 0.0 * S)
    m = parameters(4)[2]
    gradients = np.einsum("qic,eqcd->eqid", dN, J_inv)
    scalar = np.einsum("eqid,eqdk,eqjk,eq->eij", gradients, dense(S), gradients, m * weights)
    expected = np.einsum("eij,ab->eiajb", scalar, I2).reshape(4, 10, 10)
    np.testing.assert_allclose(change, expected, atol=1e-11)


def test_quadratic_stress_is_what_linearisation_leaves_out():
    rng = np.random.default_rng(405)
    lame, mu, m = parameters(2)
    H, dH = rng.standard_normal((2, 2, 3, 2, 2))
    F = kernel.deformation_gradient(H, m)
    strain = (F.swapaxes(-1, -2) @ dH + dH.swapaxes(-1, -2) @ F) / 2.0
    linear = LAME * np.trace(strain, axis1=2, axis2=3)[..., None, None] * I2 + 2.0 * MU * strain
    rest = dense(kernel.stress(H + dH, lame, mu, m) - kernel.stress(H, lame, mu, m)) - linear
    np.testing.assert_allclose(dense(kernel.quadratic_stress(dH, lame, mu, m)), rest, atol=1e-13)


def test_loads_and_mass_integrate_the_basis():
    rng = np.random.default_rng(406)
    N = rng.random((6, 5))
    N /= N.sum(axis=1, keepdims=True)
    weights, density = rng.uniform(0.5, 1.5, (3, 6)), np.array([[1.0], [2.0], [5.0]])
    M = kernel.mass(N, weights, density)
    np.testing.assert_allclose(M, np.einsum("qi,qj,eq->eij", N, N, density * weights), rtol=1e-13)
    np.testing.assert_allclose(M.sum(axis=(1, 2)), (density * weights).sum(axis=1))
    f = rng.standard_normal((3, 6, 2))
    for integral in (kernel.body_force, kernel.traction_force):
        np.testing.assert_allclose(integral(N, weights, f).sum(axis=1), np.einsum("eq,eqa->ea", weights, f), rtol=1e-13)


def side_data(seed=407):
    rng = np.random.default_rng(seed)
    N, dN = rng.standard_normal((2, 4, 3))
    return rng, N, dN, rng.uniform(0.5, 1.5, (2, 4))


def test_pressure_pushes_against_the_outward_normal():
    # A straight side from (0, 0) to (2, 1), walked with the body on its left: the normal is (1, -2)/√5.
    N, dN = np.array([[0.5, 0.5]]), np.array([[-0.5, 0.5]])
    f = kernel.pressure_force(N, dN, np.array([[[0.0, 0.0], [2.0, 1.0]]]), np.array([[3.0 * 2.0]]))  # p = 3, weight 2
    np.testing.assert_allclose(f[0].sum(axis=0), [-3.0, 6.0], rtol=1e-14)


def test_pressure_stiffness_is_the_derivative_of_the_force():
    rng, N, dN, pressure = side_data()
    x, dx = rng.standard_normal((2, 2, 3, 2))
    K = kernel.pressure_stiffness(N, dN, pressure)
    difference = kernel.pressure_force(N, dN, x + dx, pressure) - kernel.pressure_force(N, dN, x, pressure)
    np.testing.assert_allclose((K @ dx.reshape(2, -1, 1)).reshape(2, 3, 2), difference, atol=1e-13)
