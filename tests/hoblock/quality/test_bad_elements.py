"""Bad elements are found, located and given a reason."""

import tracemalloc

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.quality import det_jacobian, det_jacobian_bounds, invalid_elements
from hoblock.reference import gauss_lobatto


def test_bounds_agree_with_dense_sampling_on_validity(rng, elements):
    for order, amplitude in ((2, 0.33), (3, 0.25), (4, 0.2)):
        mesh = elements.perturbed(rng, order, amplitude, count=100)
        sampled = det_jacobian(mesh, elements.grid(np.linspace(-1, 1, 61))).min(axis=1)
        bad = np.isin(np.arange(100), [b.element for b in invalid_elements(mesh, 8)])
        decided = np.abs(sampled) > 1e-2
        assert 5 < bad.sum() < 95
        assert decided.sum() > 90
        np.testing.assert_array_equal(bad[decided], (sampled < 0)[decided])


def test_hand_made_invalid_element_is_found_and_located(elements):
    # Valid at all nodes, invalid between them: det J = x' of a cubic that is monotonic at the nodes only.
    mesh = elements.mapped(lambda xi, eta: (xi + 0.9 * (xi**3 - xi) * 1.2, eta), 3)
    assert det_jacobian(mesh, elements.grid(gauss_lobatto(3)))[0].min() > 0
    (bad,) = invalid_elements(mesh)
    assert (bad.element, bad.xi) == (0, 0.0)
    assert bad.det_J == pytest.approx(1 - 1.08)
    assert (bad.x, bad.y) == pytest.approx((0.0, bad.eta))
    assert bad.reason.startswith("Edges of its block cross or bend too far")


def test_reasons(elements):
    dart = elements.bilinear([(0, 0), (1, 0), (0.3, 0.3), (0, 1)])
    (bad,) = invalid_elements(dart)
    assert (bad.xi, bad.eta, bad.x, bad.y) == pytest.approx((1, 1, 0.3, 0.3))
    assert bad.reason.startswith("The angle at that corner is 180° or more")
    (bad,) = invalid_elements(elements.bilinear([(0, 0), (-1, 0), (-1, 1), (0, 1)]))
    assert bad.reason.startswith("The element is inverted")
    (bad,) = invalid_elements(elements.bilinear([(0, 0), (1, 0), (np.nan, 1), (0, 1)]))
    assert bad.reason == "Its nodes are not finite."


def test_invalid_elements_come_worst_first(rng, elements):
    mesh = elements.perturbed(rng, 2, 0.6)
    found = invalid_elements(mesh)
    assert len(found) > 3
    assert [bad.det_J for bad in found] == sorted(bad.det_J for bad in found)
    for bad in found:
        at = det_jacobian(mesh, np.array([(bad.xi, bad.eta)]))[bad.element, 0]
        assert at == pytest.approx(bad.det_J, abs=1e-13)


def test_valid_meshes_have_no_invalid_elements(layouts, rng):
    for kind in layouts.valences:
        assert invalid_elements(generate(layouts.random(kind, rng), 3)) == []


@pytest.mark.parametrize("order", [10, 16])
def test_curved_elements_of_high_order_are_certified(order, elements):
    def wavy(xi, eta):
        return xi + 0.15 * np.sin(3 * eta), eta + 0.15 * np.sin(3 * xi)

    def crossing(xi, eta):
        return xi + 0.5 * np.sin(3 * eta), eta + 0.5 * np.sin(3 * xi)

    assert invalid_elements(elements.mapped(wavy, order)) == []
    lower, upper = det_jacobian_bounds(elements.mapped(wavy, order))
    sampled = det_jacobian(elements.mapped(wavy, order), elements.grid(np.linspace(-1, 1, 101)))
    assert lower[0] <= sampled.min()
    assert upper[0] >= sampled.max()
    assert sampled.min() - lower[0] < 0.4
    (bad,) = invalid_elements(elements.mapped(crossing, order))
    assert bad.det_J == pytest.approx(1 - 2.25, abs=1e-2)


def test_many_bad_elements_are_reported_without_cutting_them(rng, elements):
    """Cutting an inverted element six times makes 4096 pieces of it: 2000 such elements would fill the memory."""
    mesh = elements.perturbed(rng, 4, 0.1, count=2000)
    mirrored = mesh.with_points(mesh.points * [-1, 1])
    tracemalloc.start()
    found = invalid_elements(mirrored)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(found) == 2000
    assert peak < 2e8


def test_undecided_elements_come_last(elements):
    flat, dart = [(0, 0), (1, 0), (0, 1), (0.5, 0.5)], [(0, 0), (1, 0), (0, 1), (0.3, 0.3)]
    found = invalid_elements(elements.of(np.array([flat, dart], dtype=float), 1))
    assert [(bad.element, bad.status) for bad in found] == [(1, "invalid"), (0, "undecided")]
    assert found[1].reason.startswith("det J comes too close to zero to tell its sign")
