import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import TopologyError
from hoblock.generate import generate
from hoblock.operations.chain import chains
from hoblock.operations.extraction import blocks_where, extracted


def strip():
    x = np.arange(5.0)
    vertices = np.concatenate([np.stack([x, 0 * x], -1), np.stack([x, 0 * x + 1], -1)])
    quads = {name: [(k, k + 1, k + 6, k + 5)] for k, name in enumerate("abcd")}
    names = {"inlet": [(0, 5)], "outlet": [(4, 9)], "top": [(5, 6), (6, 7), (7, 8), (8, 9)]}
    return BlockStructure.build(vertices, quads, counts={("0", "5"): 3}, default_count=2, edges=names)


def test_parts_by_number_and_by_name():
    structure = strip()
    for blocks in ([0, 1], ["a", "b"], ["b", 0], [1, 0, 1], np.array([0, 1])):
        part = extracted(structure, blocks)
        assert part.topology.vertex_names == ("0", "1", "2", "5", "6", "7")
        assert set(part.topology.block_groups) == {"a", "b"}
        assert {name: len(edges) for name, edges in part.topology.edge_groups.items()} == {"inlet": 1, "top": 2}
        assert part.topology.counts.tolist().count(3) == 3
    assert list(extracted(structure, "c").topology.block_groups) == ["c"]


def test_a_chain_that_falls_apart_becomes_two():
    structure = strip()
    part = extracted(structure, [0, 3])
    assert sorted(str(chain) for chain in chains(part) if chain.count == 3) == [
        "3 elements on 0–5, 1–6",
        "3 elements on 3–8, 4–9",
    ]
    finer = part.with_counts({("3", "8"): 7})
    assert finer.topology.counts[finer.topology.edge(0, 4)[0]] == 3
    assert len(generate(finer, 2).cells) == 2 * 3 + 2 * 7


@pytest.mark.parametrize("kind", ["grid", "disc", "annulus"])
def test_the_mesh_of_a_part_is_that_part_of_the_mesh(kind, layouts, rng):
    structure = layouts.random(kind, rng)
    chosen = blocks_where(structure, lambda x, y: x + 0.3 * y > np.median(x + 0.3 * y) - 1e-9)
    assert 0 < len(chosen) < len(structure.topology.quads)
    whole, part = generate(structure, 4, check=False), generate(extracted(structure, chosen), 4, check=False)
    known = {tuple(point) for point in whole.coordinates.mean(axis=1).round(12)}
    found = {tuple(point) for point in part.coordinates.mean(axis=1).round(12)}
    assert found <= known
    assert len(found) == len(part.cells)


def test_places():
    structure = strip()
    assert blocks_where(structure, lambda x, y: (x > 1) & (y < 1)).tolist() == [1, 2, 3]
    assert blocks_where(structure, lambda x, y: x > 99).tolist() == []
    with pytest.raises(ValueError, match=r"the predicate returned shape \(\) for \(4,\); use & and |"):
        blocks_where(structure, lambda x, y: True)


@pytest.mark.parametrize(
    ("blocks", "match"),
    [
        ([], "extracted: no blocks; expected numbers from 0 to 3 or names"),
        (["e"], "no group of blocks named 'e'"),
        ([4], "no block 4; expected a number from 0 to 3, or the name of a group"),
        ([-1], "no block -1"),
        ([True], "no block True"),
    ],
)
def test_bad_blocks(blocks, match):
    with pytest.raises(TopologyError, match=match):
        extracted(strip(), blocks)
