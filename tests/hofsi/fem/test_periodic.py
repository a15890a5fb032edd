"""Sides that are translations of each other, and the nodes that become one."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from hoblock import BlockStructure, QuadMesh, generate
from hofsi.errors import CaseError, MeshMotionError
from hofsi.fem.periodic import PeriodicSides, pair_sides, representatives
from hofsi.fem.spaces import TaylorHood

SIDES = (("left", "right"), ("bottom", "top"))
PLACE = "fluid.boundary[2]"


def box(
    columns: tuple[float, ...] = (0.0, 0.3, 1.0),
    rows: tuple[float, ...] = (0.0, 0.6, 1.0),
    *,
    order: int = 3,
    turned: int = 0,
    right: tuple[float, ...] = (),
) -> QuadMesh:
    """A rectangle of one block an element; ``turned`` turns the axes of every second, ``right`` are rows there."""
    ys = [rows] * (len(columns) - 1) + [right or rows]
    vertices = [(x, y) for x, line in zip(columns, ys, strict=True) for y in line]
    n = len(rows)
    quads = []
    for k in range(len(columns) - 1):
        for j in range(n - 1):
            quad = [k * n + j, (k + 1) * n + j, (k + 1) * n + j + 1, k * n + j + 1]
            quads.append(tuple(np.roll(quad, turned * ((k + j) % 2)).tolist()))
    last = (len(columns) - 1) * n
    lines = {
        "left": range(n),
        "right": range(last, last + n),
        "bottom": range(0, last + 1, n),
        "top": range(n - 1, last + n, n),
    }
    edges = {name: list(pairwise(line)) for name, line in lines.items()}
    return generate(BlockStructure.build(vertices, {"fluid": quads}, edges=edges), order)


def paired(mesh: QuadMesh, first: str = "left", second: str = "right") -> PeriodicSides:
    return pair_sides(mesh, (first,), (second,), PLACE)


def waved(mesh: QuadMesh) -> QuadMesh:
    """The mesh under a map with period 1 in x and y: all sides become curves."""
    x, y = 2.0 * np.pi * mesh.points.T
    return mesh.with_points(mesh.points + 0.05 * np.stack([np.sin(y), np.sin(x + 0.7)], axis=-1))


@pytest.mark.parametrize("turned", range(4))
@pytest.mark.parametrize("sides", SIDES)
def test_nodes_are_paired_with_their_translations(sides: tuple[str, str], turned: int) -> None:
    mesh = waved(box(turned=turned))
    found = paired(mesh, *sides)
    np.testing.assert_allclose(found.translation, [1.0, 0.0] if "left" in sides else [0.0, 1.0], atol=1e-14)
    gap = mesh.points[found.nodes[:, 1]] - mesh.points[found.nodes[:, 0]] - found.translation
    assert np.abs(gap).max() < 1e-14
    assert sorted(found.nodes[:, 0]) == mesh.edge_nodes(sides[0]).tolist()
    assert sorted(found.nodes[:, 1]) == mesh.edge_nodes(sides[1]).tolist()


def test_the_order_of_names_and_sides_does_not_matter() -> None:
    mesh = box()
    groups = dict(mesh.edge_groups)
    low, high = groups["left"][:1], groups["left"][1:]
    named = QuadMesh(mesh.points, mesh.cells, mesh.order, mesh.cell_groups, {**groups, "low": low, "high": high})
    found = pair_sides(named, ("high", "low"), ("right",), PLACE)
    np.testing.assert_array_equal(found.nodes, paired(mesh).nodes)


def test_representatives_are_the_smallest_of_a_chain() -> None:
    pairs = np.array([[5, 2], [3, 5], [6, 7]])
    np.testing.assert_array_equal(representatives(pairs, 8), [0, 1, 2, 2, 4, 2, 6, 6])


@pytest.mark.parametrize("columns", [(0.0, 1.0), (0.0, 0.3, 1.0), (0.0, 0.2, 0.7, 1.0)])
@pytest.mark.parametrize("order", [2, 3, 5])
@pytest.mark.parametrize("turned", [0, 1, 3])
def test_a_torus_has_the_unknowns_of_a_torus(columns: tuple[float, ...], order: int, turned: int) -> None:
    mesh = waved(box(columns, order=order, turned=turned))
    space = TaylorHood.on(mesh, [paired(mesh, *sides) for sides in SIDES])
    elements = len(mesh.cells)
    assert len(np.unique(space.velocity_unknowns)) == elements * order**2
    assert len(np.unique(space.pressure_unknowns)) == elements * (order - 1) ** 2
    assert len(np.unique(space.dofs)) == 2 * elements * order**2 + elements * (order - 1) ** 2
    assert len(np.unique(space.node_dofs)) == space.size
    assert len(space.copies) == space.size - len(np.unique(space.dofs))
    # Copies read what they are copies of, and then values gathered by nodes and by unknowns agree.
    x = np.random.default_rng(1).standard_normal(space.size)
    x[space.copies[:, 0]] = x[space.copies[:, 1]]
    np.testing.assert_array_equal(x[space.dofs], x[space.node_dofs])
    assert not np.isin(space.copies[:, 0], space.dofs).any()


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("turned", [0, 1, 2])
def test_nodes_that_are_one_are_at_one_place_of_the_torus(order: int, turned: int) -> None:
    mesh = box(order=order, turned=turned)
    space = TaylorHood.on(mesh, [paired(mesh, *sides) for sides in SIDES])
    # A function with the periods of the sides has one value at every node of the torus.
    x, y = 2.0 * np.pi * mesh.points.T
    values = np.sin(x) + np.cos(y + 0.4)
    for nodes, table, count in (
        (space.velocity_unknowns, space.velocity, space.velocity_count),
        (space.pressure_unknowns, space.pressure, space.pressure_count),
    ):
        # The elements are straight: fitted by a basis, the places of the quadrature points give those of its nodes.
        places = np.linalg.pinv(table.N) @ (space.velocity.N @ mesh.points[space.velocity_cells])
        u, v = 2.0 * np.pi * np.moveaxis(places, -1, 0)
        own = np.sin(u) + np.cos(v + 0.4)
        one = np.full(count, np.nan)
        one[nodes.ravel()] = own.ravel()
        np.testing.assert_allclose(one[nodes], own, atol=1e-12)
    np.testing.assert_allclose(space.copied(values), values, atol=1e-14)


def test_without_periodic_sides_nothing_is_copied() -> None:
    space = TaylorHood.on(box())
    assert space.node_dofs is space.dofs
    assert space.velocity_unknowns is space.velocity_cells
    assert space.pressure_unknowns is space.pressure_cells
    assert not space.copies.size
    nodes, field = np.array([3, 5]), np.zeros((space.velocity_count, 2))
    assert space.with_copies(nodes) is nodes
    assert space.standing_for(nodes) is nodes
    assert space.copied(field) is field


def test_nodes_and_their_copies() -> None:
    mesh = box((0.0, 1.0), (0.0, 1.0), order=2)
    space = TaylorHood.on(mesh, [paired(mesh, *sides) for sides in SIDES])
    assert space.with_copies(mesh.corners[0, :1]).tolist() == sorted(mesh.corners[0].tolist())
    assert len(set(space.standing_for(mesh.corners[0]).tolist())) == 1


@pytest.mark.parametrize(
    ("mesh", "match"),
    [
        (box(right=(0.0, 0.5, 1.0)), r"no translation of each other: moved by \(1, -0\.0\d+\), .* is 0\.0\d+ from the"),
        (box(right=(0.0, 0.6, 1.2)), r"'left' and 'right' are no translation .* gradings of one of them"),
    ],
)
def test_sides_that_differ(mesh: QuadMesh, match: str) -> None:
    with pytest.raises(CaseError, match=match) as caught:
        paired(mesh)
    assert caught.value.place == f"{PLACE}.with"


def test_sides_with_other_numbers_of_elements() -> None:
    with pytest.raises(CaseError, match=r"'left' and 'top' have 2 and 3 element sides; expected as many"):
        paired(box((0.0, 0.2, 0.7, 1.0)), "left", "top")


def test_curves_that_differ() -> None:
    mesh = box()
    x, y = mesh.points.T
    bulged = mesh.with_points(mesh.points + np.stack([0.1 * x * y * (1.0 - y), 0.0 * x], axis=-1))
    with pytest.raises(CaseError, match="'left' and 'right' are no translation"):
        paired(bulged)


def test_the_fluid_must_lie_between_the_sides() -> None:
    # Two boxes without a common edge: their left sides are translations, the fluid is to the right of both.
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    edges = {"left": [(0, 3)], "other": [(4, 7)]}
    vertices = np.concatenate([corners, corners + np.array([2.0, 0.0])])
    mesh = generate(BlockStructure.build(vertices, {"fluid": [(0, 1, 2, 3), (4, 5, 6, 7)]}, edges=edges), 2)
    with pytest.raises(CaseError, match="the fluid lies on the same side of 'left' and 'other'"):
        paired(mesh, "left", "other")


def test_motion_must_keep_the_translation() -> None:
    mesh = box()
    sides = paired(mesh)
    message = r"t = 0\.5: the sides of fluid.boundary\[2\] \('left' and 'right'\) are no translation"
    x, y = mesh.points.T
    sides.check(mesh.points + np.stack([0.1 * y, 0.2 * np.sin(2.0 * np.pi * x)], axis=-1), 0.5)
    for motion in (np.stack([0.1 * x, 0.0 * y], axis=-1), np.stack([0.0 * x, 0.1 * x * y], axis=-1)):
        with pytest.raises(MeshMotionError, match=message):
            sides.check(mesh.points + motion, 0.5)
