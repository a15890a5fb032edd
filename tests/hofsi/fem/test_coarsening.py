from __future__ import annotations

import numpy as np
import pytest

from hofsi.fem.coarsening import skeleton_coarsening
from hofsi.fem.constraints import DirectedNodes, NodeConstraints
from hofsi.fem.element import boundary_first

NORMAL = np.array([np.cos(0.7), np.sin(0.7)])


def boundary_nodes(mesh):
    local, on_boundary = boundary_first(mesh.order)
    return mesh.cells[:, local[:on_boundary]]


def free_unknowns(mesh, constraints):
    nodes = np.unique(boundary_nodes(mesh))
    both = (2 * nodes[:, None] + np.arange(2)).ravel()
    return both[~constraints.fixed.ravel()[both]]


@pytest.mark.parametrize("order", [2, 4])
def test_rigid_motions_are_interpolated_in_the_frames_of_the_nodes(distorted, order):
    mesh = distorted(order)
    top, left = mesh.edge_nodes("top"), mesh.edge_nodes("left")
    constraints = NodeConstraints(
        len(mesh.points), [DirectedNodes.component(left, 0), DirectedNodes(top, np.tile(NORMAL, (len(top), 1)))]
    )
    assert constraints.rotated.size
    unknowns = free_unknowns(mesh, constraints)
    coarsening = skeleton_coarsening(boundary_nodes(mesh), order, constraints, unknowns, mesh.points)
    assert coarsening.near_kernel.shape[1] == 3
    # Far from constrained nodes translations are kept; a rotation only as far as the edges are straight.
    found = np.zeros((2 * len(mesh.points), 3))
    found[unknowns] = coarsening.prolongation @ coarsening.near_kernel
    held = np.unique(mesh.cells[np.isin(mesh.cells, np.union1d(top, left)).any(axis=1)])
    away = np.setdiff1d(np.unique(boundary_nodes(mesh)), held)
    assert away.size
    np.testing.assert_allclose(
        found[2 * away], np.stack([np.ones(len(away)), np.zeros(len(away)), found[2 * away, 2]], axis=-1), atol=1e-13
    )
    center = mesh.points - mesh.points.mean(axis=0)
    np.testing.assert_allclose(found[2 * away, 2], -center[away, 1], atol=0.05)
    np.testing.assert_allclose(found[2 * away + 1, 2], center[away, 0], atol=0.05)
    # On the slope a translation is what its tangent makes of it.
    slope = np.setdiff1d(top, left)
    tangent = np.array([-NORMAL[1], NORMAL[0]])
    vertices = np.intersect1d(slope, mesh.corners)
    np.testing.assert_allclose(found[2 * vertices + 1, :2], np.tile(tangent, (len(vertices), 1)), atol=1e-13)


def test_patch_of_a_vertex_holds_the_edges_that_end_there(distorted):
    mesh = distorted(3, 2, 2)
    constraints = NodeConstraints(len(mesh.points), [])
    unknowns = free_unknowns(mesh, constraints)
    patches = skeleton_coarsening(boundary_nodes(mesh), 3, constraints, unknowns).patches
    assert patches.shape == (9, len(unknowns))
    # Two nodes inside each edge and the vertex itself: 2, 3 or 4 edges at corners, sides and in the middle.
    np.testing.assert_array_equal(np.sort(np.diff(patches.indptr)), 2 * np.array([5] * 4 + [7] * 4 + [9]))
    assert np.unique(patches.indices).size == len(unknowns)
