"""Valid, undecided, invalid: proven, never guessed."""

import tracemalloc

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.quality import (
    INVALID,
    UNDECIDED,
    VALID,
    certify,
    det_jacobian,
    det_jacobian_bounds,
    invalid_elements,
    subdivision,
)

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.2, 1.0), (0.0, 1.0)])
DART = np.array([(0.0, 0.0), (1.0, 0.0), (0.3, 0.3), (0.0, 1.0)])
FLAT_CORNER = np.array([(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.0, 1.0)])


@pytest.mark.parametrize("order", [1, 2, 3, 5, 8, 9, 12])
@pytest.mark.parametrize("amplitude", [0.05, 0.2, 0.5])
def test_status_and_bounds_against_dense_sampling(order, amplitude, elements, rng):
    mesh = elements.perturbed(rng, order, amplitude, 60)
    proof = certify(mesh)
    sampled = det_jacobian(mesh, elements.grid(np.linspace(-1, 1, 61)))
    assert np.all(sampled.min(axis=1)[proof.status == VALID] > 0)
    assert np.all(proof.status[sampled.min(axis=1) < -1e-9] == INVALID)
    assert np.all(proof.lower <= sampled.min(axis=1))
    assert np.all(proof.upper >= sampled.max(axis=1))
    assert np.all((proof.status == VALID) == (proof.lower > 0))
    assert proof.counts["undecided"] <= 1
    assert sum(proof.counts.values()) == 60


@pytest.mark.parametrize(
    ("order", "amplitude", "two", "four"), [(2, 0.33, 0.97, 0.995), (3, 0.25, 0.95, 0.99), (4, 0.2, 0.9, 0.99)]
)
def test_few_subdivisions_decide_heavily_distorted_elements(order, amplitude, two, four, elements, rng):
    mesh = elements.perturbed(rng, order, amplitude, 1000)
    decided = [np.mean(certify(mesh, subdivisions=k).status != UNDECIDED) for k in (0, 2, 4, 8)]
    assert decided[0] < 0.8
    assert decided == sorted(decided)
    assert decided[1] > two
    assert decided[2] > four
    assert decided[3] > 0.998


@pytest.mark.parametrize("order", [1, 2, 4, 7, 8, 16])
def test_a_corner_of_180_degrees_is_undecided(order, elements):
    proof = certify(elements.bilinear(FLAT_CORNER, order))
    assert proof.verdict == "undecided"
    assert not proof.valid
    assert -1e-3 < proof.min_det_J <= 0.0
    assert certify(elements.bilinear(DART, order)).verdict == "invalid"
    assert certify(elements.bilinear(SQUARE, order)).verdict == "valid"


@pytest.mark.parametrize("order", [1, 3, 8])
@pytest.mark.parametrize("offset", [1e-6, -1e-6])
def test_a_corner_of_almost_180_degrees_is_decided(order, offset, elements):
    corners = FLAT_CORNER + np.array([(0, 0), (0, 0), (offset, offset), (0, 0)])
    assert certify(elements.bilinear(corners, order)).verdict == ("valid" if offset > 0 else "invalid")


def test_an_element_with_a_side_of_no_length_is_undecided(elements):
    triangle = [(0, 0), (1, 0), (1, 0), (0, 1)]
    for order in (1, 2, 5, 8):
        assert certify(elements.bilinear(triangle, order)).verdict == "undecided"


@pytest.mark.parametrize("order", [1, 4, 9])
def test_an_element_of_no_area_is_never_valid(order, elements):
    flat = elements.bilinear([(0, 0), (1, 0), (1, 0), (0, 0)], order)
    point = elements.bilinear([(0.1, 0.3)] * 4, order)
    assert certify(flat).verdict == "invalid"  # all y are equal: det J = 0 exactly
    assert certify(point).verdict == "invalid"
    assert certify(flat).min_det_J == 0.0
    skew = elements.bilinear([(0, 0), (1, 0.3), (1, 0.3), (0, 0)], order)
    assert certify(skew).verdict != "valid"


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1e-154, 1e-20, 1e20, 1e154, 1e200, 1e300, 1.2e308])
@pytest.mark.parametrize("order", [1, 2, 6])
def test_size_does_not_matter(size, order, elements):
    centred = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])  # differences of 2.4e308 overflow
    for corners, verdict in ((SQUARE, "valid"), (DART, "invalid"), (centred, "valid"), (centred[::-1], "invalid")):
        mesh = elements.bilinear(corners, order)
        assert certify(mesh.with_points(size * mesh.points)).verdict == verdict


def test_tiny_and_huge_elements_side_by_side(elements):
    both = np.stack([1e-200 * SQUARE, 1e200 * SQUARE, 1e-200 * DART])[:, [0, 1, 3, 2]]
    np.testing.assert_array_equal(certify(elements.of(both, 1)).status, [VALID, VALID, INVALID])


@pytest.mark.parametrize("offset", [1e3, 1e8])
@pytest.mark.parametrize("order", [2, 5, 8])
def test_distance_from_the_origin_does_not_matter(offset, order, elements, rng):
    mesh = elements.perturbed(rng, order, 0.2, 50)
    shift = np.array([offset, -2 * offset])
    moved = mesh.with_points(mesh.points + shift)
    # The moved nodes are rounded; moved back they are another mesh with the same certificate.
    back = moved.with_points(moved.points - shift)
    first, second = certify(moved), certify(back)
    np.testing.assert_array_equal(first.status, second.status)
    np.testing.assert_allclose(first.lower, second.lower, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("ratio", [1e2, 1e4])
@pytest.mark.parametrize("order", [1, 2, 4, 8])
def test_slender_elements_at_any_angle_are_decided(ratio, order, elements):
    for degrees in (0, 30, 45, 89):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        corners = (SQUARE * [1.0, 1.0 / ratio]) @ np.array([(c, s), (-s, c)])
        assert certify(elements.bilinear(corners, order)).verdict == "valid"
        assert certify(elements.bilinear(corners[::-1], order)).verdict == "invalid"


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("order", [1, 3, 8])
def test_nodes_that_are_not_finite_are_invalid(value, order, elements):
    mesh = elements.of(np.repeat(elements.bilinear(SQUARE, order).coordinates, 3, axis=0), order)
    points = np.array(mesh.points)
    points[(order + 1) ** 2, 1] = value
    mesh = mesh.with_points(points)
    proof = certify(mesh)
    np.testing.assert_array_equal(proof.status, [VALID, INVALID, VALID])
    assert (proof.lower[1], proof.upper[1]) == (-np.inf, np.inf)
    (bad,) = invalid_elements(mesh)
    assert bad.element == 1
    assert bad.reason == "Its nodes are not finite."


def test_rounding_errors_are_part_of_the_bounds(elements, rng):
    """det J in exact arithmetic at nodes that are floats, against bounds that double precision gives."""
    from fractions import Fraction

    # A sliver whose det J at its corners is of the size of rounding errors.
    a, b, d = np.array([(0.0, 0.0), (1.0, 1.0 / 3.0), (0.7, 0.7 / 3.0)])
    for ulps in range(-6, 7):
        e = d + np.array([0.0, ulps * np.spacing(d[1])])
        corners = np.array([a, b, b + e, e])
        x = [[Fraction(v) for v in corner] for corner in corners]
        exact = []
        for k in range(4):
            p, q, r = x[k], x[(k + 1) % 4], x[k - 1]
            exact.append(((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) / 4)
        proof = certify(elements.of(corners[[0, 1, 3, 2]][None], 1))
        assert proof.lower[0] <= min(exact) <= max(exact) <= proof.upper[0]
        assert not (proof.verdict == "valid" and min(exact) <= 0)
        assert not (proof.verdict == "invalid" and min(exact) > 0)


def test_doubtful_elements_come_worst_first(elements):
    corners = np.stack([SQUARE, FLAT_CORNER, DART, 2.0 * DART])[:, [0, 1, 3, 2]]
    proof = certify(elements.of(corners, 1))
    np.testing.assert_array_equal(proof.doubtful, [3, 2, 1])
    assert proof.counts == {"valid": 1, "undecided": 1, "invalid": 2}
    assert proof.verdict == "invalid"
    assert proof.status.dtype == np.int8
    assert not proof.status.flags.writeable


def test_valid_meshes_are_certified(layouts, rng):
    for kind in layouts.valences:
        assert certify(generate(layouts.random(kind, rng), 3)).valid


def test_memory_stays_small(elements, rng):
    mesh = elements.perturbed(rng, 4, 0.02, count=20_000)
    tracemalloc.start()
    assert certify(mesh).valid
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 0.2 * mesh.points.nbytes + 1.5e7


@pytest.mark.parametrize("order", [1, 4, 8])
def test_degenerate_elements_cost_no_more_than_others(order, elements, monkeypatch):
    """No piece of them can be settled; what rounding errors hide must not be cut to the last."""
    looked_at = []

    def counted(nodes, order, level, pieces):
        looked_at.append(len(pieces.owner))
        return bound(nodes, order, level, pieces)

    bound = subdivision._bound
    monkeypatch.setattr(subdivision, "_bound", counted)
    for corners in ([(0, 0), (1, 0.3), (1, 0.3), (0, 0)], [(0, 0), (1, 0.1), (1, 0.1), (0.2, 1)], FLAT_CORNER):
        looked_at.clear()
        assert certify(elements.bilinear(corners, order)).verdict == "undecided"
        assert sum(looked_at) < 50


@pytest.mark.parametrize("subdivisions", [-1, 13, 1.5, True])
def test_bad_numbers_of_subdivisions(subdivisions, elements):
    for function in (certify, det_jacobian_bounds):
        with pytest.raises(ValueError, match=r"subdivisions is .* expected an integer from 0 to 12"):
            function(elements.bilinear(SQUARE), subdivisions=subdivisions)
