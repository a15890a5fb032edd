import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, NodalCurve, Polyline
from hoblock.errors import TopologyError
from hoblock.generate import generate
from hoblock.grading import BoundaryLayer, Cubic, Exponential, Listed, Pieces, Quadratic, Uniform, reverse
from hoblock.layout import layout
from hoblock.operations.chain import chains
from hoblock.operations.splitting import split
from hoblock.quality import quality_summary

# A strip that leaves block (a, b, c, d) at its right side and comes back to its top: one chain crosses the block twice.
PIGTAIL = {
    **{"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1), "e": (4, 0)},
    **{"f": (3, 1), "g": (4, 4), "h": (3, 3), "i": (0, 4), "j": (1, 3)},
}
PIGTAIL_BLOCKS = [tuple(quad) for quad in ("abcd", "befc", "eghf", "gijh", "idcj")]


def graded_alike(structure, rng):
    """The structure with equal gradings on opposite edges, a random one for each chain."""
    kinds = (Uniform(), Quadratic(0.4), Cubic(0.5), Exponential(1.1))
    gradings = {pair: kinds[k] for chain in chains(structure) for k in (rng.integers(4),) for pair in chain.edges}
    return structure.with_gradings(gradings)


def assert_same_mesh(found, expected, tolerance=1e-13):
    """The same elements with the same nodes, numbered and turned as they may be."""
    assert found.points.shape == expected.points.shape
    centers = [mesh.coordinates.mean(axis=1) for mesh in (found, expected)]
    distance = np.hypot(*np.moveaxis(centers[0][:, None] - centers[1], -1, 0))
    partner = distance.argmin(axis=1)
    assert len(set(partner)) == len(partner)
    for nodes, other in zip(found.coordinates, expected.coordinates[partner], strict=True):
        gaps = np.hypot(*np.moveaxis(nodes[:, None] - other, -1, 0))
        assert max(gaps.min(axis=0).max(), gaps.min(axis=1).max()) < tolerance


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
def test_a_cut_after_some_elements_keeps_the_mesh(kind, layouts, rng):
    structure = graded_alike(layouts.random(kind, rng, graded=False), rng)
    for order in (1, 2, 5, 8):
        expected = generate(structure, order, check=False)
        for chain in chains(structure):
            first, second = chain.edges[rng.integers(len(chain.edges))]
            for after in range(1, chain.count):
                pair = (first, second) if rng.random() < 0.5 else (second, first)
                found = split(structure, pair, after=after)
                assert_same_mesh(generate(found, order, check=False), expected)
                assert len(found.topology.quads) > len(structure.topology.quads)


@pytest.mark.parametrize("grading", [Uniform(), Exponential(1.0)])
@pytest.mark.parametrize("curved", [False, True])
def test_a_chain_that_crosses_a_block_twice(grading, curved, layouts):
    structure = BlockStructure.build(PIGTAIL, PIGTAIL_BLOCKS, counts={("a", "b"): 4}, default_count=2)
    chain = next(chain for chain in chains(structure) if ("a", "b") in chain.edges)
    assert len(chain.edges) == 7
    structure = structure.with_gradings(dict.fromkeys(chain.edges, grading))
    if curved:
        bumps = {pair: layouts.bump(PIGTAIL[pair[0]], PIGTAIL[pair[1]], 0.08) for pair in (("a", "b"), ("c", "d"))}
        structure = structure.with_curves(bumps)
    found = split(structure, ("a", "b"), after=1)
    assert len(found.topology.quads) == 5 + 4 + 3
    assert_same_mesh(generate(found, 4), generate(structure, 4))
    generate(split(structure, ("b", "a"), at=0.3), 3)


def test_nodal_curves_are_cut_by_elements(layouts):
    bump = layouts.bump((0, 0), (1, 0), -0.1)
    graded = dict.fromkeys([("a", "b"), ("d", "c")], Quadratic(0.3))
    smooth = layouts.square(counts=4, curves={("a", "b"): bump}, gradings=graded)
    mesh = generate(smooth, 3)
    nodes = mesh.points[layout(smooth, 3).nodes_of_edge(smooth.topology.edge(0, 1)[0])]
    nodal = smooth.with_curves({("a", "b"): NodalCurve(nodes, 3)})
    for pair, kinds in ((("a", "b"), 2), (("a", "d"), 2)):
        found = split(nodal, pair, after=1)
        assert [type(curve) for curve in found.curves.values()] == [NodalCurve] * kinds
        assert_same_mesh(generate(found, 3), mesh)
        generate(split(nodal, pair, at=0.4), 3)


def test_arcs_remain_arcs_and_rings_can_be_cut(layouts):
    ring = layouts.annulus(4, counts=3)
    sectors = split(ring, ("0", "1"), after=1)
    assert {type(curve) for curve in sectors.curves.values()} == {Arc}
    rings = split(ring, ("0", "4"), after=2)
    assert len(rings.topology.quads) == 8
    assert sorted(chain.count for chain in chains(rings) if chain.closed) == [1, 2]
    middle = rings.vertices[8:]
    np.testing.assert_allclose(np.hypot(*middle.T), 1.0 + 2.0 / 3.0, atol=1e-15)


def test_names_are_inherited(layouts):
    vertices = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (0, 1), "e": (1, 1), "f": (2, 1)}
    blocks = {"left": [tuple("abed")], "right": [tuple("bcfe")]}
    names = {"bottom": [("a", "b"), ("b", "c")], "seam": [("b", "e")], "wall": [("e", "d")]}
    structure = BlockStructure.build(vertices, blocks, counts=4, edges=names)
    found = split(structure, ("a", "d"), at=0.5).topology
    assert {name: len(edges) for name, edges in found.edge_groups.items()} == {"bottom": 2, "seam": 2, "wall": 1}
    assert {name: blocks.tolist() for name, blocks in found.block_groups.items()} == {"left": [0, 1], "right": [2, 3]}
    assert found.vertex_names[6:] == ("a-d:1", "b-e:1", "c-f:1")
    found = split(structure, ("a", "b"), after=1)
    found = split(found, ("a-b:1", "b"), after=1)
    found = split(found, ("a-b:1", "a-b:2"), at=0.5, counts=(2, 3))
    assert found.topology.vertex_names[6:] == ("a-b:1", "d-e:1", "a-b:2", "d-e:2", "a-b:3", "d-e:3")
    assert len(found.topology.edge_groups["bottom"]) == 5
    assert len(found.topology.edge_groups["wall"]) == 4
    across = split(found, ("a", "d"), at=0.5)
    across = split(across, ("a", "a-d:1"), at=0.5).topology.vertex_names[12:]
    assert {"a-d:1", "a-d:2", "a-b-d-e:1", "a-b-d-e:2", "a-b-d-e:3"} <= set(across)
    topology = found.topology
    counts = {topology.edge_name(edge): int(n) for edge, n in enumerate(topology.counts)}
    assert (counts["a-b:1–a-b:3"], counts["a-b:3–a-b:2"]) == (2, 3)


def test_a_cut_at_a_parameter_shares_out_the_elements():
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    structure = BlockStructure.build(corners, [(0, 1, 2, 3)], counts=10)
    for at, expected in ((0.31, [3, 7]), (0.01, [1, 9]), (0.99, [9, 1])):
        found = split(structure, (0, 1), at=at)
        assert [chain.count for chain in chains(found) if len(chain.edges) == 2] == expected
        assert found.vertices[4, 0] == pytest.approx(at)
        backwards = split(structure, (1, 0), at=1.0 - at)
        np.testing.assert_allclose(backwards.vertices, found.vertices, atol=1e-15)
    one = split(structure.with_counts({(0, 1): 1}), (0, 1), at=0.5)
    assert [chain.count for chain in chains(one) if len(chain.edges) == 2] == [1, 1]
    told = split(structure, (1, 0), at=0.25, counts=(2, 5))
    assert [chain.count for chain in chains(told) if len(chain.edges) == 2] == [5, 2]


def test_sizes_remain_in_proportion_on_both_sides_of_a_cut(layouts):
    """The grading is cut where it reaches the place, so that equal counts give the old corners."""
    graded = dict.fromkeys([("a", "b"), ("d", "c")], Exponential(2.0))
    structure = layouts.square(counts=8, gradings=graded)
    place = float(Exponential(2.0)(np.array(3 / 8)))
    assert_same_mesh(generate(split(structure, ("a", "b"), at=place), 2), generate(structure, 2))
    listed = structure.with_gradings({pair: Listed(tuple(Exponential(2.0)(np.linspace(0, 1, 9)))) for pair in graded})
    assert_same_mesh(generate(split(listed, ("a", "b"), at=place), 2), generate(structure, 2), 1e-12)
    finer = split(listed, ("a", "b"), at=place, counts=(6, 10))
    sizes = np.diff(np.unique(generate(finer, 1).points[:, 0].round(12)))
    assert len(sizes) == 16
    assert (sizes[1:] / sizes[:-1]).max() < 1.35


def test_a_boundary_layer_survives_a_cut(layouts):
    layer = BoundaryLayer(1e-3)
    structure = layouts.square(counts=6, gradings={("a", "d"): layer, ("b", "c"): layer})
    across = split(structure, ("a", "b"), after=2)
    assert across.gradings.count(layer) == 3  # prescribed on the new edge too
    assert_same_mesh(generate(across, 3), generate(structure, 3))
    along = split(structure, ("a", "d"), after=2)
    assert not any(isinstance(grading, BoundaryLayer) for grading in along.gradings)
    assert_same_mesh(generate(along, 3), generate(structure, 3))


def test_parts_of_smooth_gradings_take_other_counts(layouts):
    different = {("a", "d"): Exponential(1.0), ("b", "c"): Cubic(0.5)}
    found = split(layouts.square(counts=4, gradings=different), ("a", "b"), at=0.5)
    assert len(generate(found.with_counts({("a", "d"): 9}), 2).cells) == 4 * 9


@pytest.mark.parametrize("grading", [Pieces(), reverse(Pieces())])
@pytest.mark.parametrize(("at", "counts"), [(0.4, None), (0.73, (5, 3)), (0.2, (2, 4))])
def test_kinks_stay_between_elements_when_cut_at_a_place(grading, at, counts):
    roof = np.array([(0.0, 1.0), (0.3, 1.1), (1.2, 0.9), (2.0, 1.0)])
    strip = BlockStructure.build(
        {"a": (0, 0), "b": (2, 0), "c": (2, 1), "d": (0, 1)},
        [("a", "b", "c", "d")],
        counts={("a", "b"): 8, ("a", "d"): 2},
        curves={("d", "c"): Polyline(roof)},
        gradings={("d", "c"): grading},
    )
    area = np.trapezoid(roof[:, 1], roof[:, 0])
    found = generate(split(strip, ("d", "c"), at=at, counts=counts), 3)
    assert quality_summary(found).area == pytest.approx(area, rel=1e-13)


def test_parts_with_fewer_elements_than_pieces_take_corners(layouts):
    zigzag = Polyline([(0.0, 1.0), (0.2, 1.1), (0.4, 1.0), (0.6, 1.1), (1.0, 1.0)])
    square = layouts.square(counts=4).with_curves({("d", "c"): zigzag}).with_gradings({("d", "c"): Pieces()})
    assert len(generate(split(square, ("d", "c"), at=0.8, counts=(1, 3)), 2).cells) == 16


def test_an_edge_of_one_element_cannot_be_cut_between_elements(layouts):
    with pytest.raises(TopologyError, match="after=1, the edge has 1 element; expected at least 2 to cut between"):
        split(layouts.square(counts=1), ("a", "b"), after=1)


@pytest.mark.parametrize(
    ("edge", "options", "match"),
    [
        (("a", "b"), {}, r"split a–b: give either after=… \(elements\) or at=… \(parameter\), one of them"),
        (("a", "b"), {"after": 1, "at": 0.5}, "give either after"),
        (("a", "b"), {"after": 3}, "after=3, the edge has 3 elements; expected a whole number from 1 to 2. Give the"),
        (("a", "b"), {"after": 0}, "after=0"),
        (("a", "b"), {"after": 1.5}, "after=1.5"),
        (("a", "b"), {"after": 1, "counts": (1, 2)}, "counts go with at=…; after=1 keeps the elements"),
        (("a", "b"), {"at": 1.0}, "at=1.0; expected a parameter between 0 and 1"),
        (("a", "b"), {"at": "half"}, "at='half'"),
        (("a", "b"), {"at": 0.5, "counts": 4}, "counts=4; expected the elements of the two parts"),
        (("a", "b"), {"at": 0.5, "counts": (0, 2)}, "split a–b: 0 elements; expected at least 1"),
        (("a", "c"), {"after": 1}, "no block edge joins 'a' and 'c'"),
        (("a", "x"), {"after": 1}, "split: no vertex named 'x'"),
        ("ab", {"after": 1}, "split: 'ab'; expected a pair of vertices"),
    ],
)
def test_impossible_cuts(edge, options, match, layouts):
    with pytest.raises(TopologyError, match=match):
        split(layouts.square(counts=3), edge, **options)
