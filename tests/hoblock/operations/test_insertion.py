import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import TopologyError
from hoblock.generate import generate
from hoblock.grading import Exponential, Quadratic
from hoblock.operations.chain import chains
from hoblock.operations.insertion import split_block


def area(mesh):
    """By Gauss' theorem over the four sides of every element, exactly for their order."""
    from hoblock.quality import det_jacobian
    from hoblock.reference import gauss_legendre

    x, w = gauss_legendre(mesh.order + 2)
    xi, eta = np.meshgrid(x, x)
    values = det_jacobian(mesh, np.stack([xi.ravel(), eta.ravel()], axis=-1))
    return float((values * np.outer(w, w).ravel()).sum())


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
def test_neighbours_and_area_remain(kind, layouts, rng):
    structure = layouts.random(kind, rng)
    block = int(rng.integers(len(structure.topology.quads)))
    found = split_block(structure, block, inset=0.6, count=2)
    before, after = generate(structure, 5), generate(found, 5)
    assert len(found.topology.quads) == len(structure.topology.quads) + 4
    assert area(after) == pytest.approx(area(before), rel=1e-12)
    counts = {frozenset(e): n for chain in chains(structure) for e, n in ((e, chain.count) for e in chain.edges)}
    inherited = {frozenset(e): chain.count for chain in chains(found) for e in chain.edges if frozenset(e) in counts}
    assert inherited == counts
    assert sum(chain.count == 2 and chain.closed and len(chain.edges) == 4 for chain in chains(found)) >= 1


def test_names_grading_and_inset():
    vertices = {"a": (0, 0), "b": (2, 0), "c": (2, 2), "d": (0, 2)}
    structure = BlockStructure.build(vertices, {"body": ["abcd"]}, counts=4)
    found = split_block(structure, "body", inset=0.5, count=3, grading=Exponential(1.0))
    assert found.topology.vertex_names[4:] == ("a:1", "b:1", "c:1", "d:1")
    np.testing.assert_allclose(found.vertices[4:], [(0.5, 0.5), (1.5, 0.5), (1.5, 1.5), (0.5, 1.5)], atol=1e-15)
    assert found.topology.block_groups["body"].tolist() == [0, 1, 2, 3, 4]
    edge, forward = found.topology.edge(0, 4)
    middle = float(found.gradings[edge](np.array([0.5]))[0])
    assert middle == pytest.approx(float(Exponential(1.0 if forward else -1.0)(np.array(0.5))))
    again = split_block(found, 0, inset=0.3)
    assert again.topology.vertex_names[8:] == ("a:1:1", "b:1:1", "c:1:1", "d:1:1")
    generate(again, 4)


def test_inner_edges_follow_curves_and_gradings(layouts):
    ring = layouts.annulus(4, counts=4)
    found = split_block(ring, 0, inset=0.5, count=2)
    inner = found.curves[found.topology.edge(found.topology.vertex("0:1"), found.topology.vertex("1:1"))[0]]
    np.testing.assert_allclose(np.hypot(*inner(np.linspace(0, 1, 7)).T), 1.25, atol=1e-14)
    generate(found, 6)
    graded = layouts.square(counts=4, gradings=dict.fromkeys([("a", "b"), ("d", "c")], Quadratic(0.5)))
    assert (
        split_block(graded, 0).gradings.count(Quadratic(0.5)) + split_block(graded, 0).gradings.count(Quadratic(-0.5))
        == 4
    )


@pytest.mark.parametrize(
    ("block", "options", "match"),
    [
        (0, {"inset": 1.0}, r"split_block, blocks.body\[0\] \(a, b, c, d\): inset=1.0; expected a number between 0"),
        (0, {"inset": True}, "inset=True"),
        (0, {"count": 0}, "0 elements; expected at least 1"),
        (1, {}, "no block 1; expected a number from 0 to 0"),
        ("x", {}, "no group of blocks named 'x'"),
    ],
)
def test_impossible_insertions(block, options, match, layouts):
    with pytest.raises(TopologyError, match=match):
        split_block(layouts.square(), block, **options)


def test_a_group_of_several_blocks_is_not_one(layouts):
    with pytest.raises(TopologyError, match="the group 'blocks' has 4 blocks, 0, 1, 2, 3; give one by number"):
        split_block(layouts.annulus(4), "blocks")
