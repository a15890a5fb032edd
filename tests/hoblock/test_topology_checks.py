import tracemalloc

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import TopologyError

SQUARE = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}


def expect(match, vertices, blocks, **options):
    with pytest.raises(TopologyError, match=match):
        BlockStructure.build(vertices, blocks, **options)


def test_vertices_must_be_finite_and_distinct():
    expect("vertex 'c': not finite", {**SQUARE, "c": (1, float("nan"))}, [tuple("abcd")])
    expect(
        r"vertices 'b' and 'x' coincide at \(1, 0\). Use one vertex for both", {**SQUARE, "x": (1, 0)}, [tuple("abcd")]
    )
    expect(r"vertices: shape \(4, 3\); expected \(n, 2\)", np.zeros((4, 3)), [(0, 1, 2, 3)])


def test_coinciding_vertices_are_found_where_others_lie_between_them_in_the_sorting():
    vertices = {**SQUARE, "x": (0.5, 0.2), "y": (0.5 - 2e-14, 0.7), "z": (0.5 - 4e-14, 0.2)}
    expect("vertices 'x' and 'z' coincide", vertices, [tuple("abcd")])


def test_blocks_need_four_known_different_vertices():
    expect(
        r"blocks.fluid\[1\]: no vertex named 'e'; known names: a, b, c, d",
        SQUARE,
        {"fluid": [tuple("abcd"), tuple("abce")]},
    )
    expect(r"blocks.blocks\[0\]: \['a', 'b', 'c'\]; expected four different vertices", SQUARE, [tuple("abc")])
    expect("expected four different vertices", SQUARE, [tuple("abca")])
    expect("there are no blocks; expected at least one quad", SQUARE, {})
    expect(r"blocks\.empty: there are no blocks; expected at least", SQUARE, {"a": [tuple("abcd")], "empty": []})


def test_clockwise_and_reentrant_blocks():
    expect(
        r"blocks.body\[0\] \(.*\) is clockwise or inverted \(signed area -1\). List its vertices counter-clockwise",
        SQUARE,
        {"body": [tuple("adcb")]},
    )
    expect(
        r"blocks.blocks\[0\] .*: the angle at vertex 'c' \(0.2, 0.2\) is 180° or more. Move a vertex or split",
        {**SQUARE, "c": (0.2, 0.2)},
        [tuple("abcd")],
    )
    expect("the angle at vertex 'c'", {**SQUARE, "c": (0.5, 0.5)}, [tuple("abcd")])


def test_a_corner_at_a_curve_is_left_to_the_check_of_the_mesh():
    vertices = {**SQUARE, "c": (0.45, 0.45)}
    curve = Arc.through(vertices["b"], (0.9, 0.5), vertices["c"])
    structure = BlockStructure.build(vertices, [tuple("abcd")], curves={("b", "c"): curve})
    assert len(structure.curves) == 1
    elsewhere = Arc.through((0, 0), (0.5, -0.1), (1, 0))
    expect("the angle at vertex 'c'", vertices, [tuple("abcd")], curves={("a", "b"): elsewhere})


def test_vertices_without_a_block():
    expect(
        "vertices 'x', 'y' belong to no block. Remove them or add the block",
        {**SQUARE, "x": (2, 2), "y": (3, 3)},
        [tuple("abcd")],
    )


def test_hanging_vertices():
    vertices = {**SQUARE, "e": (1, 0.4), "f": (2, 0), "g": (2, 0.4), "h": (2, 1)}
    expect(
        "vertex 'e' lies on edge b–c: the blocks do not conform. Split the block at that edge",
        vertices,
        [tuple("abcd"), tuple("bfge"), tuple("eghc")],
    )


@pytest.mark.parametrize("counts", [{("a", "b"): 2, ("d", "c"): 3}, {("a", "b"): 2, ("c", "d"): 3}])
def test_conflicting_counts_name_both_edges_and_the_chain(counts):
    expect(
        r"edges a–b and d–c ask for 2 and 3 elements but belong to one chain of opposite edges \(.*a–b.*\)",
        SQUARE,
        [tuple("abcd")],
        counts=counts,
    )


def test_counts_below_one():
    expect("edge a–b: 0 elements; expected at least 1", SQUARE, [tuple("abcd")], counts={("a", "b"): 0})
    expect("counts: 0 elements; expected at least 1", SQUARE, [tuple("abcd")], counts=0)
    expect("default number of elements: 0 elements; expected", SQUARE, [tuple("abcd")], counts={}, default_count=0)


def test_vertices_are_pairs_of_numbers_with_names_of_their_own():
    expect(r"vertex 'c': \(1, 1, 0\); expected two numbers", {**SQUARE, "c": (1, 1, 0)}, [tuple("abcd")])
    expect(r"vertex 'c': \('x', 1\); expected two numbers", {**SQUARE, "c": ("x", 1)}, [tuple("abcd")])
    expect("vertex 'c': 3; expected two numbers", {**SQUARE, "c": 3}, [tuple("abcd")])
    flat = {name: (*xy, 0.0) for name, xy in SQUARE.items()}
    expect("vertex 'a': .* expected two numbers", flat, [tuple("abcd")])
    expect("two are named '1'", {1: (0, 0), "1": (5, 5), "b": (1, 0)}, [tuple("abcd")])


@pytest.mark.parametrize("counts", [2.5, 2.0, True, {("a", "b"): 2.5}, {("a", "b"): "3"}])
def test_counts_are_integers(counts):
    expect("expected an integer >= 1", SQUARE, [tuple("abcd")], counts=counts)


def test_counts_may_be_integers_of_numpy():
    for counts in (np.int64(3), {("a", "b"): np.int32(3), ("a", "d"): 3}):
        assert BlockStructure.build(SQUARE, [tuple("abcd")], counts=counts).topology.counts.tolist() == [3] * 4


def test_edges_are_pairs():
    for option in ({"edges": {"wall": [("a", "b", "c")]}}, {"edges": {"wall": ["ab"]}}, {"counts": {"ab": 2}}):
        expect("expected a pair of vertices", SQUARE, [tuple("abcd")], **option)


def test_blocks_without_area():
    expect("has no area between the chords", SQUARE, [tuple("abdc")])
    two = np.array([(1, 0), (2, 0), (-2, 0), (-1, 0)])  # an annulus of two sectors
    expect("has no area between the chords of its edges: .* or split it", two, [(0, 1, 2, 3), (3, 2, 1, 0)])


@pytest.mark.parametrize(("size", "place"), [(1e-6, 0.0), (1e-12, 0.0), (1e6, 0.0), (1.0, 1e9), (1e-3, 1e6)])
def test_checks_do_not_depend_on_size_and_place(size, place):
    points = place + size * np.array(list(SQUARE.values()))
    assert BlockStructure.build(points, [(0, 1, 2, 3)]).topology.quads.tolist() == [[0, 1, 2, 3]]
    expect("is clockwise or inverted", points, [(0, 3, 2, 1)])


def test_slits_are_refused_where_their_sides_coincide():
    x, y = np.meshgrid(np.arange(3.0), np.arange(3.0))
    vertices = np.concatenate([np.stack([x.ravel(), y.ravel()], axis=-1), [(1.0, 1.0)]])
    quads = [(0, 1, 4, 3), (1, 2, 5, 4), (3, 9, 7, 6), (9, 5, 8, 7)]
    expect("vertices '4' and '9' coincide .* Use one vertex for both", vertices, quads)
    vertices[4, 1], vertices[9, 1] = 1 - 1e-6, 1 + 1e-6
    structure = BlockStructure.build(vertices, quads)
    assert (structure.topology.blocks_per_edge == 1).sum() == 12


@pytest.mark.parametrize("upright", [False, True])
def test_a_long_channel_is_checked_without_comparing_all_pairs(upright):
    count = 3000
    x, y = np.meshgrid(np.arange(count + 1.0), [0.0, 1.0])
    vertices = np.stack([x.ravel(), y.ravel()], axis=-1)
    quads = np.array([(k, k + 1, count + k + 2, count + k + 1) for k in range(count)])
    if upright:
        vertices = vertices[:, ::-1] * [-1.0, 1.0]
    tracemalloc.start()
    BlockStructure.build(vertices, quads)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 5e7


def test_hanging_vertices_of_upright_and_slanted_edges():
    vertices = np.array([(0, 0), (2, 0), (2, 2), (0, 2), (4, 0), (4, 1), (2, 1), (4, 2)], dtype=float)
    quads = [(0, 1, 2, 3), (1, 4, 5, 6), (6, 5, 7, 2)]
    for angle in (0.0, 0.4, np.pi / 2):
        c, s = np.cos(angle), np.sin(angle)
        expect("vertex '6' lies on edge 1–2", vertices @ np.array([[c, s], [-s, c]]), quads)
