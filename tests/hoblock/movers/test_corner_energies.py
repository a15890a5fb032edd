"""Energies of corners: their derivatives, their minimum, their barrier."""

import numpy as np
import pytest

from hoblock.movers._corner_energies import AngleEnergy, DistortionEnergy, positive_part

RNG = np.random.default_rng(7)


def corners(count=40):
    """Corners with angles from 20° to 160° and edges of different length."""
    angle, start = RNG.uniform(np.radians(20), np.radians(160), count), RNG.uniform(0, 2 * np.pi, count)
    a, b = RNG.uniform(0.3, 3.0, (2, count))
    return np.stack([a * np.cos(start), a * np.sin(start), b * np.cos(start + angle), b * np.sin(start + angle)])


def turned_over(z):
    """The same with e and f exchanged in every second corner, so that its cross product is negative."""
    z = z.copy()
    z[:, ::2] = z[[2, 3, 0, 1], ::2]
    return z


ENERGIES = {
    "bar": lambda z: DistortionEnergy(z, 1.0, 0.0),
    "bar, emphasised": lambda z: DistortionEnergy(z, 0.4, 3.0),
    "ang": AngleEnergy,
}


@pytest.mark.parametrize("name", ENERGIES)
@pytest.mark.parametrize("epsilon", [0.0, 0.3])
def test_derivatives_are_those_of_the_values(name, epsilon):
    energy = ENERGIES[name](corners())
    z = corners() if epsilon == 0.0 else turned_over(corners())
    found = energy.derivatives(z, epsilon)
    np.testing.assert_allclose(found.value, energy.values(z, epsilon)[0], rtol=1e-13)
    h = 1e-6
    for i in range(4):
        step = np.zeros_like(z)
        step[i] = h
        up, down = energy.derivatives(z + step, epsilon), energy.derivatives(z - step, epsilon)
        size = 1.0 + np.abs(found.hessian).max(axis=(0, 1))
        np.testing.assert_allclose((up.value - down.value) / (2 * h) / size, found.gradient[i] / size, atol=1e-7)
        np.testing.assert_allclose((up.gradient - down.gradient) / (2 * h) / size, found.hessian[i] / size, atol=1e-6)
    np.testing.assert_allclose(found.hessian, found.hessian.transpose(1, 0, 2), atol=1e-9 * np.abs(found.hessian).max())


@pytest.mark.parametrize("emphasis", [0.0, 2.0])
def test_the_reference_and_what_is_turned_has_no_distortion_and_all_else_has(emphasis):
    z = corners()
    energy = DistortionEnergy(z, 1.0, emphasis)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s], [s, c]])
    turned = np.concatenate([turn @ z[:2], turn @ z[2:]])
    for same in (z, turned):
        found = energy.derivatives(same, 0.0)
        np.testing.assert_allclose(found.value, 0.0, atol=1e-14)
        np.testing.assert_allclose(found.gradient, 0.0, atol=1e-12)
        assert np.linalg.eigvalsh(found.hessian.transpose(2, 0, 1)).min() > -1e-12
    assert (energy.values(corners(), 0.0)[0] > 1e-3).all()


def test_the_angle_energy_is_smallest_at_right_angles_whatever_the_lengths():
    z0 = np.array([[1.0], [0.0], [0.5], [2.0]])
    energy = AngleEnergy(z0)
    angles = np.radians([30.0, 60.0, 89.0, 90.0, 91.0, 120.0, 150.0])
    values = [energy.values(np.array([[3.0], [0.0], [np.cos(a)], [np.sin(a)]]), 0.0)[0][0] for a in angles]
    sine = 2.0 / np.hypot(0.5, 2.0)
    np.testing.assert_allclose(values, sine**2 / np.sin(angles) ** 2, rtol=1e-12)


@pytest.mark.parametrize("name", ENERGIES)
def test_energies_grow_without_bound_towards_flat_corners(name):
    z = np.array([[1.0], [0.0], [0.0], [1.0]])
    energy = ENERGIES[name](z)
    values = [energy.values(np.array([[1.0], [0.0], [np.cos(a)], [np.sin(a)]]), 0.0)[0][0] for a in (1e-2, 1e-4, 1e-6)]
    assert values[0] > 10.0
    assert values[1] > 50.0 * values[0]
    assert values[2] > 50.0 * values[1]


def test_the_positive_part_is_smooth_and_positive():
    d = np.array([-1e9, -3.0, -1e-3, 0.0, 1e-3, 2.0, 1e9])
    for epsilon in (1e-6, 0.5):
        h, h1, h2 = positive_part(d, epsilon)
        assert (h > 0.0).all()
        left = d <= 0.0
        np.testing.assert_allclose((h * (h - d))[left], 0.25 * epsilon**2, rtol=1e-12)  # h² - d h - ε²/4 = 0
        np.testing.assert_allclose(h[~left], 0.5 * (d + np.hypot(d, epsilon))[~left], rtol=1e-15)
        assert ((h1 >= 0.0) & (h1 <= 1.0)).all()
        assert (h2 >= 0.0).all()
