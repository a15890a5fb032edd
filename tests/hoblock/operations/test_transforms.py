import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Affine, Arc, NodalCurve
from hoblock.errors import TopologyError
from hoblock.generate import generate
from hoblock.grading import BoundaryLayer
from hoblock.layout import layout
from hoblock.operations.transforms import mirrored, rotated, scaled, transformed, translated

ALL = ("grid", "disc", "star", "annulus")


@pytest.mark.parametrize("kind", ALL)
def test_the_mesh_of_the_image_is_the_image_of_the_mesh(kind, layouts, rng):
    structure = layouts.random(kind, rng)
    points = generate(structure, 4, check=False).points
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    center = np.array([0.3, -1.2])
    skew = np.array([[1.3, 0.4], [-0.2, 0.8]])
    for image, expected in (
        (translated(structure, (3.0, -4.0)), points + np.array([3.0, -4.0])),
        (rotated(structure, 0.7, center), (points - center) @ turn.T + center),
        (scaled(structure, 2.5, center), 2.5 * (points - center) + center),
        (scaled(structure, (2.0, 0.5)), points * [2.0, 0.5]),
        (scaled(structure, -1.0), -points),
        (transformed(structure, skew, (1.0, 2.0)), points @ skew.T + [1.0, 2.0]),
    ):
        assert image.topology is structure.topology  # so the layout of meshes is shared
        np.testing.assert_allclose(generate(image, 4, check=False).points, expected, atol=1e-13)


@pytest.mark.parametrize("kind", ALL)
@pytest.mark.parametrize(("point", "direction"), [((0, 0), (0, 1)), ((1, 2), (-3, 1))])
def test_mirror_images(kind, point, direction, layouts, rng):
    structure = layouts.random(kind, rng)
    image = mirrored(structure, point, direction)
    mesh, turned = generate(structure, 3, check=False), generate(image, 3, check=False)
    along = np.array(direction) / np.hypot(*direction)
    offset = mesh.points - point
    expected = point + 2.0 * np.outer(offset @ along, along) - offset
    assert _distance(turned.points, expected) < 1e-13
    assert image.topology.vertex_names == structure.topology.vertex_names
    corners = image.vertices[image.topology.quads]
    first, second = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    assert (first[:, 0] * second[:, 1] > first[:, 1] * second[:, 0]).all()
    twice = mirrored(image, point, direction)
    np.testing.assert_array_equal(twice.topology.quads, structure.topology.quads)
    np.testing.assert_allclose(generate(twice, 3, check=False).points, mesh.points, atol=1e-13)


def _distance(points, expected):
    """Largest distance from a point to the nearest expected one; the numberings differ."""
    return max(np.hypot(*(expected - point).T).min() for point in points)


def test_mirrored_blocks_follow_the_conventions(layouts, rng):
    topology = mirrored(layouts.random("star", rng)).topology
    a, b, c, d = topology.quads.T
    bottom, right, top, left = (topology.edges[topology.block_edges[:, k]] for k in range(4))
    for edge, (first, second) in ((bottom, (a, b)), (right, (b, c)), (top, (d, c)), (left, (a, d))):
        np.testing.assert_array_equal(edge, np.stack([first, second], axis=-1))


def test_arcs_and_nodes_remain_what_they_are(layouts):
    ring = layouts.annulus(4, counts=2)
    for image in (rotated(ring, 1.0), scaled(ring, 3.0), mirrored(ring, (1, 1), (1, 2)), translated(ring, (1, 2))):
        assert {type(curve) for curve in image.curves.values()} == {Arc}
    assert {type(curve) for curve in scaled(ring, (2, 1)).curves.values()} == {Affine}
    nodes = NodalCurve(np.array([(0, 0), (0.3, -0.1), (0.5, 0), (0.8, 0.05), (1, 0)]), 2)
    square = layouts.square(counts=2, curves={("a", "b"): nodes})
    (curve,) = mirrored(square, (0, 0), (1, 0)).curves.values()
    np.testing.assert_allclose(curve.points, nodes.points * [1, -1], atol=1e-15)


def test_vertices_slide_on_rotated_arcs(layouts):
    """An arc that has been walked backwards and moved is still cut anew from its circle."""
    corners = np.array([(1, 0), (2, 0), (0, 2), (0, 1)], dtype=float)
    arc = Arc.from_center((0, 0), corners[2], corners[1])
    structure = rotated(BlockStructure.build(corners, [(0, 1, 2, 3)], curves={(2, 1): arc}), 0.5)
    vertices = np.array(structure.vertices)
    vertices[1] = 2.0 * np.array([np.cos(0.3), np.sin(0.3)])
    (curve,) = structure.moved(vertices).curves.values()
    np.testing.assert_allclose(np.hypot(*curve(np.linspace(0, 1, 9)).T), 2.0, atol=1e-14)


def test_a_first_height_is_kept_when_the_structure_is_scaled(layouts):
    structure = layouts.square(counts=8, gradings={("a", "d"): BoundaryLayer(0.01)})
    for image in (structure, scaled(structure, 5.0)):
        edge, _ = image.topology.edge(0, 3)
        nodes = generate(image, 1).points[layout(image, 1).nodes_of_edge(edge)]
        assert np.hypot(*(nodes[1] - nodes[0])) == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda s: translated(s, 3.0), r"translated: offset is 3.0; expected finite numbers of shape \(2,\)"),
        (lambda s: translated(s, ("x", 1)), "translated: offset is"),
        (lambda s: rotated(s, np.nan), "rotated: angle is nan; expected finite numbers"),
        (lambda s: rotated(s, 1.0, (1, 2, 3)), "rotated: about is"),
        (lambda s: scaled(s, 0.0), "is singular; blocks would have no area"),
        (lambda s: scaled(s, (1.0, 2.0, 3.0)), "scaled: factor is"),
        (lambda s: mirrored(s, (0, 0), (0, 0)), r"mirrored: direction is \(0, 0\); expected the direction"),
        (lambda s: transformed(s, np.ones((2, 2))), "is singular"),
        (lambda s: transformed(s, np.eye(3)), "transformed: matrix is"),
    ],
)
def test_impossible_transformations(change, match, layouts):
    with pytest.raises(TopologyError, match=match):
        change(layouts.square())
