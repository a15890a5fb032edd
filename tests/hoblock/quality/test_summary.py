"""The summary of a mesh and its parts."""

import json
from dataclasses import asdict

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.quality import certify, element_areas, histogram, per_element, quality_summary, scaled_jacobian


def test_summary_of_a_ring(layouts):
    mesh = generate(layouts.annulus(counts=2), 5)
    summary = quality_summary(mesh)
    assert (summary.valid, summary.verdict, summary.order) == (True, "valid", 5)
    assert (summary.cells, summary.points) == (16, len(mesh.points))
    assert summary.area == pytest.approx(3 * np.pi, rel=1e-5)
    assert summary.min_det_j_bound == certify(mesh).min_det_J > 0
    quality = scaled_jacobian(mesh)
    assert summary.scaled_jacobian.min == quality.min()
    assert summary.scaled_jacobian.mean == pytest.approx(quality.mean())
    assert summary.status_counts == {"valid": 16, "undecided": 0, "invalid": 0}
    for measure in (summary.scaled_jacobian, summary.skewness, summary.aspect_ratio, summary.size_jump):
        assert sum(measure.histogram.counts) == 16
    assert [bad.scaled_jacobian for bad in summary.worst_elements] == sorted(quality)[:5]


def test_summary_is_plain_data(layouts):
    text = json.dumps(asdict(quality_summary(generate(layouts.square(counts=3), 2), worst=2)))
    data = json.loads(text)
    assert data["scaled_jacobian"]["min"] == pytest.approx(1.0)
    assert len(data["worst_elements"]) == 2
    assert data["valid"] is True


def test_worst_elements_are_the_bad_ones(elements):
    square, dart = [(0, 0), (1, 0), (0, 1), (1, 1)], [(0, 0), (1, 0), (0, 1), (0.3, 0.3)]
    narrow, broken = [(0, 0), (1, 0), (0.9, 0.1), (1.9, 0.1)], [(0, 0), (1, 0), (0, 1), (np.nan, 1)]
    flat = [(0, 0), (1, 0), (0, 1), (0.5, 0.5)]
    mesh = elements.of(np.array([square, flat, dart, narrow, broken]), 1)
    summary = quality_summary(mesh, worst=4)
    assert [bad.element for bad in summary.worst_elements] == [4, 2, 1, 3]
    assert [bad.status for bad in summary.worst_elements] == ["invalid", "invalid", "undecided", "valid"]
    assert summary.verdict == "invalid"
    assert summary.min_det_j_bound == -np.inf
    assert (summary.worst_elements[1].x, summary.worst_elements[1].y) == (0.325, 0.325)


def test_per_element(layouts):
    mesh = generate(layouts.annulus(counts=2), 3)
    fields = per_element(mesh)
    assert all(values.shape == (16,) for values in fields.values())
    assert fields["status"].max() == 0
    np.testing.assert_array_equal(fields["area"], element_areas(mesh))
    assert list(fields) == [
        "status",
        "det_j_bound",
        "scaled_jacobian",
        "jacobian_ratio",
        "skewness",
        "aspect_ratio",
        "size_jump",
        "area",
    ]


def test_histogram_counts_everything_but_nan():
    found = histogram(np.array([-5.0, 0.0, 0.5, 1.0, 1.0, 9.0, np.nan, np.inf, -np.inf]), [0, 0.5, 1.0, 2.0])
    assert found.counts == (3, 1, 4)
    assert found.edges == (0.0, 0.5, 1.0, 2.0)


@pytest.mark.parametrize("edges", [[1.0], [1.0, 1.0], [2.0, 1.0], [[0.0, 1.0]], [0.0, np.nan]])
def test_bad_edges_of_histograms(edges):
    with pytest.raises(ValueError, match=r"histogram: edges are .* expected at least two, strictly ascending"):
        histogram(np.ones(3), edges)


def test_a_mesh_without_elements():
    empty = QuadMesh(np.zeros((0, 2)), np.zeros((0, 4), dtype=np.int64), 1, {}, {})
    with pytest.raises(ValueError, match="the mesh has no elements"):
        quality_summary(empty)
    assert certify(empty).valid


def test_nothing_finite_gives_nan(elements):
    mesh = elements.of(np.full((1, 4, 2), np.nan), 1)
    summary = quality_summary(mesh)
    assert np.isnan(summary.scaled_jacobian.min)
    assert sum(summary.scaled_jacobian.histogram.counts) == 0
