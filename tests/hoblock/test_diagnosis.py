"""Invalid meshes say where and why."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import NodalCurve, Parametric
from hoblock.diagnosis import diagnose
from hoblock.errors import CurveError, InvalidMeshError
from hoblock.generate import generate, raise_if_invalid
from hoblock.grading import Listed, Quadratic
from hoblock.quality import certify

SQUARE = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}


def square(**options):
    return BlockStructure.build(SQUARE, {"body": [("a", "b", "c", "d")]}, **options)


def moved(structure, **places):
    vertices = np.array(structure.vertices)
    for name, place in places.items():
        vertices[structure.topology.vertex(name)] = place
    return structure.moved(vertices)


def reason(structure, order=4):
    with pytest.raises(InvalidMeshError) as caught:
        generate(structure, order)
    return caught.value.elements[0].reason


def test_a_curve_that_bulges_through_the_opposite_edge(layouts):
    text = reason(square(counts=3, curves={("a", "b"): layouts.bump((0, 0), (1, 0), 1.3)}))
    assert text.startswith("The curve of edge a–b bulges through the opposite edge d–c near (0.2")
    assert "Give edge d–c a curve as well" in text


def test_a_curve_that_bulges_through_the_neighbouring_edge():
    def hook(t):
        return np.stack([t - 1.2 * np.sin(np.pi * t) * (1 - t), 0.6 * np.sin(np.pi * t)], axis=-1)

    text = reason(square(counts=2, curves={("a", "b"): Parametric(hook)}))
    assert text.startswith("The curve of edge a–b bulges through the neighbouring edge a–d near (")


def test_a_curve_that_crosses_itself():
    def loop(t):
        return np.stack([t + 0.5 * np.sin(2 * np.pi * t), 0.2 * np.sin(np.pi * t)], axis=-1)

    text = reason(square(counts=4, curves={("a", "b"): Parametric(loop)}))
    assert text.startswith("The curve of edge a–b crosses itself near (0.5")


def test_the_angle_at_a_vertex():
    text = reason(moved(square(counts=2), c=(0.3, 0.3)))
    assert text.startswith("The angle at vertex 'c' between edges b–c and d–c is 223.6°; must be below 180°. Move the")


def test_the_angle_between_curves():
    """Straight edges at 90°; the curve leaves its vertex at more than 180° from the other one."""

    def belly(t):
        return np.stack([t, -0.5 * np.sin(np.pi * t)], axis=-1)

    def side(t):
        return np.stack([-0.5 * np.sin(np.pi * t), t], axis=-1)

    structure = square(counts=2, curves={("a", "b"): Parametric(belly), ("a", "d"): Parametric(side)})
    assert "The angle at vertex 'a' between edges a–d and a–b is 205" in reason(structure)


@pytest.mark.parametrize("order", [1, 3, 6])
def test_an_angle_of_180_degrees_is_undecided(order):
    structure = moved(square(counts=2), c=(0.5, 0.5))
    with pytest.raises(InvalidMeshError, match=r"1 of 4 elements is undecided: rounding hides the sign") as caught:
        generate(structure, order)
    (bad,) = caught.value.elements
    assert (bad.status, bad.x, bad.y) == ("undecided", 0.5, 0.5)
    assert bad.reason.startswith("The angle at vertex 'c' between edges b–c and d–c is 180°; must be below 180°")


def test_edges_that_cross():
    structure = moved(square(counts=1), c=(0, 1), d=(1, 1))
    assert reason(structure, 1).startswith("The edges b–c and a–d of its block cross near (0.5, 0.5)")


def test_an_inverted_block():
    structure = square(counts=2)
    mirrored = structure.moved(structure.vertices * [-1, 1])
    assert reason(mirrored, 2).startswith("The block is inverted: its vertices run clockwise")


def test_an_edge_without_length():
    structure = moved(square(counts=2), c=(1, 0))
    assert reason(structure, 2).startswith("The edge b–c of its block has no length")


def test_a_map_that_folds_between_its_edges():
    """The bottom has the shape of a mushroom: lines blended with straight sides cannot follow its overhangs."""

    def mushroom(t):
        return np.stack([t + 0.12 * np.sin(4 * np.pi * t), 0.5 * np.sin(np.pi * t)], axis=-1)

    text = reason(square(counts=8, curves={("a", "b"): Parametric(mushroom)}))
    assert text.startswith("The map of the block folds between its edges")
    assert text.endswith("curve the edges opposite to: a–b.")


def test_a_grading_that_is_too_strong(layouts):
    """Both curves bend alike, so the block is valid; opposite gradings join the flank of one to the other's crest."""
    curves = {
        ("a", "b"): layouts.bump((0, 0), (1, 0), 0.6),
        ("d", "c"): layouts.bump((0, 1), (1, 1), 0.6),
    }
    fractions = (0.0, 0.04, 0.08, 0.12, 0.5, 1.0)
    gradings = {("a", "b"): Listed(fractions), ("d", "c"): Listed(tuple(1.0 - f for f in fractions[::-1]))}
    generate(square(counts={("a", "b"): 5, ("a", "d"): 2}, curves=curves), 4)
    text = reason(square(counts={("a", "b"): 5, ("a", "d"): 2}, curves=curves, gradings=gradings))
    assert text.startswith("The grading is too strong: without it the block's map is valid")
    assert "a–b and d–c" in text


def test_an_element_too_coarse_for_its_curve():
    def waves(t):
        return np.stack([t + 0.035 * np.sin(8 * np.pi * t), 0.1 * np.sin(8 * np.pi * t)], axis=-1)

    def structure(count):
        vertices = {**SQUARE, "c": (1, 0.4), "d": (0, 0.4)}
        return BlockStructure.build(
            vertices,
            {"body": [("a", "b", "c", "d")]},
            counts={("a", "b"): count, ("b", "c"): 1},
            curves={("a", "b"): Parametric(waves)},
        )

    assert certify(generate(structure(8), 6)).valid
    text = reason(structure(1), 12)
    assert text.startswith("The element is too coarse for a curve")
    assert "elements now: a–b (1)" in text


def test_points_that_are_not_finite(layouts):
    structure = square(counts=2)
    mesh = generate(structure, 2)
    points = np.array(mesh.points)
    points[mesh.cells[2, 4]] = np.nan
    with pytest.raises(
        InvalidMeshError, match=r"Its nodes are not finite. Check where the points of the mesh come from"
    ):
        raise_if_invalid(mesh.with_points(points), structure)


def test_vertices_that_are_not_finite():
    with pytest.raises(
        InvalidMeshError, match=r"nodes are not finite: the edge b–c has points that are NaN or infinite"
    ):
        generate(moved(square(counts=2), c=(np.nan, 1.0)), 3)


@pytest.mark.parametrize("size", [1e-200, 1e200])
def test_reasons_do_not_depend_on_size(size):
    structure = moved(square(counts=2), c=(0.3, 0.3))
    assert "The angle at vertex 'c'" in reason(structure.moved(size * structure.vertices))


def test_a_curve_without_points_between_the_nodes_falls_back_to_the_element(layouts):
    bump = layouts.bump((0, 0), (1, 0), 1.3)

    def patchy(t):
        if len(t) > 100:
            raise CurveError("no point here")
        return bump(t)

    text = reason(square(counts=2, curves={("a", "b"): Parametric(patchy)}))
    assert text.startswith("The angle at that corner") or text.startswith("Edges of its block cross")


def test_several_elements_are_listed_worst_first_and_kept_by_the_error(layouts):
    structure = moved(square(counts=4), c=(0.3, 0.3))
    with pytest.raises(InvalidMeshError) as caught:
        generate(structure, 3)
    error = caught.value
    assert str(error).count("element ") >= 3
    assert str(error).count("The angle at vertex") == 1  # a reason is told once
    assert [bad.det_J for bad in error.elements] == sorted(bad.det_J for bad in error.elements)
    assert {bad.block for bad in error.elements} == {"blocks.body[0] (a, b, c, d)"}
    assert error.certificate.counts["invalid"] == len(error.elements)
    second = copy.deepcopy(error)
    assert (str(second), len(second.elements)) == (str(error), len(error.elements))


def test_bad_elements_of_several_blocks_have_reasons_of_their_own():
    vertices = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1), "e": (2, 0), "f": (2, 1)}
    structure = BlockStructure.build(vertices, {"body": [("a", "b", "c", "d"), ("b", "e", "f", "c")]})
    bent = moved(structure, d=(0.8, 0.4), f=(1.1, 0.3))
    mesh = generate(bent, 2, check=False)
    found = diagnose(mesh, bent, certify(mesh))
    assert {bad.block.split(" ")[0] for bad in found} == {"blocks.body[0]", "blocks.body[1]"}
    assert {bad.reason.split("'")[1] for bad in found} == {"d", "f"}


def test_interface_nodes_that_cross():
    points = np.array([(0, 0), (0.6, 0), (0.4, 0.0), (1, 0)], dtype=float)
    structure = square(curves={("a", "b"): NodalCurve(points, 3)})
    text = reason(structure, 3)
    assert text[0].isupper()
    assert text.endswith(".")


def test_a_grading_with_a_straight_block_is_never_at_fault():
    structure = square(counts=5, gradings={("a", "b"): Quadratic(0.95), ("d", "c"): Quadratic(-0.95)})
    assert certify(generate(structure, 5)).valid
