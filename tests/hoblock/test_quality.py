import tracemalloc

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.numbering import number_nodes
from hoblock.quality import (
    det_jacobian,
    det_jacobian_bounds,
    equiangular_skewness,
    invalid_elements,
    jacobian,
    jacobian_ratio,
    minimum_det_jacobian,
    scaled_jacobian,
)
from hoblock.reference import equispaced, gauss_lobatto


def grid(nodes):
    return np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2)


def element(function, order):
    """One element with nodes at function(ξ, η)."""
    xi, eta = grid(gauss_lobatto(order)).T
    points = np.stack(function(xi, eta), axis=-1)
    return QuadMesh(points, np.arange(len(points))[None], order, {}, {})


def bilinear(corners, order=1):
    a, b, c, d = np.array(corners, dtype=float)

    def function(xi, eta):
        N = ((1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta))
        return sum(n[..., None] * x / 4 for n, x in zip(N, (a, b, c, d), strict=True)).T

    return element(function, order)


def perturbed(rng, order, amplitude, count=40):
    """Elements with random nodes around those of the square."""
    square = grid(gauss_lobatto(order))
    cells = number_nodes(np.arange(4 * count).reshape(count, 4), order)[0]
    points = np.empty((cells.max() + 1, 2))
    points[cells] = square + amplitude / order * rng.standard_normal((count, len(square), 2))
    return QuadMesh(points, cells, order, {}, {})


def test_jacobian_of_a_known_map():
    mesh = element(lambda xi, eta: (xi + 0.1 * xi * eta**2, eta + 0.2 * xi**3), 3)
    points = np.array([(0.3, -0.4), (1.0, 1.0)])
    xi, eta = points.T
    expected = np.stack([np.stack([1 + 0.1 * eta**2, 0.2 * xi * eta]), np.stack([0.6 * xi**2, 1 + 0 * xi])])
    np.testing.assert_allclose(jacobian(mesh, points)[0], expected.transpose(2, 0, 1), atol=1e-14)
    np.testing.assert_allclose(det_jacobian(mesh, points)[0], 1 + 0.1 * eta**2 - 0.12 * xi**3 * eta, atol=1e-14)


def test_measures_of_the_square_and_of_a_parallelogram():
    square = bilinear([(0, 0), (2, 0), (2, 2), (0, 2)])
    for measure, expected in ((scaled_jacobian, 1), (jacobian_ratio, 1), (equiangular_skewness, 0)):
        np.testing.assert_allclose(measure(square), expected, atol=1e-15)
    angle = np.radians(50)
    shear = np.array([np.cos(angle), np.sin(angle)])
    rhomboid = bilinear([(0, 0), (3, 0), shear + np.array([3, 0]), shear], order=3)
    assert scaled_jacobian(rhomboid) == pytest.approx(np.sin(angle))
    assert jacobian_ratio(rhomboid) == pytest.approx(1.0)
    assert equiangular_skewness(rhomboid) == pytest.approx(40 / 90)
    assert minimum_det_jacobian(rhomboid) == pytest.approx(3 * np.sin(angle) / 4)


def test_measures_of_a_trapezoid():
    mesh = bilinear([(0, 0), (4, 0), (3, 1), (1, 1)])
    assert jacobian_ratio(mesh) == pytest.approx(0.5)  # the lengths of the parallel sides
    assert scaled_jacobian(mesh) == pytest.approx(np.sin(np.pi / 4))
    assert equiangular_skewness(mesh) == pytest.approx(0.5)


def test_skewness_sees_a_corner_of_each_kind():
    # Angles 120° at one corner in turn; a measure that mistakes an angle for its supplement gives the same maximum only
    # for symmetric quads, so a kite with angles 30°, 110°, 110°, 110° tells.
    t = np.radians([0, 30])
    kite = np.array([(0, 0), (1, 0), (0, 0), (np.cos(t[1]), np.sin(t[1]))])
    towards = np.array([np.cos(t[1] / 2), np.sin(t[1] / 2)])
    # The tip lies on the bisector where the sides from (1, 0) leave at 110°.
    angle = np.radians(180 - 110)
    length = np.sin(np.radians(110)) / np.sin(np.radians(180 - 15 - 110))
    assert angle > 0
    kite[2] = length * towards
    for shift in range(4):
        mesh = bilinear(np.roll(kite, shift, axis=0))
        assert equiangular_skewness(mesh) == pytest.approx(60 / 90, rel=1e-12)


def test_scaled_jacobian_is_signed():
    dart = bilinear([(0, 0), (1, 0), (0.3, 0.3), (0, 1)])
    assert scaled_jacobian(dart)[0] < 0
    assert equiangular_skewness(dart)[0] > 1
    mirrored = bilinear([(0, 0), (-1, 0), (-1, 1), (0, 1)])
    assert scaled_jacobian(mirrored) == pytest.approx(-1)
    assert jacobian_ratio(mirrored) == -np.inf


@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("amplitude", [0.1, 0.4])
def test_bernstein_bounds_bracket_sampled_values(order, amplitude, rng):
    mesh = perturbed(rng, order, amplitude)
    lower, upper = det_jacobian_bounds(mesh)
    sampled = det_jacobian(mesh, grid(np.linspace(-1, 1, 41)))
    assert np.all(lower <= sampled.min(axis=1) + 1e-11)
    assert np.all(upper >= sampled.max(axis=1) - 1e-11)
    finer, same = det_jacobian_bounds(mesh, 3)
    np.testing.assert_array_equal(same, upper)
    assert np.all(finer >= lower - 1e-12)
    assert np.all(np.where(lower <= 0, finer, lower) <= sampled.min(axis=1) + 1e-11)
    if order == 1:  # det J is linear in ξ and η up to ξη, its extrema are at the corners
        np.testing.assert_allclose(lower, sampled.min(axis=1), atol=1e-13)


def test_subdivision_sharpens_the_bound(rng):
    mesh = perturbed(rng, 4, 0.33)
    sampled = det_jacobian(mesh, grid(np.linspace(-1, 1, 81))).min(axis=1)
    inverted = sampled < 0
    gaps = [np.max((sampled - det_jacobian_bounds(mesh, k)[0])[inverted]) for k in (0, 2, 5)]
    assert inverted.sum() > 20
    # The bound converges quadratically in the size of the pieces: 4 and 8 times smaller.
    assert gaps[0] > 10 * gaps[1]
    assert gaps[2] < 0.05


def test_bounds_agree_with_dense_sampling_on_validity(rng):
    for order, amplitude in ((2, 0.33), (3, 0.25), (4, 0.2)):
        mesh = perturbed(rng, order, amplitude, count=100)
        sampled = det_jacobian(mesh, grid(np.linspace(-1, 1, 61))).min(axis=1)
        bad = np.isin(np.arange(100), [b.element for b in invalid_elements(mesh, 8)])
        decided = np.abs(sampled) > 1e-2
        assert 5 < bad.sum() < 95
        assert decided.sum() > 90
        np.testing.assert_array_equal(bad[decided], (sampled < 0)[decided])


def test_hand_made_invalid_element_is_found_and_located():
    # Valid at all nodes, invalid between them: det J = x' of a cubic that is monotonic at the nodes only.
    mesh = element(lambda xi, eta: (xi + 0.9 * (xi**3 - xi) * 1.2, eta), 3)
    assert det_jacobian(mesh, grid(gauss_lobatto(3)))[0].min() > 0
    (bad,) = invalid_elements(mesh)
    assert (bad.element, bad.xi) == (0, 0.0)
    assert bad.det_J == pytest.approx(1 - 1.08)
    assert (bad.x, bad.y) == pytest.approx((0.0, bad.eta))
    assert bad.reason.startswith("Edges of its block cross or bend too far")


def test_reasons():
    dart = bilinear([(0, 0), (1, 0), (0.3, 0.3), (0, 1)])
    (bad,) = invalid_elements(dart)
    assert (bad.xi, bad.eta, bad.x, bad.y) == pytest.approx((1, 1, 0.3, 0.3))
    assert bad.reason.startswith("The angle at that corner is 180° or more")
    (bad,) = invalid_elements(bilinear([(0, 0), (-1, 0), (-1, 1), (0, 1)]))
    assert bad.reason.startswith("The element is inverted")
    (bad,) = invalid_elements(bilinear([(0, 0), (1, 0), (np.nan, 1), (0, 1)]))
    assert bad.reason == "Its nodes are not finite."


def test_invalid_elements_come_worst_first(rng):
    mesh = perturbed(rng, 2, 0.6)
    found = invalid_elements(mesh)
    assert len(found) > 3
    assert [bad.det_J for bad in found] == sorted(bad.det_J for bad in found)
    for bad in found:
        at = det_jacobian(mesh, np.array([(bad.xi, bad.eta)]))[bad.element, 0]
        assert at == pytest.approx(bad.det_J, abs=1e-13)


def test_valid_meshes_have_no_invalid_elements(layouts, rng):
    for kind in layouts.valences:
        assert invalid_elements(generate(layouts.random(kind, rng), 3)) == []


def test_measures_against_gmsh(layouts, rng):
    """Gmsh bounds det J by its own Bernstein code; its minSJ and minSICN are other measures than ours."""
    gmsh = pytest.importorskip("gmsh")
    from hoblock.io.equispaced import equispaced_points

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for order in (1, 2, 4):
            mesh = generate(layouts.random("disc", rng), order)
            gmsh.clear()
            gmsh.model.addDiscreteEntity(2, 1)
            nodes = np.pad(equispaced_points(mesh), ((0, 0), (0, 1)))
            gmsh.model.mesh.addNodes(2, 1, np.arange(1, len(nodes) + 1), nodes.ravel())
            kind = gmsh.model.mesh.getElementType("quadrangle", order)
            elements = np.arange(1, len(mesh.cells) + 1)
            cells = mesh.cells[:, node_order(order, "gmsh")] + 1
            gmsh.model.mesh.addElementsByType(1, kind, elements, cells.ravel())
            qualities = {
                name: np.array(gmsh.model.mesh.getElementQualities(elements, name))
                for name in ("minDetJac", "maxDetJac")
            }
            sampled = det_jacobian(mesh, grid(equispaced(8 * order)))
            # Gmsh gives the bounds of det J with a tolerance of some percent of its range.
            spread = np.ptp(sampled, axis=1) + 1e-12
            assert np.all(np.abs(qualities["minDetJac"] - sampled.min(axis=1)) < 0.05 * spread + 1e-9)
            assert np.all(np.abs(qualities["maxDetJac"] - sampled.max(axis=1)) < 0.05 * spread + 1e-9)
            lower, upper = det_jacobian_bounds(mesh)
            assert np.all(lower <= sampled.min(axis=1) + 1e-12)
            assert np.all(upper >= sampled.max(axis=1) - 1e-12)
    finally:
        gmsh.finalize()


@pytest.mark.parametrize("order", [8, 10, 12, 16, 24, 32])
def test_bounds_are_sharp_at_high_orders(order):
    """det J of a trapezium is linear, between 0.25 and 0.3, whatever the order of the element."""
    lower, upper = det_jacobian_bounds(bilinear([(0, 0), (1, 0), (1.2, 1), (0, 1)], order))
    assert lower[0] == pytest.approx(0.25, abs=1e-9)
    assert upper[0] == pytest.approx(0.3, abs=1e-9)


@pytest.mark.parametrize("order", [10, 16])
def test_curved_elements_of_high_order_are_certified(order):
    def wavy(xi, eta):
        return xi + 0.15 * np.sin(3 * eta), eta + 0.15 * np.sin(3 * xi)

    def crossing(xi, eta):
        return xi + 0.5 * np.sin(3 * eta), eta + 0.5 * np.sin(3 * xi)

    assert invalid_elements(element(wavy, order)) == []
    lower, upper = det_jacobian_bounds(element(wavy, order))
    sampled = det_jacobian(element(wavy, order), grid(np.linspace(-1, 1, 101)))
    assert lower[0] <= sampled.min()
    assert upper[0] >= sampled.max()
    assert sampled.min() - lower[0] < 0.4
    (bad,) = invalid_elements(element(crossing, order))
    assert bad.det_J == pytest.approx(1 - 2.25, abs=1e-2)


@pytest.mark.parametrize("order", [9, 12])
def test_bounds_hold_where_high_modes_are_strong(order, rng):
    mesh = perturbed(rng, order, 0.4)
    sampled = det_jacobian(mesh, grid(np.linspace(-1, 1, 41)))
    for subdivisions in (0, 2):
        lower, upper = det_jacobian_bounds(mesh, subdivisions)
        assert np.all(lower <= sampled.min(axis=1))
        assert np.all(upper >= sampled.max(axis=1))


def test_many_bad_elements_are_reported_without_cutting_them(rng):
    """Cutting an inverted element six times makes 4096 pieces of it: 2000 such elements would fill the memory."""
    mesh = perturbed(rng, 4, 0.1, count=2000)
    mirrored = mesh.with_points(mesh.points * [-1, 1])
    tracemalloc.start()
    found = invalid_elements(mirrored)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(found) == 2000
    assert peak < 2e8
