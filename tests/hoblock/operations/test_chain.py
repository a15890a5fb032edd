import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.operations.chain import Chain, chains


def test_edges_come_in_the_order_one_crosses_them(layouts):
    vertices, quads = layouts.quads("grid")
    listed = chains(BlockStructure.build(vertices, quads, counts={("0", "4"): 5}, default_count=2))
    assert [str(chain) for chain in listed] == [
        "2 elements on 0–1, 4–5, 8–9",
        "5 elements on 0–4, 1–5, 2–6, 3–7",
        "2 elements on 1–2, 5–6, 9–10",
        "2 elements on 2–3, 6–7, 10–11",
        "2 elements on 4–8, 5–9, 6–10, 7–11",
    ]


def test_a_ring_is_closed(layouts):
    listed = chains(layouts.annulus(3, counts=1))
    assert Chain((("0", "3"), ("1", "4"), ("2", "5")), 1, closed=True) in listed
    assert [str(chain) for chain in listed if chain.closed] == ["1 element on 0–3, 1–4, 2–5 (closed)"]


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
def test_every_edge_is_in_one_chain_and_neighbours_face_each_other(kind, layouts, rng):
    structure = layouts.random(kind, rng)
    topology = structure.topology
    facing = {frozenset(pair) for pair in topology.opposite_edges.tolist()}
    seen = []
    for chain in chains(structure):
        edges = [topology.edge(*(topology.vertex(name) for name in pair)) for pair in chain.edges]
        assert all(forward for _, forward in edges)
        numbers = [edge for edge, _ in edges]
        steps = zip(numbers, [*numbers[1:], numbers[0]] if chain.closed else numbers[1:], strict=False)
        assert all(frozenset(step) in facing for step in steps)
        assert set(topology.counts[numbers].tolist()) == {chain.count}
        seen += numbers
    assert sorted(seen) == list(range(len(topology.edges)))
    assert len(chains(structure)) == len(np.unique(topology.chains))
