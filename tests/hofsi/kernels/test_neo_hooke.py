from __future__ import annotations

from decimal import Decimal, getcontext

import numpy as np
import pytest

from hofsi.kernels import elasticity
from hofsi.kernels import neo_hooke as kernel

LAME, MU = 3.0, 1.7
PLANES = pytest.mark.parametrize("plane_stress", [False, True])
I2 = np.eye(2)


def dense(S):
    """(…, 3) to (…, 2, 2)."""
    return np.stack([S[..., 0], S[..., 2], S[..., 2], S[..., 1]], axis=-1).reshape(*S.shape[:-1], 2, 2)


def parameters(count=1):
    return LAME * np.ones((count, 1)), MU * np.ones((count, 1))


def stress(H, plane_stress, count=1):
    return kernel.stress(H, *parameters(count), plane_stress=plane_stress)


def thickness_squared(J2):
    """C_zz in plane stress by bisection of the definition."""
    low, high = 1e-12 * np.ones_like(J2), 1e12 * np.ones_like(J2)
    for _ in range(200):
        c = np.sqrt(low * high)
        above = MU * (c - 1.0) + LAME * np.log(J2 * np.sqrt(c)) > 0.0
        low, high = np.where(above, low, c), np.where(above, c, high)
    return c


def energy(H, plane_stress):
    F = H + I2
    J2 = np.linalg.det(F)
    c = thickness_squared(J2) if plane_stress else np.ones_like(J2)
    J = J2 * np.sqrt(c)
    trace = np.sum(F * F, axis=(-2, -1)) + c
    return MU / 2.0 * (trace - 3.0) - MU * np.log(J) + LAME / 2.0 * np.log(J) ** 2


def gradients(count=3, points=4, size=0.3, seed=601):
    rng = np.random.default_rng(seed)
    return rng, elasticity.components_outermost(size * rng.uniform(-1.0, 1.0, (count, points, 2, 2)))


def element_data(elements=3, nodes=5, points=6, seed=602):
    rng = np.random.default_rng(seed)
    dN = rng.standard_normal((points, nodes, 2))
    J_inv = elasticity.components_outermost(rng.standard_normal((elements, points, 2, 2)))
    return rng, dN, J_inv, rng.uniform(0.5, 1.5, (elements, points))


@PLANES
def test_stress_follows_its_definition(plane_stress):
    _, H = gradients()
    S = dense(stress(H, plane_stress, 3))
    F = H + I2
    C, J2 = F.swapaxes(-1, -2) @ F, np.linalg.det(F)
    J = J2 * np.sqrt(thickness_squared(J2)) if plane_stress else J2
    inverse = np.linalg.inv(C)
    expected = MU * (I2 - inverse) + (LAME * np.log(J))[..., None, None] * inverse
    np.testing.assert_allclose(S, expected, rtol=1e-11, atol=1e-12)


@PLANES
def test_stress_is_the_derivative_of_the_energy(plane_stress):
    rng, H = gradients()
    dH = rng.standard_normal(H.shape)
    step = 1e-5
    difference = (energy(H + step * dH, plane_stress) - energy(H - step * dH, plane_stress)) / (2.0 * step)
    P = (H + I2) @ dense(stress(H, plane_stress, 3))
    np.testing.assert_allclose(np.sum(P * dH, axis=(-2, -1)), difference, rtol=1e-7, atol=1e-8)


@PLANES
def test_rotations_give_no_stress_and_do_not_change_it(plane_stress):
    for angle in (0.3, 2.0, -1.1):
        R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        np.testing.assert_allclose(stress((R - I2)[None, None], plane_stress), 0.0, atol=1e-15)
        _, H = gradients(1)
        turned = R @ (H + I2) - I2
        np.testing.assert_allclose(stress(turned, plane_stress), stress(H, plane_stress), rtol=1e-12, atol=1e-14)


@PLANES
def test_simple_shear_in_both_plane_cases(plane_stress):
    """Without a change of volume: S = μ (I - C⁻¹)."""
    g = 0.4
    S = stress(np.array([[[[0.0, g], [0.0, 0.0]]]]), plane_stress)[0, 0]
    np.testing.assert_allclose(S, [-MU * g**2, 0.0, MU * g], atol=1e-15)


def decimal_stress(e, plane_stress):
    """S_xx and S_yy at a uniaxial strain H_xx = e, with 50 digits."""
    getcontext().prec = 50
    lame, mu, one = Decimal(LAME), Decimal(MU), Decimal(1)
    stretch = one + Decimal(e)
    log, c = stretch.ln(), one
    if plane_stress:
        for _ in range(30):
            c -= (mu * (c - 1) + lame * (log + c.ln() / 2)) / (mu + lame / (2 * c))
    p = lame * (log + c.ln() / 2)
    return [float(mu * (1 - 1 / stretch**2) + p / stretch**2), float(p)]


@PLANES
@pytest.mark.parametrize("e", [1e-12, -1e-9, 1e-5, -0.3])
def test_small_strains_keep_their_digits(plane_stress, e):
    S = stress(np.array([[[[e, 0.0], [0.0, 0.0]]]]), plane_stress)[0, 0]
    np.testing.assert_allclose(S[:2], decimal_stress(e, plane_stress), rtol=1e-13)
    assert S[2] == 0.0


@PLANES
def test_small_strains_are_those_of_linear_elasticity(plane_stress):
    E, nu = 2.5, 0.3
    plane = elasticity.plane_lame_parameters(E, nu, stress=plane_stress)
    lame, mu = (value * np.ones((3, 1)) for value in elasticity.plane_lame_parameters(E, nu, stress=False))
    _, H = gradients(size=1e-9)
    linear = elasticity.stress(H, plane[0] * np.ones((3, 1)), mu, np.zeros((3, 1)))
    found = kernel.stress(H, lame, mu, plane_stress=plane_stress)
    np.testing.assert_allclose(found, linear, rtol=1e-6, atol=1e-6 * np.abs(linear).max())


@pytest.mark.parametrize("ratio", [-0.6, 0.0, 0.01, 1.0, 1e4])
def test_thickness_solves_its_equation_for_all_area_ratios(ratio):
    lowest = 1e-2 if ratio >= 0.0 else 0.7
    log_area = np.log(np.geomspace(lowest, 1e2, 41))
    y = kernel.log_thickness(log_area, ratio, 1.0)
    residual = np.expm1(2.0 * y) + ratio * (log_area + y)
    np.testing.assert_allclose(residual, 0.0, atol=1e-12 * (1.0 + ratio + np.exp(2.0 * y).max()))


def test_thickness_without_a_solution_is_not_a_number():
    assert np.isnan(kernel.log_thickness(np.array([-3.0]), -0.6, 1.0)).all()


@PLANES
def test_inverted_elements_have_no_finite_stress(plane_stress):
    H = np.array([[-1.5, 0.0], [0.0, 0.0]])
    flat = np.array([[-1.0, 0.0], [0.0, 0.0]])
    for gradient in (H, flat):
        assert not np.isfinite(stress(gradient[None, None], plane_stress)).all()


@PLANES
def test_stress_out_of_plane(plane_stress):
    _, H = gradients()
    across, thickness = kernel.out_of_plane(H, *parameters(3), plane_stress=plane_stress)
    J2 = np.linalg.det(H + I2)
    if plane_stress:
        np.testing.assert_allclose(thickness**2, thickness_squared(J2), rtol=1e-12)
        assert not across.any()
    else:
        np.testing.assert_allclose(across, LAME * np.log(J2), rtol=1e-12, atol=1e-14)
        assert (thickness == 1.0).all()


def force(u, dN, J_inv, weights, plane_stress):
    H = elasticity.displacement_gradient(u, dN, J_inv)
    F = elasticity.deformation_gradient(H, np.ones((len(u), 1)))
    return elasticity.internal_force(F, stress(H, plane_stress, len(u)), dN, J_inv, weights)


@PLANES
def test_stiffness_is_the_derivative_of_the_internal_force(plane_stress):
    rng, dN, J_inv, weights = element_data()
    u, du = 0.06 * rng.standard_normal((2, 3, 5, 2))
    H = elasticity.displacement_gradient(u, dN, J_inv)
    assert 0.3 < np.linalg.det(H + I2).min() < 0.95
    products = elasticity.gradient_products(dN)
    S = stress(H, plane_stress, 3)
    K = kernel.stiffness(H, S, *parameters(3), products, J_inv, weights, plane_stress=plane_stress)
    step = 1e-5
    plus, minus = (force(u + s * du, dN, J_inv, weights, plane_stress) for s in (step, -step))
    product = (K @ du.reshape(3, -1, 1)).reshape(3, 5, 2)
    np.testing.assert_allclose(product, (plus - minus) / (2.0 * step), atol=1e-7 * np.abs(product).max())
    np.testing.assert_allclose(K, K.transpose(0, 2, 1), atol=1e-12 * np.abs(K).max())


@PLANES
def test_linearised_stress_leaves_out_the_second_order(plane_stress):
    rng, H = gradients()
    dH = elasticity.components_outermost(rng.standard_normal(H.shape))
    errors = []
    for step in (1e-2, 1e-3):
        S, new = stress(H, plane_stress, 3), stress(H + step * dH, plane_stress, 3)
        linear = kernel.linearised_stress(H, S, step * dH, S, *parameters(3), plane_stress=plane_stress)
        errors.append(np.abs(linear - new).max())
    assert np.log10(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


@PLANES
def test_stiffness_and_linearised_stress_take_the_same_pressure(plane_stress):
    """∫ (F dS + ΔH S):∇N of the stress S that the stiffness is made with, whatever that is."""
    rng, dN, J_inv, weights = element_data()
    u, du = 0.06 * rng.standard_normal((2, 3, 5, 2))
    H, dH = (elasticity.displacement_gradient(part, dN, J_inv) for part in (u, du))
    own = stress(H, plane_stress, 3)
    used = own + 0.5 * np.abs(own).max() * np.moveaxis(rng.standard_normal((3, *own.shape[:2])), 0, 2)
    products = elasticity.gradient_products(dN)
    K = kernel.stiffness(H, used, *parameters(3), products, J_inv, weights, plane_stress=plane_stress)
    linear = kernel.linearised_stress(H, own, dH, used, *parameters(3), plane_stress=plane_stress)
    expected = elasticity.internal_force(
        elasticity.deformation_gradient(H, np.ones((3, 1))), linear - own, dN, J_inv, weights
    )
    expected += elasticity.internal_force(dH, used, dN, J_inv, weights)
    product = (K @ du.reshape(3, -1, 1)).reshape(3, 5, 2)
    np.testing.assert_allclose(product, expected, atol=1e-12 * np.abs(expected).max())
    same = kernel.stiffness(H, own, *parameters(3), products, J_inv, weights, plane_stress=plane_stress)
    assert np.abs(K - same).max() > 0.01 * np.abs(same).max()


def work(start, end, plane_stress):
    """(S*:ΔC/2, S*) of a step."""
    count = len(start)
    S = kernel.mean_stress(0.5 * (start + end), start, *parameters(count), plane_stress=plane_stress)
    change = end - start + (end - start).swapaxes(-1, -2)
    change = change + end.swapaxes(-1, -2) @ end - start.swapaxes(-1, -2) @ start
    return 0.5 * np.sum(dense(S) * change, axis=(-2, -1)), S


@PLANES
@pytest.mark.parametrize("size", [1.0, 0.1, 1e-2])
def test_work_of_the_mean_stress_is_the_change_of_energy(plane_stress, size):
    rng, start = gradients(5)
    end = start + 0.3 * size * rng.uniform(-1.0, 1.0, start.shape)
    done, _ = work(start, end, plane_stress)
    np.testing.assert_allclose(done, energy(end, plane_stress) - energy(start, plane_stress), rtol=1e-10, atol=1e-13)


@PLANES
@pytest.mark.parametrize("size", [1e-3, 1e-6, 1e-9, 1e-13, 0.0])
def test_mean_stress_of_small_steps_is_that_of_the_middle(plane_stress, size):
    """No digits are lost, also where the quotient is one of zeros."""
    rng, start = gradients(5)
    end = start + size * rng.uniform(-1.0, 1.0, start.shape)
    _, S = work(start, end, plane_stress)
    middle = stress(0.5 * (start + end), plane_stress, 5)
    np.testing.assert_allclose(S, middle, atol=1e-13 + 20.0 * size**2)


@PLANES
def test_step_that_ends_turned_inside_out_has_no_stress(plane_stress):
    start, end = np.zeros((1, 1, 2, 2)), np.array([[[[-1.8, 0.0], [0.0, 0.0]]]])
    with np.errstate(all="ignore"):
        assert not np.isfinite(work(start, end, plane_stress)[1]).all()
