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
    expect("default number of elements is 0; expected at least 1", SQUARE, [tuple("abcd")], counts=0)
