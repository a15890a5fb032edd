"""Consistent normals: they conserve flux, know corners from curves, and converge to the true ones."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, generate
from hofsi.fem.geometry import side_geometry
from hofsi.fem.normals import consistent_normals
from hofsi.fem.spaces import TaylorHood


def annulus(order, sectors=4, count=1):
    angle = 2.0 * np.pi / sectors * np.arange(sectors) + 0.2
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    vertices = np.concatenate([0.5 * circle, circle])
    pairs = [(k, (k + 1) % sectors) for k in range(sectors)]
    curves = {
        (s + a, s + b): Arc.from_center((0.0, 0.0), vertices[s + a], vertices[s + b])
        for s in (0, sectors)
        for a, b in pairs
    }
    edges = {"outer": [(sectors + a, sectors + b) for a, b in pairs], "inner": pairs}
    quads = {"fluid": [(a, sectors + a, sectors + b, b) for a, b in pairs]}
    counts = dict.fromkeys(pairs, count)
    return generate(BlockStructure.build(vertices, quads, curves=curves, edges=edges, counts=counts), order)


def quadrilateral(order, corners, count=2):
    vertices = dict(zip("abcd", corners, strict=True))
    edges = {"around": [("a", "b"), ("b", "c"), ("c", "d"), ("d", "a")], "lid": [("c", "d")]}
    return generate(BlockStructure.build(vertices, {"fluid": [tuple("abcd")]}, edges=edges, counts=count), order)


def normals(mesh, names):
    space = TaylorHood.on(mesh)
    sides = np.concatenate([mesh.edge_groups[name] for name in names])
    cells = space.velocity_cells
    return space, sides, consistent_normals(mesh.points[cells], cells, sides, space.velocity_sides)


@pytest.mark.parametrize("order", [2, 3, 6])
def test_tangential_nodal_velocities_carry_no_flux(order):
    mesh = annulus(order, sectors=5, count=2)
    space, sides, (smooth,) = normals(mesh, ["outer", "inner"])
    rng = np.random.default_rng(31)
    speed = rng.standard_normal(len(smooth.nodes))
    u = rng.standard_normal(mesh.points.shape)
    u[smooth.nodes] = speed[:, None] * np.stack([-smooth.directions[:, 1], smooth.directions[:, 0]], axis=-1)
    flux = sum(
        float(np.sum((side.table.N @ u[space.velocity_cells[side.elements]]) * side.normals))
        for side in side_geometry(mesh.points[space.velocity_cells], sides, space.velocity_sides)
    )
    assert abs(flux) < 1e-13 * np.abs(speed).max()
    np.testing.assert_allclose(np.hypot(*smooth.directions.T), 1.0, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("name", ["outer", "inner"])
def test_normals_of_a_circle_point_out_of_the_fluid_and_converge(name):
    errors = []
    for order in (2, 4, 8):
        mesh = annulus(order)
        _, _, entries = normals(mesh, [name])
        assert len(entries) == 1  # a circle of four elements has no corners
        exact = mesh.points[entries[0].nodes]
        exact = (1.0 if name == "outer" else -1.0) * exact / np.hypot(*exact.T)[:, None]
        errors.append(np.abs(entries[0].directions - exact).max())
    assert errors[0] < 0.1
    assert errors[1] < 2e-3
    assert errors[2] < 1e-6


def test_each_node_of_a_closed_edge_occurs_once():
    mesh = annulus(3, sectors=3)
    _, _, (smooth,) = normals(mesh, ["outer"])
    np.testing.assert_array_equal(smooth.nodes, mesh.edge_nodes("outer"))


@pytest.mark.parametrize("order", [2, 3])
def test_corners_have_the_normals_of_both_sides(order):
    corners = [(0.0, 0.0), (2.0, 0.2), (1.8, 1.4), (-0.1, 1.0)]
    mesh = quadrilateral(order, corners)
    _, _, (smooth, first, second) = normals(mesh, ["around"])
    at = mesh.points[first.nodes]
    assert sorted(map(tuple, at.round(12).tolist())) == sorted(corners)
    np.testing.assert_array_equal(first.nodes, second.nodes)
    edges = {corner: (corners[k - 1], corners[(k + 1) % 4]) for k, corner in enumerate(corners)}
    for place, n, m in zip(at, first.directions, second.directions, strict=True):
        before, after = edges[tuple(place.round(12).tolist())]
        outward = []
        for start, end in ((before, place), (place, after)):
            t = np.subtract(end, start)
            outward.append(np.array([t[1], -t[0]]) / np.hypot(*t))
        pair = [n, m] if np.allclose(n, outward[0]) else [m, n]
        np.testing.assert_allclose(pair, outward, rtol=0.0, atol=1e-13)
    assert not np.isin(first.nodes, smooth.nodes).any()
    assert len(smooth.nodes) + 4 == len(mesh.edge_nodes("around"))


def test_a_straight_edge_has_one_normal():
    mesh = quadrilateral(4, [(0.0, 0.0), (2.0, 0.2), (1.8, 1.4), (-0.1, 1.0)], count=3)
    _, _, (smooth,) = normals(mesh, ["lid"])
    expected = np.tile([[-0.4, 1.9]] / np.hypot(0.4, 1.9), (len(smooth.nodes), 1))
    np.testing.assert_allclose(smooth.directions, expected, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize(("bend", "corner"), [(0.02, False), (0.5, True)])
def test_a_slight_kink_is_smoothed_a_sharp_one_is_a_corner(bend, corner):
    vertices = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (2, 1), "e": (1, 1 + bend / 2), "f": (0, 1)}
    blocks = {"fluid": [("a", "b", "e", "f"), ("b", "c", "d", "e")]}
    structure = BlockStructure.build(vertices, blocks, edges={"roof": [("d", "e"), ("e", "f")]})
    mesh = generate(structure, 3)
    _, _, entries = normals(mesh, ["roof"])
    assert (len(entries) == 3) == corner
    top = int(np.argmax(mesh.points[:, 1]))
    if corner:
        assert entries[1].nodes.tolist() == [top]
    else:
        mean = entries[0].directions[entries[0].nodes == top]
        np.testing.assert_allclose(mean, [[0.0, 1.0]], rtol=0.0, atol=1e-13)
