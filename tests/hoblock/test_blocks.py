import traceback

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, Displaced, NodalCurve, Parametric
from hoblock.errors import CurveError, GradingError, TopologyError
from hoblock.generate import generate
from hoblock.grading import BoundaryLayer, Exponential, Uniform, reverse
from hoblock.layout import layout

VERTICES = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (0, 1), "e": (1, 1), "f": (2, 1)}
BLOCKS = {"left": [("a", "b", "e", "d")], "right": [("b", "c", "f", "e")]}


def build(**options):
    return BlockStructure.build(VERTICES, BLOCKS, **options)


def test_names_groups_and_incidence():
    structure = build(edges={"bottom": [("b", "a"), ("b", "c")], "seam": [("e", "b")]})
    topology = structure.topology
    assert topology.vertex_names == tuple("abcdef")
    assert len(topology.edges) == 7
    assert {name: list(blocks) for name, blocks in topology.block_groups.items()} == {"left": [0], "right": [1]}
    assert {topology.edge_name(k) for k in topology.edge_groups["bottom"]} == {"a–b", "b–c"}
    assert list(topology.blocks_per_edge[topology.edge_groups["seam"]]) == [2]
    assert [topology.vertex_names[v] for v in topology.boundary_vertices] == list("abcdef")
    assert topology.block_name(1) == "blocks.right[0] (b, c, f, e)"
    edge, forward = topology.edge(topology.vertex("e"), topology.vertex("b"))
    assert not forward
    assert topology.edge_name(edge) == "b–e"


def test_vertices_of_an_array_are_named_by_their_index():
    structure = BlockStructure.build(np.array([(0, 0), (1, 0), (1, 1), (0, 1)]), [(0, 1, 2, 3)], counts=3)
    assert structure.topology.vertex_names == ("0", "1", "2", "3")
    assert list(structure.topology.counts) == [3, 3, 3, 3]
    assert list(structure.topology.block_groups) == ["blocks"]


def test_counts_spread_along_chains_only():
    structure = build(counts={("a", "d"): 4, ("b", "c"): 3}, default_count=2)
    topology = structure.topology
    counts = {topology.edge_name(k): int(n) for k, n in enumerate(topology.counts)}
    assert counts == {"a–b": 2, "d–e": 2, "b–c": 3, "e–f": 3, "a–d": 4, "b–e": 4, "c–f": 4}


def test_curves_and_gradings_given_against_an_edge_are_turned():
    bump = Parametric(lambda s: np.stack([1 - s, 0.2 * s * (1 - s) ** 3], axis=-1))
    structure = build(curves={("b", "a"): bump}, gradings={("b", "a"): Exponential(2.0), ("b", "c"): Exponential(1.0)})
    edge, forward = structure.topology.edge(0, 1)
    assert forward
    assert structure.gradings[edge] == Exponential(-2.0)
    assert structure.gradings[structure.topology.edge(1, 2)[0]] == Exponential(1.0)
    assert structure.gradings[structure.topology.edge(0, 3)[0]] == Uniform()
    t = np.array([0.0, 0.25, 1.0])
    np.testing.assert_allclose(structure.curves[edge](t), bump(1 - t))


def test_everything_is_read_only():
    structure = build()
    for array in (structure.vertices, structure.topology.quads, structure.topology.counts):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    with pytest.raises(TypeError):
        structure.curves[0] = Arc((0, 0), 1, 0, 1)


def arc_structure():
    vertices = {"a": (1, 0), "b": (2, 0), "c": (0, 2), "d": (0, 1)}
    arcs = {("b", "c"): Arc.from_center((0, 0), (2, 0), (0, 2)), ("a", "d"): Arc.from_center((0, 0), (1, 0), (0, 1))}
    return BlockStructure.build(vertices, [("a", "b", "c", "d")], counts=2, curves=arcs)


def test_moved_shares_the_topology_and_displaces_curves_of_moved_ends_only():
    structure = arc_structure()
    outer, inner = structure.topology.edge(1, 2)[0], structure.topology.edge(0, 3)[0]
    vertices = np.array(structure.vertices)
    vertices[2] += (0.1, 0.3)
    moved = structure.moved(vertices)
    assert moved.topology is structure.topology
    assert moved.gradings is structure.gradings
    assert moved.curves[inner] is structure.curves[inner]
    assert isinstance(moved.curves[outer], Displaced)
    t = np.linspace(0, 1, 5)
    np.testing.assert_allclose(moved.curves[outer](t), structure.curves[outer](t) + t[:, None] * [0.1, 0.3], atol=1e-15)
    np.testing.assert_array_equal(structure.vertices[2], [0, 2])


def test_moving_many_times_does_not_nest_displacements():
    structure = arc_structure()
    outer = structure.topology.edge(1, 2)[0]
    there, back = np.array(structure.vertices), np.array(structure.vertices)
    there[[1, 2]] += [(0.2, 0.1), (-0.1, 0.3)]
    moved = structure
    for k in range(5):
        moved = moved.moved((1.0 + 0.1 * k) * there)
    assert isinstance(moved.curves[outer], Displaced)
    assert isinstance(moved.curves[outer].curve, Arc)
    t = np.linspace(0, 1, 5)
    np.testing.assert_allclose(moved.moved(back).curves[outer](t), structure.curves[outer](t), atol=1e-14)


def test_moved_takes_new_curves():
    structure = arc_structure()
    outer = structure.topology.edge(1, 2)[0]
    points = np.array([(2, 0), (1.5, 1.5), (0, 2)])
    nodal = NodalCurve(points, 1)
    assert structure.moved(structure.vertices, {outer: nodal}).curves[outer] is nodal


def test_restricted_keeps_names_directions_and_counts(layouts, rng):
    structure = build(
        counts={("a", "d"): 4, ("b", "c"): 3},
        edges={"top": [("d", "e"), ("e", "f")], "out": [("c", "f")]},
        gradings={("f", "c"): Exponential(1.0)},
        curves={("b", "c"): layouts.bump((1, 0), (2, 0), 0.1)},
    )
    part = structure.restricted(["right"])
    topology = part.topology
    assert topology.vertex_names == ("b", "c", "e", "f")
    assert list(topology.block_groups) == ["right"]
    counts = {topology.edge_name(k): int(n) for k, n in enumerate(topology.counts)}
    assert counts == {"b–c": 3, "e–f": 3, "b–e": 4, "c–f": 4}
    assert [topology.edge_name(k) for k in topology.edge_groups["top"]] == ["e–f"]
    assert [topology.edge_name(k) for k in part.curves] == ["b–c"]
    assert part.gradings[topology.edge_groups["out"][0]] == Exponential(-1.0)
    assert "out" not in structure.restricted(["left"]).topology.edge_groups
    both = structure.restricted(["left", "right"])
    np.testing.assert_array_equal(both.topology.quads, structure.topology.quads)


def test_shared_edges_and_with_edge_group():
    structure = build()
    seam = structure.shared_edges(["left"], ["right"])
    assert [structure.topology.edge_name(k) for k in seam] == ["b–e"]
    named = structure.with_edge_group("interface", seam)
    assert list(named.topology.edge_groups["interface"]) == list(seam)
    assert "interface" not in structure.topology.edge_groups


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"edges": {"wall": [("a", "g")]}}, "edges.wall: no vertex named 'g'"),
        ({"edges": {"wall": [("a", "e")]}}, "no block edge joins 'a' and 'e'. Name two corners of one side"),
        ({"edges": {"wall": [("b", "a"), ("a", "d"), ("a", "b")]}}, "edges.wall: edge a–b is listed twice. Remove one"),
        ({"edges": {"wall": []}}, "edges.wall: no edges; expected at least one pair of vertices. Remove the name"),
        ({"counts": {("a", "x"): 2}}, "counts: no vertex named 'x'"),
        ({"gradings": {("a", "b"): Uniform(), ("b", "a"): Uniform()}}, "gradings: edge a–b is given twice. Remove one"),
        ({"curves": {("q", "b"): Arc((0, 0), 1, 0, 1)}}, "curves: no vertex named 'q'"),
    ],
)
def test_bad_references(options, match):
    with pytest.raises(TopologyError, match=match):
        build(**options)


def test_a_curve_that_misses_its_vertex():
    arc = Arc((0.5, 0.0), 0.5, np.pi, -np.pi)
    assert build(curves={("a", "b"): arc}).curves
    match = (
        r"curve on edge a–b: end point \(1, .*\) is 1 away from vertex 'a' at \(0, 0\); must coincide "
        r"within 2e-09\. Check the curve's direction"
    )
    with pytest.raises(CurveError, match=match):
        build(curves={("b", "a"): arc})
    with pytest.raises(CurveError, match="away from vertex 'a'"):
        build(curves={("a", "b"): NodalCurve(np.array([(0, 0.1), (1, 0)]), 1)})


def test_a_curve_with_its_coordinates_in_rows_is_told_so():
    match = r"end point \(0, 1\) is 1 away from .* The curve seems to return a row of x and a row of y: return"
    with pytest.raises(CurveError, match=match):
        build(curves={("a", "b"): lambda t: np.stack([t, 0.1 * np.sin(np.pi * t)])})


def test_unknown_names_suggest_close_ones():
    structure = build()
    with pytest.raises(TopologyError, match="no vertex named 'A'"):
        structure.topology.vertex("A")
    with pytest.raises(TopologyError, match="no group of blocks named 'rigth'; did you mean 'right'"):
        structure.restricted(["rigth"])


def test_moved_refuses_another_number_of_vertices():
    with pytest.raises(TopologyError, match=r"moved: vertices have shape \(5, 2\); expected \(6, 2\)"):
        build().moved(np.zeros((5, 2)))


@pytest.mark.parametrize("order", [1, 4])
def test_nodal_curves_keep_their_nodes_when_turned_or_moved(order):
    """Also on a graded edge, whose parameters are not those of the nodes' elements."""
    graded = {("a", "b"): Exponential(2.0)}
    bump = Parametric(lambda t: np.stack([t, 0.1 * np.sin(np.pi * t)], axis=-1))
    options = {"counts": 3, "gradings": graded}
    mesh = generate(build(curves={("a", "b"): bump}, **options), order)
    structure = build(**options)
    edge, _ = structure.topology.edge(0, 1)
    nodes = mesh.points[layout(structure, order).nodes_of_edge(edge)]
    forwards = build(curves={("a", "b"): NodalCurve(nodes, order)}, **options)
    backwards = build(curves={("b", "a"): NodalCurve(nodes[::-1], order)}, **options)
    for nodal in (forwards, backwards):
        np.testing.assert_array_equal(generate(nodal, order).points, mesh.points)
        shifted = nodal.moved(nodal.vertices + np.array([1.0, 2.0]))
        np.testing.assert_allclose(generate(shifted, order).points, mesh.points + np.array([1.0, 2.0]), atol=1e-14)
        stretched = nodal.moved(nodal.vertices * [2.0, 1.0])
        np.testing.assert_allclose(generate(stretched, order).points, mesh.points * [2.0, 1.0], atol=1e-14)


def test_moved_checks_its_curves():
    structure = build()
    straight = Parametric(lambda t: np.stack([t, 0 * t], axis=-1))
    edge, _ = structure.topology.edge(0, 1)
    assert structure.moved(structure.vertices, {edge: straight}).curves[edge] is straight
    with pytest.raises(CurveError, match=r"curve on edge a–b: .* away from vertex 'a'"):
        structure.moved(structure.vertices + np.array([0.0, 1e-3]), {edge: straight})
    stray = NodalCurve(np.array([(0, 0), (0.5, 0.2), (1.1, 0)]), 2)
    with pytest.raises(CurveError, match=r"is 0\.1 away from vertex 'b'"):
        structure.moved(structure.vertices, {edge: stray})
    for key in (99, -1, ("a", "b")):
        with pytest.raises(TopologyError, match=r"moved: curves has the key .* expected edge numbers from 0 to 6"):
            structure.moved(structure.vertices, {key: straight})


def test_chains_of_motions_come_back(rng):
    arc = Arc.from_center((0.5, -1.0), np.array([0.0, 0.0]), np.array([1.0, 0.0]))
    start = build(counts=2, curves={("a", "b"): arc})
    mesh = generate(start, 5)
    structure = start
    for _ in range(20):
        structure = structure.moved(start.vertices + rng.uniform(-0.05, 0.05, start.vertices.shape))
    np.testing.assert_allclose(generate(structure.moved(start.vertices), 5).points, mesh.points, atol=1e-14)
    assert isinstance(structure.curves[structure.topology.edge(0, 1)[0]].curve, Arc)


def test_tolerances_follow_size_and_distance_from_the_origin():
    for size, place in ((1e-6, 0.0), (1e6, 0.0), (0.05, 1e6)):
        corners = place + size * np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
        arc = Arc.from_center((place + 0.5 * size, place + 2 * size), corners[0], corners[1])
        assert BlockStructure.build(corners, [(0, 1, 2, 3)], curves={(0, 1): arc}).curves
        off = Parametric(lambda t, c=corners, s=size: (c[0] + t[:, None] * (c[1] - c[0])) + 1e-4 * s)
        with pytest.raises(CurveError, match="away from vertex '0'"):
            BlockStructure.build(corners, [(0, 1, 2, 3)], curves={(0, 1): off})


def test_one_group_may_be_given_by_name_alone():
    assert build().restricted("left").topology.vertex_names == ("a", "b", "d", "e")
    assert build().shared_edges("left", "right").tolist() == [build().topology.edge(1, 4)[0]]


@pytest.mark.parametrize("edges", [[], [77], [-1], [0.7], [2, 2], [[0, 1]]])
def test_groups_of_edges_name_edges(edges):
    with pytest.raises(TopologyError, match=r"edges.wall: .* expected numbers of edges from 0 to 6, at least one"):
        build().with_edge_group("wall", edges)


def test_curves_and_gradings_are_functions():
    with pytest.raises(CurveError, match=r"curves: edge a–b has 3.0; expected a function of t in \[0, 1\]"):
        build(curves={("a", "b"): 3.0})
    with pytest.raises(GradingError, match=r"gradings: edge a–b has 1\.5; expected a function"):
        build(gradings={("a", "b"): 1.5})


def test_with_counts_holds_for_chains():
    structure = build(counts={("a", "d"): 4}, default_count=2)
    changed = structure.with_counts({("c", "f"): 5, ("e", "f"): 3})
    counts = {changed.topology.edge_name(k): int(n) for k, n in enumerate(changed.topology.counts)}
    assert counts == {"a–b": 2, "d–e": 2, "b–c": 3, "e–f": 3, "a–d": 5, "b–e": 5, "c–f": 5}
    assert structure.topology.counts.tolist().count(4) == 3
    match = (
        r"edges a–d and c–f ask for 3 and 5 elements but belong to one chain of opposite edges \(.*b–e.*\), "
        "which needs one number"
    )
    with pytest.raises(TopologyError, match=match):
        structure.with_counts({("a", "d"): 3, ("f", "c"): 5})
    with pytest.raises(TopologyError, match="edge a–b: 0 elements; expected at least 1"):
        structure.with_counts({("a", "b"): 0})
    with pytest.raises(TopologyError, match="counts: no vertex named 'x'"):
        structure.with_counts({("a", "x"): 2})


def test_with_gradings_follows_the_direction_of_the_pair():
    structure = build(gradings={("a", "b"): Exponential(1.0)})
    changed = structure.with_gradings({("e", "d"): Exponential(2.0), ("c", "f"): BoundaryLayer(0.1)})
    topology = changed.topology
    assert changed.gradings[topology.edge(3, 4)[0]] == reverse(Exponential(2.0))
    assert changed.gradings[topology.edge(0, 1)[0]] == Exponential(1.0)
    assert changed.gradings[topology.edge(2, 5)[0]] == BoundaryLayer(0.1)
    with pytest.raises(GradingError, match="expected a function"):
        structure.with_gradings({("a", "b"): None})
    with pytest.raises(GradingError, match="expected a function"):
        structure.with_gradings({("a", "b"): Exponential})
    with pytest.raises(TopologyError, match="gradings: edge a–b is given twice"):
        structure.with_gradings({("a", "b"): Uniform(), ("b", "a"): Uniform()})


def test_with_curves_bends_and_straightens(layouts):
    bump = layouts.bump((1, 0), (0, 0), 0.1)
    structure = build(curves={("b", "c"): layouts.bump((1, 0), (2, 0), 0.1)})
    changed = structure.with_curves({("b", "a"): bump, ("b", "c"): None})
    assert [changed.topology.edge_name(edge) for edge in changed.curves] == ["a–b"]
    np.testing.assert_allclose(changed.curves[0](np.array([0.25])), bump(np.array([0.75])), atol=1e-15)
    with pytest.raises(CurveError, match="curve on edge a–d"):
        structure.with_curves({("a", "d"): bump})
    with pytest.raises(CurveError, match="expected a function"):
        structure.with_curves({("a", "d"): 3})
    with pytest.raises(TopologyError, match="curves: edge a–b is given twice"):
        structure.with_curves({("a", "b"): None, ("b", "a"): bump})
    reentrant = {**VERTICES, "e": (1.7, 0.1)}
    curve = Arc.through(np.array((1.7, 0.1)), np.array((1.9, 0.4)), np.array((2.0, 1.0)))
    blocks = {"right": [tuple("bcfe")], "left": [tuple("abed")]}
    bent = BlockStructure.build(reentrant, blocks, curves={("e", "f"): curve})
    with pytest.raises(TopologyError, match="the angle at vertex"):
        bent.with_curves({("e", "f"): None})


def test_groups_are_added_replaced_and_removed():
    structure = build(edges={"wall": [("a", "b")]})
    named = structure.with_block_group("all", [0, 1]).with_edge_group("wall", [("c", "b"), ("e", "f")])
    assert {name: blocks.tolist() for name, blocks in named.topology.block_groups.items()} == {
        "left": [0],
        "right": [1],
        "all": [0, 1],
    }
    assert [named.topology.edge_name(edge) for edge in named.topology.edge_groups["wall"]] == ["b–c", "e–f"]
    assert len(generate(named, 2).cell_groups["all"]) == 2
    bare = named.without_groups("left", "right", "wall")
    assert (list(bare.topology.block_groups), list(bare.topology.edge_groups)) == (["all"], [])
    with pytest.raises(TopologyError, match="no group of blocks or edges named 'wal'; did you mean 'wall'"):
        named.without_groups("wal")
    with pytest.raises(TopologyError, match=r"blocks.all: \[2\]; expected numbers of blocks from 0 to 1"):
        structure.with_block_group("all", [2])
    with pytest.raises(TopologyError, match=r"edges\.wall: edge b–c is listed twice"):
        structure.with_edge_group("wall", [("c", "b"), ("b", "c")])


def test_edges_tell_their_points_and_gradings(layouts):
    arc = Arc.from_center((0.5, -1.0), np.array([0.0, 0.0]), np.array([1.0, 0.0]))
    structure = build(counts=4, curves={("a", "b"): arc}, gradings={("a", "b"): BoundaryLayer(0.1)})
    t = np.linspace(0, 1, 5)
    np.testing.assert_allclose(structure.edge_points(0, t), arc(t), atol=1e-15)
    straight = structure.topology.edge(1, 2)[0]
    np.testing.assert_allclose(structure.edge_points(straight, t), np.stack([1 + t, 0 * t], -1), atol=1e-15)
    corners = structure.resolved_grading(0)(np.array([0.25]))
    length = 2.0 * np.arcsin(0.5 / arc.radius) * arc.radius
    assert corners[0] == pytest.approx(0.1 / length, rel=1e-9)
    too_high = structure.with_gradings({("a", "b"): BoundaryLayer(7.0)})
    with pytest.raises(GradingError, match="edge a–b: boundary layer: the first height 7 does not fit") as caught:
        too_high.resolved_grading(0)
    assert "".join(traceback.format_exception(caught.value)).count("the first height 7") == 1


def test_a_block_whose_chords_have_no_area_may_be_curved():
    vertices = {"a": (2, 0), "b": (0, 2), "c": (1.05, 1.5), "d": (1.5, 1.05)}
    outer = Arc.from_center((0, 0), np.array((2.0, 0)), np.array((0, 2.0)))
    inner = Arc.from_center((0, 0), np.array((1.5, 1.05)), np.array((1.05, 1.5)))
    with pytest.raises(TopologyError, match="is clockwise or inverted"):
        BlockStructure.build(vertices, [tuple("abcd")])
    structure = BlockStructure.build(vertices, [tuple("abcd")], curves={("a", "b"): outer, ("d", "c"): inner})
    assert len(structure.curves) == 2
    with pytest.raises(TopologyError, match="is clockwise or inverted"):
        BlockStructure.build(vertices, [tuple("abcd")], curves={("d", "c"): inner})


def test_edges_by_number_and_by_names_are_not_mixed(layouts):
    with pytest.raises(TopologyError, match=r"edges.wall: 0; expected a pair of vertices"):
        layouts.square().with_edge_group("wall", [("a", "b"), 0])
