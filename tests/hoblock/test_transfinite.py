import dataclasses

import numpy as np
import pytest

from hoblock.transfinite import TransfiniteWeights, interior_points, reference_positions


def edges_of(function, bottom, top, left, right):
    """Nodes on the edges of blocks x(u, v) at their own parameters."""
    zero, one = np.zeros_like, np.ones_like
    sides = (bottom, zero(bottom)), (top, one(top)), (zero(left), left), (one(right), right)
    return tuple(function(u, v) for u, v in sides)


def parameters(rng, blocks, count):
    inner = np.sort(rng.uniform(0.05, 0.95, (blocks, count)), axis=1)
    return np.concatenate([np.zeros((blocks, 1)), inner, np.ones((blocks, 1))], axis=1)


def bilinear(u, v):
    return np.stack([2 * u + 0.3 * v + 0.4 * u * v, -0.2 * u + 1.5 * v - 0.3 * u * v], axis=-1)


def polynomial(u, v):
    """Linear in u or in v in every term: what the map reproduces."""
    return np.stack([u + 0.3 * v * u**4 - 0.1 * v**3, v + 0.2 * u * v**5 + 0.1 * u**2], axis=-1)


@pytest.mark.parametrize("function", [bilinear, polynomial])
def test_exact_on_bilinear_blocks_and_on_polynomials_linear_in_one_coordinate(function, rng):
    u, v = parameters(rng, 3, 5), parameters(rng, 3, 4)
    points = interior_points(TransfiniteWeights.from_parameters(u, u, v, v), *edges_of(function, u, u, v, v))
    exact = function(u[:, None, 1:-1] + 0 * v[:, 1:-1, None], v[:, 1:-1, None] + 0 * u[:, None, 1:-1])
    assert points.shape == (3, 4, 5, 2)
    np.testing.assert_allclose(points, exact, atol=1e-14)


def test_not_exact_where_a_term_is_linear_in_neither_coordinate(rng):
    def biquadratic(u, v):
        return np.stack([u, v + u**2 * v**2], axis=-1)

    u, v = parameters(rng, 1, 3), parameters(rng, 1, 3)
    points = interior_points(TransfiniteWeights.from_parameters(u, u, v, v), *edges_of(biquadratic, u, u, v, v))
    inner_u, inner_v = np.broadcast_arrays(u[:, None, 1:-1], v[:, 1:-1, None])
    # The map interpolates u² by u and v² by v together: the error is the product of both interpolation errors.
    error = (points - biquadratic(inner_u, inner_v))[..., 1]
    expected = -(inner_u - inner_u**2) * (inner_v - inner_v**2)
    np.testing.assert_allclose(error, expected, atol=1e-14)


def test_product_form_is_the_form_node_by_node(rng):
    u, v = parameters(rng, 4, 6), parameters(rng, 4, 3)
    edges = [rng.standard_normal((4, k, 2)) for k in (8, 8, 5, 5)]
    bottom, top, left, right = edges
    for u_side, v_end in ((bottom, 0), (top, -1)):
        left[:, v_end], right[:, v_end] = u_side[:, 0], u_side[:, -1]
    product = TransfiniteWeights.from_parameters(u, u, v, v)
    assert product.inner is None
    full = dataclasses.replace(product, inner=tuple(np.broadcast_arrays(u[:, None, 1:-1], v[:, 1:-1, None])))
    np.testing.assert_allclose(interior_points(product, *edges), interior_points(full, *edges), atol=1e-13)


def test_positions_are_intersections_of_the_lines_between_equal_indices(rng):
    bottom, top = parameters(rng, 2, 4), parameters(rng, 2, 4)
    left, right = parameters(rng, 2, 3), parameters(rng, 2, 3)
    u, v = reference_positions(bottom, top, left, right)
    assert u.shape == (2, 5, 6)
    np.testing.assert_allclose(u, bottom[:, None] + v * (top - bottom)[:, None], atol=1e-14)
    np.testing.assert_allclose(v, left[:, :, None] + u * (right - left)[:, :, None], atol=1e-14)


def test_exact_on_parallelograms_with_different_gradings_on_opposite_edges(rng):
    def affine(u, v):
        return np.stack([2 * u + 0.3 * v - 1, 0.4 * u + 1.5 * v], axis=-1)

    sides = parameters(rng, 2, 4), parameters(rng, 2, 4), parameters(rng, 2, 3), parameters(rng, 2, 3)
    weights = TransfiniteWeights.from_parameters(*sides)
    assert weights.inner[0].shape == (2, 3, 4)
    u, v = reference_positions(*sides)
    points = interior_points(weights, *edges_of(affine, *sides))
    np.testing.assert_allclose(points, affine(u, v)[:, 1:-1, 1:-1], atol=1e-14)


@pytest.mark.parametrize("same", [True, False])
def test_selected_blocks(same, rng):
    u, v = parameters(rng, 5, 4), parameters(rng, 5, 3)
    top = u if same else parameters(rng, 5, 4)
    edges = edges_of(bilinear, u, top, v, v)
    weights = TransfiniteWeights.from_parameters(u, top, v, v)
    some = np.array([3, 1])
    part = interior_points(weights.select(some), *(edge[some] for edge in edges))
    np.testing.assert_array_equal(part, interior_points(weights, *edges)[some])


@pytest.mark.parametrize("differing", ["u", "v"])
def test_product_form_with_one_differing_pair_is_the_form_node_by_node(differing, rng):
    bottom, left = parameters(rng, 4, 6), parameters(rng, 4, 3)
    top = parameters(rng, 4, 6) if differing == "u" else bottom
    right = parameters(rng, 4, 3) if differing == "v" else left
    edges = [rng.standard_normal((4, k, 2)) for k in (8, 8, 5, 5)]
    for side, end in ((edges[0], 0), (edges[1], -1)):
        edges[2][:, end], edges[3][:, end] = side[:, 0], side[:, -1]
    product = TransfiniteWeights.from_parameters(bottom, top, left, right)
    assert product.inner is None
    positions = reference_positions(bottom[:, 1:-1], top[:, 1:-1], left[:, 1:-1], right[:, 1:-1])
    full = dataclasses.replace(product, inner=positions)
    np.testing.assert_allclose(interior_points(product, *edges), interior_points(full, *edges), atol=1e-13)
    out = np.empty((4, 3, 6, 2))
    assert interior_points(product, *edges, out) is out
