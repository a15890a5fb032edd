"""Vertices that slide along straight and curved boundaries, for every mover."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, Ellipse
from hoblock.errors import InvalidMeshError, MoverError
from hoblock.generate import generate
from hoblock.motion import MeshMotion
from hoblock.movers import AngleOptimisation, BarrierEnergy, PseudoSolid, Rule, Sliding, sliding_vertices

MOVERS = {
    "barrier": lambda structure, driven, sliding: BarrierEnergy(structure, driven, sliding=sliding),
    "pseudo-solid": lambda structure, driven, sliding: PseudoSolid(structure, driven, sliding=sliding),
    "incremental": lambda structure, driven, sliding: PseudoSolid(structure, driven, sliding=sliding, incremental=True),
    "angles": lambda structure, driven, sliding: AngleOptimisation(structure, driven, sliding=sliding),
    "published": lambda structure, driven, sliding: AngleOptimisation.as_published(structure, driven, sliding=sliding),
    "rule": lambda structure, driven, sliding: Rule(
        structure,
        driven,
        lambda d: np.tile(
            0.5 * d.mean(axis=0), (len(Rule(structure, driven, abs, sliding=sliding).free) + len(sliding), 1)
        ),
        sliding=sliding,
    ),
}


def ring(sectors=8, rings=2, outer=3.0):
    """A square body in a disc: rings of blocks between them; the outer circle is one smooth closed curve."""
    angle = 2.0 * np.pi * np.arange(sectors) / sectors
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    vertices = np.concatenate([(1.0 + (outer - 1.0) * k / rings) * circle for k in range(rings + 1)])
    blocks = [
        (k * sectors + i, (k + 1) * sectors + i, (k + 1) * sectors + (i + 1) % sectors, k * sectors + (i + 1) % sectors)
        for k in range(rings)
        for i in range(sectors)
    ]
    first = rings * sectors
    curves = {}
    for i in range(sectors):
        pair = (str(first + i), str(first + (i + 1) % sectors))
        ends = vertices[first + i], vertices[first + (i + 1) % sectors]
        curves[pair] = Arc.from_center((0.0, 0.0), *ends)
    named = {str(k): tuple(x) for k, x in enumerate(vertices)}
    quads = [tuple(map(str, block)) for block in blocks]
    structure = BlockStructure.build(named, quads, counts=2, curves=curves)
    return structure, np.arange(sectors), np.arange(first, first + sectors)


def body_edges(structure, driven):
    ends = structure.topology.edges
    return np.flatnonzero(np.isin(ends, driven).all(axis=1))


def test_coordinates_and_positions_on_a_closed_circle():
    structure, driven, outer = ring()
    paths = Sliding.of(structure, outer, driven)
    assert len(paths.paths) == 1
    assert paths.paths[0].closed
    assert paths.paths[0].length == pytest.approx(6.0 * np.pi, rel=1e-12)
    np.testing.assert_allclose(paths.positions(paths.start), structure.vertices[outer], atol=1e-12)
    moved = paths.start + 0.7
    start, ahead = (x @ [1.0, 1.0j] for x in (structure.vertices[outer], paths.positions(paths.start + 0.1)))
    sense = np.sign((ahead / start).imag[0])
    angle = np.angle(start) + sense * 0.7 / 3.0
    np.testing.assert_allclose(paths.positions(moved), 3.0 * np.stack([np.cos(angle), np.sin(angle)], -1), atol=1e-11)
    first, second = paths.derivatives(moved)
    np.testing.assert_allclose(np.hypot(*first.T), 1.0, atol=1e-10)
    np.testing.assert_allclose(second, -paths.positions(moved) / 9.0, atol=1e-7)
    np.testing.assert_allclose(
        paths.positions(paths.coordinates(paths.positions(moved))), paths.positions(moved), atol=1e-11
    )


@pytest.mark.parametrize("name", MOVERS)
def test_a_body_shifted_in_a_disc_takes_the_outer_vertices_along_the_circle(name):
    structure, driven, outer = ring()
    mover = MOVERS[name](structure, driven, outer)
    motion = MeshMotion(structure, 4, body_edges(structure, driven), mover)
    state = motion.reference
    for s in (0.2, 0.4):
        state = motion.move(state, motion.reference.positions + s * np.array([1.0, 0.5]))
    vertices = state.vertices[outer]
    np.testing.assert_allclose(np.hypot(*vertices.T), 3.0, atol=1e-10)
    assert np.abs(vertices - structure.vertices[outer]).max() > 0.01
    # All nodes on the outer boundary are on the circle, the mesh is that of the moved structure, and its area is right.
    edges = np.flatnonzero(np.isin(structure.topology.edges, outer).all(axis=1))
    for edge in edges:
        nodes = state.mesh.points[motion._plan.nodes_of_edge(int(edge))]
        np.testing.assert_allclose(np.hypot(*nodes.T), 3.0, atol=1e-10)
    np.testing.assert_allclose(generate(state.structure, 4).points, state.mesh.points, atol=1e-12)
    assert state.min_det_J > 0.0


def test_sliding_keeps_a_rotated_body_in_its_disc():
    structure, driven, outer = ring()
    for sliding, least in ((None, 30.0), (outer, 359.0)):
        motion = MeshMotion(
            structure, 2, body_edges(structure, driven), BarrierEnergy(structure, driven, sliding=sliding), halvings=0
        )
        state, angle = motion.reference, 0.0
        for degrees in np.arange(10.0, 361.0, 10.0):
            a = np.radians(degrees)
            turn = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
            try:
                state = motion.move(state, motion.reference.positions @ turn)
            except (InvalidMeshError, MoverError):
                break
            angle = degrees
        assert angle >= least
        assert (angle < 359.0) == (sliding is None)
    # With sliding the whole mesh has turned with the body.
    np.testing.assert_allclose(state.mesh.points, motion.reference.mesh.points, atol=1e-8)


def test_an_ellipse_is_followed_exactly():
    circle, driven, outer = ring()
    topology = circle.topology
    squeezed = circle.vertices * [1.0, 0.8]
    named = dict(zip(topology.vertex_names, map(tuple, squeezed), strict=True))
    stretched = BlockStructure.build(
        named,
        [tuple(topology.vertex_names[v] for v in quad) for quad in topology.quads],
        curves={
            tuple(topology.vertex_names[v] for v in topology.edges[edge]): Ellipse.from_center(
                (0.0, 0.0), (3.0, 2.4), 0.0, *squeezed[topology.edges[edge]]
            )
            for edge in circle.curves
        },
    )
    mover = BarrierEnergy(stretched, driven, sliding=outer)
    vertices = mover.move(stretched.vertices, stretched.vertices[driven] + [0.3, -0.2])
    x, y = vertices[outer].T
    np.testing.assert_allclose((x / 3.0) ** 2 + (y / 2.4) ** 2, 1.0, atol=1e-11)
    assert np.abs(vertices[outer] - stretched.vertices[outer]).max() > 0.01
    bound = mover._block.bound(vertices[driven], None)
    assert np.abs(bound.derivatives(mover._block.unknowns(vertices), 0.0, False)[1]).max() < 1e-8


def box(n=4):
    x = np.arange(n + 1.0)
    vertices = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    hole = [q for q in quads.tolist() if q != [6, 7, 12, 11]]
    return BlockStructure.build(vertices, hole, counts=2)


def test_vertices_that_can_slide_along_the_sides_of_a_box():
    structure = box()
    driven = np.array([6, 7, 11, 12])
    outer = [
        e for e in np.flatnonzero(structure.topology.blocks_per_edge == 1) if e not in body_edges(structure, driven)
    ]
    found = sliding_vertices(structure, outer, driven)
    x, y = structure.vertices[found].T
    assert len(found) == 12  # three on each side, no corners
    assert ((x % 4.0 == 0.0) ^ (y % 4.0 == 0.0)).all()
    bottom = [e for e in outer if (structure.vertices[structure.topology.edges[e], 1] == 0.0).all()]
    assert sliding_vertices(structure, bottom, driven).tolist() == [1, 2, 3]


@pytest.mark.parametrize("name", MOVERS)
def test_vertices_stay_on_the_straight_sides_of_a_box(name):
    structure = box()
    driven = np.array([6, 7, 11, 12])
    sliding = np.array([1, 2, 3, 5, 9, 10, 14, 15, 19, 21, 22, 23])
    mover = MOVERS[name](structure, driven, sliding)
    moved = mover.move(structure.vertices, structure.vertices[driven] + [0.2, 0.1])
    on_bottom_or_top = np.isin(structure.vertices[sliding, 1], (0.0, 4.0))
    across = np.where(on_bottom_or_top, 1, 0)
    rows = np.arange(len(sliding))
    np.testing.assert_array_equal(moved[sliding][rows, across], structure.vertices[sliding][rows, across])
    assert (moved[sliding] != structure.vertices[sliding]).any()


@pytest.mark.parametrize(
    ("sliding", "match"),
    [
        ([0], "the boundary turns by 90° at vertex '0'; a vertex can slide only where it is smooth"),
        ([6], "vertex '6' is driven; a vertex can only do one"),
        ([13], "vertex '13' is inside; expected vertices on the boundary"),
        ([3, 2], "sliding: .*expected ascending vertex numbers"),
        ([99], "sliding: .*expected ascending vertex numbers from 0 to 24"),
    ],
)
def test_vertices_that_cannot_slide(sliding, match):
    structure = box()
    for make in (BarrierEnergy, PseudoSolid, AngleOptimisation):
        with pytest.raises(MoverError, match=match):
            make(structure, np.array([6, 7, 11, 12]), sliding=np.array(sliding))


def test_a_path_follows_where_its_end_is_driven_away():
    """Half a ring: one end of its outer arc is driven, the inner vertices slide; the last edge meets the moved end."""
    angle = np.pi * np.arange(5) / 4.0
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    vertices = np.concatenate([circle, 2.0 * circle])
    blocks = [(k, k + 5, k + 6, k + 1) for k in range(4)]
    curves = {(str(k), str(k + 1)): Arc.from_center((0.0, 0.0), vertices[k], vertices[k + 1]) for k in range(5, 9)}
    named = {str(k): tuple(x) for k, x in enumerate(vertices)}
    structure = BlockStructure.build(named, [tuple(map(str, b)) for b in blocks], counts=2, curves=curves)
    driven = np.array([0, 5])
    edge = structure.topology.find_edge(0, 5)
    mover = BarrierEnergy(structure, driven, sliding=np.array([6, 7, 8]))
    motion = MeshMotion(structure, 4, [edge], mover)
    state = motion.move(motion.reference, motion.reference.positions + np.array([0.1, 0.05]))
    np.testing.assert_allclose(state.vertices[5], [2.1, 0.05], atol=1e-15)
    np.testing.assert_allclose(np.hypot(*state.vertices[6:9].T), 2.0, atol=1e-12)
    np.testing.assert_allclose(generate(state.structure, 4).points, state.mesh.points, atol=1e-12)
