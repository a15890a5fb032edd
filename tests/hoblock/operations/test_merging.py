import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, NodalCurve
from hoblock.errors import TopologyError
from hoblock.generate import generate
from hoblock.grading import BoundaryLayer, Exponential
from hoblock.layout import layout
from hoblock.operations.chain import chains
from hoblock.operations.extraction import extracted
from hoblock.operations.merging import merge
from hoblock.operations.transforms import mirrored, rotated, scaled, translated


def square(name="body", counts=3, **options):
    vertices = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}
    edges = {"left": [("a", "d")], "right": [("b", "c")], "bottom": [("a", "b")]}
    return BlockStructure.build(vertices, {name: ["abcd"]}, counts=counts, edges=edges, **options)


def nearest(points, others):
    return max(np.hypot(*(others - point).T).min() for point in points)


def test_names_are_united_and_clashes_resolved():
    whole = merge(square("one"), translated(square("two"), (1, 0)), translated(square("one"), (2, 0)))
    topology = whole.topology
    assert topology.vertex_names == ("a", "b", "c", "d", "b:2", "c:2", "b:3", "c:3")
    assert {name: blocks.tolist() for name, blocks in topology.block_groups.items()} == {"one": [0, 2], "two": [1]}
    assert {name: len(edges) for name, edges in topology.edge_groups.items()} == {"left": 3, "right": 3, "bottom": 3}
    assert len(chains(whole)) == 4
    outer = merge(square("one"), translated(square("two"), (1, 0)), keep_shared_names=False)
    assert {name: len(edges) for name, edges in outer.topology.edge_groups.items()} == {
        "left": 1,
        "right": 1,
        "bottom": 2,
    }


@pytest.mark.parametrize("order", [1, 4])
def test_half_a_channel_mirrored_and_merged_is_symmetric(order, layouts):
    vertices = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1), "e": (2, 0), "f": (2, 0.7)}
    arc = Arc.through(np.array((0, 1.0)), np.array((0.5, 1.15)), np.array((1.0, 1.0)))
    half = BlockStructure.build(
        vertices,
        ["abcd", "befc"],
        counts={("a", "b"): 4, ("a", "d"): 3, ("b", "e"): 2},
        curves={("d", "c"): arc},
        gradings={("a", "d"): Exponential(1.0), ("f", "e"): Exponential(0.5)},
        edges={"axis": [("a", "b"), ("b", "e")], "wall": [("d", "c"), ("c", "f")]},
    )
    whole = merge(half, mirrored(half, (0, 0), (1, 0)))
    mesh = generate(whole, order)
    assert nearest(mesh.points * [1, -1], mesh.points) < 1e-14
    assert nearest(generate(half, order).points, mesh.points) < 1e-14
    assert len(whole.topology.vertex_names) == 6 + 3
    assert whole.topology.blocks_per_edge[whole.topology.edge_groups["axis"]].tolist() == [2, 2]
    assert len(whole.topology.edge_groups["wall"]) == 4


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
def test_parts_merge_to_the_whole(kind, layouts, rng):
    structure = layouts.random(kind, rng)
    order = rng.permutation(len(structure.topology.quads))
    whole, rest = extracted(structure, [order[0]]), list(order[1:])
    while rest:  # a part at a time, each touching what is there
        known = set(whole.topology.vertex_names)
        corners = [{structure.topology.vertex_names[v] for v in quad} for quad in structure.topology.quads]
        block = next(block for block in rest if known & corners[block])
        rest.remove(block)
        whole = merge(whole, extracted(structure, [block]))
    assert sorted(whole.topology.vertex_names) == sorted(structure.topology.vertex_names)
    assert len(chains(whole)) == len(chains(structure))
    found, expected = generate(whole, 3, check=False), generate(structure, 3, check=False)
    assert len(found.points) == len(expected.points)
    assert nearest(found.points, expected.points) < 1e-13


def test_sectors_close_to_a_ring(layouts):
    ring = layouts.annulus(4, counts=2)
    sector = extracted(ring, [0])
    whole = merge(*(rotated(sector, k * np.pi / 2) for k in range(4)))
    assert any(chain.closed for chain in chains(whole))
    assert nearest(generate(whole, 4).points, generate(ring, 4).points) < 1e-14


def test_a_larger_tolerance_fits_the_later_structure_to_the_earlier(layouts):
    ring = layouts.annulus(4, counts=2)
    sector = extracted(ring, [0])
    off = rotated(sector, np.pi / 2 + 1e-7)
    with pytest.raises(TopologyError, match=r"no vertex coincides with one of those before .* is 1e-07 away from '1'"):
        merge(sector, off)
    whole = merge(sector, off, tolerance=1e-6)
    assert len(whole.topology.vertex_names) == 6
    generate(whole, 4)


def test_shared_curves_and_gradings_may_be_written_in_other_ways(layouts):
    bump = layouts.bump((1, 0), (1, 1), 0.1)
    layer = BoundaryLayer(0.01)
    first = square(curves={("b", "c"): bump}, gradings={("b", "c"): layer})
    other = BlockStructure.build(
        {"p": (1, 0), "q": (2, 0), "r": (2, 1), "s": (1, 1)},
        ["pqrs"],
        counts=3,
        curves={("s", "p"): lambda t: bump(1.0 - t)},
        gradings={("s", "p"): BoundaryLayer(0.01, ends="second")},
    )
    whole = merge(first, other)
    assert len(whole.curves) == 1
    generate(whole, 4)
    mesh = generate(first, 3)
    edge, _ = first.topology.edge(1, 2)
    nodes = NodalCurve(mesh.points[layout(first, 3).nodes_of_edge(edge)], 3)
    generate(merge(first.with_curves({("b", "c"): nodes}), other), 3)


def conflicting():
    bump = Arc.through(np.array((1.0, 0)), np.array((1.1, 0.5)), np.array((1.0, 1.0)))
    fine = translated(scaled(square(), (1.0, 0.5)), (1, 0))
    right = translated(square(), (1, 0))
    return [
        (right.with_counts({("a", "d"): 5}), "structure 2: edge a–d is edge b–c of those before, but has 5 elements "),
        (right.with_counts({("a", "d"): 5}), "Its chain: a–d, b–c; the other's: a–d, b–c. Make them equal"),
        (right.with_curves({("a", "d"): bump}), r"their curves are up to 0\.1 apart \(allowed: 2e-09\)"),
        (
            right.with_gradings({("a", "d"): Exponential(1.0)}),
            r"gradings place element corners .*Exponential\(a=1.0\) and",
        ),
        (fine, "lies on edge b–c: the blocks do not conform"),
        (translated(square(), (3, 0)), "no vertex coincides with one of those before within .* is 2 away from 'b'"),
        (square(), "Blocks must not overlap"),
        (translated(scaled(square(), 1e-10), (1, 0)), r"within 1e-09 of vertex 'a' there are several vertices"),
    ]


@pytest.mark.parametrize(("other", "match"), conflicting())
def test_conflicts_name_both(other, match):
    with pytest.raises(TopologyError, match=match):
        merge(square(), other)


def test_hanging_vertices_on_curves_are_found(layouts):
    inner = layouts.annulus(4, counts=2)
    outer = layouts.annulus(8, counts=2, inner=2.0, outer=3.0)
    with pytest.raises(
        TopologyError, match="vertex '1' of structure 2 lies on edge 4–5 of those before: the blocks do"
    ):
        merge(inner, outer)
    with pytest.raises(
        TopologyError, match="vertex '1' of those before lies on edge 4–5 of structure 2: the blocks do"
    ):
        merge(outer, inner)
    generate(merge(inner, layouts.annulus(4, counts=2, inner=2.0, outer=3.0)), 2)


def test_a_tolerance_is_a_length():
    with pytest.raises(TopologyError, match="merge: tolerance is 0; expected a positive length"):
        merge(square(), translated(square(), (1, 0)), tolerance=0)
