"""Measures of elements against figures by hand."""

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.generate import generate
from hoblock.grading import Listed
from hoblock.mesh import QuadMesh
from hoblock.quality import (
    aspect_ratio,
    det_jacobian,
    element_areas,
    equiangular_skewness,
    jacobian_ratio,
    minimum_det_jacobian,
    scaled_jacobian,
    size_jump,
)
from hoblock.quality.neighbours import neighbours

MEASURES = (scaled_jacobian, jacobian_ratio, equiangular_skewness, aspect_ratio)


def test_measures_of_the_square_and_of_a_parallelogram(elements):
    square = elements.bilinear([(0, 0), (2, 0), (2, 2), (0, 2)])
    for measure, expected in zip(MEASURES, (1, 1, 0, 1), strict=True):
        np.testing.assert_allclose(measure(square), expected, atol=1e-15)
    assert element_areas(square) == pytest.approx(4.0)
    angle = np.radians(50)
    shear = np.array([np.cos(angle), np.sin(angle)])
    rhomboid = elements.bilinear([(0, 0), (3, 0), shear + np.array([3, 0]), shear], order=3)
    assert scaled_jacobian(rhomboid) == pytest.approx(np.sin(angle))
    assert jacobian_ratio(rhomboid) == pytest.approx(1.0)
    assert equiangular_skewness(rhomboid) == pytest.approx(40 / 90)
    assert minimum_det_jacobian(rhomboid) == pytest.approx(3 * np.sin(angle) / 4)
    assert aspect_ratio(rhomboid) == pytest.approx(3.0)
    assert element_areas(rhomboid) == pytest.approx(3 * np.sin(angle))


def test_measures_of_a_trapezoid(elements):
    mesh = elements.bilinear([(0, 0), (4, 0), (3, 1), (1, 1)])
    assert jacobian_ratio(mesh) == pytest.approx(0.5)  # the lengths of the parallel sides
    assert scaled_jacobian(mesh) == pytest.approx(np.sin(np.pi / 4))
    assert equiangular_skewness(mesh) == pytest.approx(0.5)
    assert aspect_ratio(mesh) == pytest.approx(3.0)
    assert element_areas(mesh) == pytest.approx(3.0)


def test_skewness_sees_a_corner_of_each_kind(elements):
    # A measure that mistakes an angle for its supplement gives the same maximum for symmetric quads; a kite with the
    # angles 30°, 110°, 110°, 110° tells.
    tip = np.radians(30)
    # The far corner lies on the bisector where the sides from (1, 0) leave at 110°.
    length = np.sin(np.radians(110)) / np.sin(np.radians(180 - 15 - 110))
    far = length * np.array([np.cos(tip / 2), np.sin(tip / 2)])
    kite = np.array([(0, 0), (1, 0), far, (np.cos(tip), np.sin(tip))])
    for shift in range(4):
        mesh = elements.bilinear(np.roll(kite, shift, axis=0))
        assert equiangular_skewness(mesh) == pytest.approx(60 / 90, rel=1e-12)


def test_scaled_jacobian_is_signed(elements):
    dart = elements.bilinear([(0, 0), (1, 0), (0.3, 0.3), (0, 1)])
    assert scaled_jacobian(dart)[0] < 0
    assert equiangular_skewness(dart)[0] > 1
    mirrored = elements.bilinear([(0, 0), (-1, 0), (-1, 1), (0, 1)])
    assert scaled_jacobian(mirrored) == pytest.approx(-1)
    assert jacobian_ratio(mirrored) == -np.inf
    assert element_areas(mirrored) == pytest.approx(-1)


@pytest.mark.parametrize("order", [4, 8])
def test_aspect_ratio_follows_curved_mid_lines(order, elements):
    """A sector of a ring: its mid lines are an arc of the mean radius and a radius."""

    def sector(xi, eta):
        radius, angle = 1.5 + 0.5 * eta, 0.5 * xi
        return radius * np.sin(angle), radius * np.cos(angle)

    mesh = elements.mapped(sector, order)
    assert aspect_ratio(mesh) == pytest.approx(1.5, rel=10.0 ** -(order + 1))


@pytest.mark.parametrize("order", [1, 2, 5, 8])
def test_areas_are_exact(order, elements, rng):
    mesh = elements.perturbed(rng, order, 0.2, 10)
    points, weights = np.polynomial.legendre.leggauss(2 * order + 1)
    exact = det_jacobian(mesh, elements.grid(points)) @ np.outer(weights, weights).ravel()
    np.testing.assert_allclose(element_areas(mesh), exact, rtol=1e-12)


def test_size_and_place_do_not_matter(elements, rng):
    mesh = elements.perturbed(rng, 3, 0.2, 10)
    for scale, offset in ((1e-200, 0.0), (1e200, 0.0), (1.0, 1e6)):
        other = mesh.with_points(scale * (mesh.points + offset))
        for measure in MEASURES:
            np.testing.assert_allclose(measure(other), measure(mesh), rtol=1e-8)


def test_points_that_are_not_finite_give_nan(elements):
    points = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (np.nan, 1.0)])
    mesh = elements.of(points[None], 1)
    for measure in (*MEASURES, element_areas, size_jump):
        assert np.isnan(measure(mesh)[0]) or measure is size_jump


def test_an_element_without_width(elements):
    flat = elements.bilinear([(0, 0), (0, 0), (0, 1), (0, 1)])
    assert aspect_ratio(flat) == np.inf
    assert scaled_jacobian(flat) == 0.0


@pytest.mark.parametrize("samples", [0, 1])
def test_too_few_samples(samples, elements):
    with pytest.raises(ValueError, match=r"samples is \d; expected an integer >= 2"):
        scaled_jacobian(elements.bilinear([(0, 0), (1, 0), (1, 1), (0, 1)]), samples)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_neighbours_share_two_corners(order, layouts, rng):
    for kind in layouts.valences:
        mesh = generate(layouts.random(kind, rng), order)
        corners = [set(c) for c in mesh.corners.tolist()]
        expected = {
            (a, b) for a in range(len(corners)) for b in range(a + 1, len(corners)) if len(corners[a] & corners[b]) == 2
        }
        found = [tuple(sorted(pair)) for pair in neighbours(mesh).tolist()]
        assert len(found) == len(set(found))
        assert set(found) == expected


def test_neighbours_around_a_hole():
    """Two half rings share the corners of their inner and of their outer sides, but not these sides."""
    angle = np.pi * np.arange(4) / 2.0
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = np.concatenate([circle, 1.5 * circle, 2.0 * circle])
    around = np.array([(0, 1, 2), (2, 3, 0)])
    cells = np.concatenate([around[:, ::-1] + 4 * ring for ring in range(3)], axis=1)
    pairs = neighbours(QuadMesh(points, cells, 2, {}, {}))
    assert pairs.tolist() == [[0, 1], [0, 1]]  # across both cuts


def test_size_jump_of_a_graded_strip():
    vertices = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    grading = Listed((0.0, 0.1, 0.4, 1.0))
    structure = BlockStructure.build(
        vertices, [(0, 1, 2, 3)], counts={(0, 1): 3}, gradings={(0, 1): grading, (3, 2): grading}
    )
    np.testing.assert_allclose(size_jump(generate(structure, 2)), [3.0, 3.0, 2.0])
    single = generate(BlockStructure.build(vertices, [(0, 1, 2, 3)]), 2)
    assert size_jump(single) == 1.0


def test_size_jump_next_to_an_inverted_element_is_infinite():
    points = np.array([(0, 0), (1, 0), (0, 1), (1, 1), (0.5, 0), (0.5, 1)], dtype=float)
    mesh = QuadMesh(points, np.array([(0, 1, 2, 3), (1, 4, 3, 5)]), 1, {}, {})
    np.testing.assert_array_equal(size_jump(mesh), [np.inf, np.inf])
