"""The airfoil and its C-grid."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from hoblock.errors import TemplateError
from hoblock.generate import generate
from hoblock.quality import equiangular_skewness, scaled_jacobian
from hoblock.templates import NacaProfile, NacaSurface, naca_c_grid

COEFFICIENTS = np.array([0.2969, -0.1260, -0.3516, 0.2843, -0.1036])
POWERS = np.array([0.5, 1.0, 2.0, 3.0, 4.0])


def half_thickness(x, thickness):
    return 5.0 * thickness * (COEFFICIENTS * x[:, None] ** POWERS).sum(axis=1)


def upper(profile, rear=False, distance=0.0):
    return NacaSurface(profile, 1, rear, distance)


def test_symmetric_airfoil_has_the_published_thickness():
    profile = NacaProfile.from_digits("0012")
    for rear in (False, True):
        points = upper(profile, rear)(np.linspace(0.0, 1.0, 23))
        np.testing.assert_allclose(points[:, 1], half_thickness(points[:, 0], 0.12), atol=1e-15)
    np.testing.assert_allclose(upper(profile, True)(np.array([1.0])), [[1.0, 0.0]], atol=1e-15)


def test_cambered_airfoil_has_the_published_ordinates():
    """NACA 2412 at 20 % (stations of Abbott and von Doenhoff, which are rounded to 0.01 %)."""
    profile = NacaProfile.from_digits("2412", closed=False)
    t = np.linspace(0.0, 1.0, 4001)
    for side, expected in ((1, 0.0726), (-1, -0.0423)):
        points = NacaSurface(profile, side, False)(t)
        assert np.interp(0.2, points[:, 0], points[:, 1]) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("digits", ["0012", "2412", "6409"])
def test_surface_is_regular_and_its_derivative_is_right(digits):
    profile = NacaProfile.from_digits(digits, chord=2.0, angle=0.3)
    tau, step = np.linspace(0.0, 0.6, 31), 1e-5
    for side in (1, -1):
        _, derivative = profile.surface(tau, side, False)
        difference = (profile.surface(tau + step, side, False)[0] - profile.surface(tau - step, side, False)[0]) / 2e-5
        np.testing.assert_allclose(derivative, difference, atol=1e-8)
        assert np.hypot(*derivative.T).min() > 0.1


def test_nose_is_smooth():
    """Both surfaces leave the nose in opposite directions, so that its normal is one."""
    profile = NacaProfile.from_digits("4412")
    tangents = [profile.surface(np.zeros(1), side, False)[1][0] for side in (1, -1)]
    np.testing.assert_allclose(tangents[0], -tangents[1], atol=1e-15)


def test_distance_is_measured_along_normals():
    profile = NacaProfile.from_digits("2412")
    t = np.linspace(0.0, 1.0, 17)
    gap = upper(profile, distance=0.1)(t) - upper(profile)(t)
    np.testing.assert_allclose(np.hypot(*gap.T), 0.1)
    tangents = profile.surface(t * profile.split, 1, False)[1]
    np.testing.assert_allclose((gap * tangents).sum(axis=1), 0.0, atol=1e-15)


def test_airfoil_converges_at_order_p_plus_one():
    """The curve is smooth in its parameter, at the nose too: interpolation reaches its order."""
    from hoblock.reference import gauss_lobatto, lagrange

    surface = upper(NacaProfile.from_digits("2412"))
    fine = np.linspace(-1.0, 1.0, 41)
    for order in (2, 3, 4):
        basis, nodes = lagrange(gauss_lobatto(order), fine), gauss_lobatto(order)
        errors = []
        for count in (4, 8, 16):
            ends = np.linspace(0.0, 1.0, count + 1)
            pairs = [0.5 * (a + b + (b - a) * x) for a, b in pairwise(ends) for x in (nodes, fine)]
            errors.append(
                max(np.abs(basis @ surface(n) - surface(f)).max() for n, f in zip(pairs[::2], pairs[1::2], strict=True))
            )
        assert math.log2(errors[1] / errors[2]) > order + 0.7


@pytest.mark.parametrize("first_height", [1e-4, 1e-6])
@pytest.mark.parametrize("digits", ["0012", "2412"])
def test_every_wall_node_has_the_first_height(digits, first_height, measure_first_heights):
    mesh = generate(naca_c_grid(digits=digits, first_height=first_height, chord=2.0), 4)
    heights = measure_first_heights(mesh, "airfoil")
    assert heights.shape == (40, 5)
    np.testing.assert_allclose(heights, 2.0 * first_height, rtol=1e-3)


def test_first_height_is_kept_when_counts_change(measure_first_heights):
    structure = naca_c_grid().with_counts({("n", "en"): 25, ("n", "mu"): 20})
    heights = measure_first_heights(generate(structure, 2), "airfoil")
    np.testing.assert_allclose(heights, 1e-4, rtol=1e-3)


def test_quality_of_the_default_grid():
    mesh = generate(naca_c_grid(), 4)
    quality = scaled_jacobian(mesh)
    assert quality.min() > 0.85
    assert quality.mean() > 0.98
    assert equiangular_skewness(mesh).max() < 0.35


@pytest.mark.parametrize(
    "parameters",
    [
        {"digits": "4412", "angle_of_attack": 15.0},
        {"digits": "6712", "angle_of_attack": -15.0, "closed": False},
        {"digits": "0006", "first_height": 1e-2},
        {"digits": "0030", "growth": 3.0, "elements_airfoil": 8},
        {"digits": "1101"},
        {"far_field_radius": 2.0, "wake_length": 1.0, "layer": 0.05},
        {"far_field_radius": 200.0, "wake_length": 300.0, "layer": 0.4, "growth": 2.0},
    ],
    ids=lambda parameters: "-".join(f"{value}" for value in parameters.values()),
)
def test_other_grids_are_certified(parameters):
    structure = naca_c_grid(**parameters)
    for order in (1, 3):
        quality = scaled_jacobian(generate(structure, order))
        assert quality.min() > 0.35
        assert quality.mean() > 0.9


def test_area_at_order_eight(measure_area):
    """The airfoil's sides are polynomials of degree 8 in the parameter, so their area is exact."""
    mesh = generate(
        naca_c_grid(digits="0015", far_field_radius=4.0, wake_length=3.0, growth=3.0, elements_airfoil=8), 8
    )
    airfoil = 2.0 * 5.0 * 0.15 * float(np.sum(COEFFICIENTS / (POWERS + 1.0)))
    assert measure_area(mesh) == pytest.approx(math.pi * 8.0 + 8.0 * 3.0 - airfoil, rel=1e-12)


def test_blunt_trailing_edge_has_a_strip():
    structure = naca_c_grid(closed=False, elements_base=2)
    topology = structure.topology
    gap = structure.vertices[topology.vertex("tu")] - structure.vertices[topology.vertex("tl")]
    np.testing.assert_allclose(gap, [0.0, 2.0 * 5.0 * 0.12 * 0.0021], atol=1e-15)
    assert len(topology.quads) == 13
    mesh = generate(structure, 2)
    assert len(mesh.edge_groups["airfoil"]) == 42


def test_angle_of_attack_turns_the_nose_up_about_the_quarter_chord():
    structure = naca_c_grid(angle_of_attack=10.0, chord=2.0)
    nose, tail = (structure.vertices[structure.topology.vertex(name)] for name in "nt")
    pivot = np.array([0.5, 0.0])
    assert nose[1] == pytest.approx(0.5 * math.sin(math.radians(10.0)))
    np.testing.assert_allclose(nose - pivot, (tail - pivot) / -3.0, atol=1e-14)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"digits": "12"}, "digits: got '12'; expected four digits such as '0012'"),
        ({"digits": 12}, "digits: got 12; expected a text"),
        ({"digits": "0000"}, "digits: got '0000'; expected a thickness"),
        ({"digits": "2012"}, "digits: got '2012'; expected first and second digit both 0"),
        ({"digits": "9940"}, "digits: got '9940' with layer = 0.25: .* Take a thinner layer or less camber"),
        ({"first_height": 0.3}, "first_height: got 0.3; expected less than layer = 0.25"),
        ({"layer": 0.6}, "layer: got 0.6; expected at most 0.5 chords"),
        ({"far_field_radius": 1.0}, "far_field_radius: got 1; expected at least 2 chords"),
        ({"trailing_edge_size": 0.3}, "trailing_edge_size: got 0.3; expected at most 0.2 chords"),
        ({"angle_of_attack": 90}, "angle_of_attack: got 90; expected a number >= -30 and <= 30"),
        ({"growth": 1.0}, "growth: got 1.0; expected a number > 1"),
    ],
)
def test_bad_parameters(parameters, message):
    with pytest.raises(TemplateError, match=message):
        naca_c_grid(**parameters)
