from __future__ import annotations

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.movers import inverted_blocks

STRIP = BlockStructure.build(np.array([[0.0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]), [[0, 1, 4, 3], [1, 2, 5, 4]])


@pytest.mark.parametrize(
    ("place", "blocks"),
    [
        ((1.2, 0.9), []),
        ((0.3, 0.3), [0]),
        ((1.8, 0.1), [1]),
        ((1.0, -0.1), [0, 1]),
        ((0.5, 0.5), [0]),
        ((np.nan, 1.0), [0, 1]),
    ],
)
def test_a_vertex_that_folds_its_blocks_is_found(place, blocks):
    vertices = STRIP.vertices.copy()
    vertices[4] = place
    assert inverted_blocks(STRIP.topology, vertices).tolist() == blocks


def test_corners_at_curved_edges_are_not_judged():
    vertices = STRIP.vertices.copy()
    vertices[4] = 0.45, 0.45
    assert inverted_blocks(STRIP.topology, vertices).tolist() == [0]
    edge, _ = STRIP.topology.edge(3, 4)
    assert inverted_blocks(STRIP.topology, vertices, curved=[edge]).tolist() == []
