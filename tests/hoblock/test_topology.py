import numpy as np
import pytest

from hoblock.errors import TopologyError
from hoblock.topology import connected


def classes(count, pairs):
    """By walking, slowly."""
    label = np.full(count, -1)
    for start in range(count):
        stack = [start] if label[start] < 0 else []
        number = label.max() + 1
        while stack:
            k = stack.pop()
            if label[k] < 0:
                label[k] = number
                stack += [b for a, b in pairs if a == k] + [a for a, b in pairs if b == k]
    return label


@pytest.mark.parametrize("edges", [0, 5, 20, 60])
def test_connected_classes(edges, rng):
    for _ in range(20):
        pairs = rng.integers(40, size=(edges, 2))
        np.testing.assert_array_equal(connected(40, pairs), classes(40, pairs.tolist()))


def test_a_long_chain_is_one_class(rng):
    line = rng.permutation(20000)
    assert not connected(20000, np.stack([line[:-1], line[1:]], axis=-1)).any()


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
def test_facing_edges_make_the_chains(kind, layouts, rng):
    topology = layouts.random(kind, rng).topology
    found = connected(len(topology.edges), topology.opposite_edges)
    _, expected = np.unique(topology.chains, return_inverse=True)
    same = found[:, None] == found
    np.testing.assert_array_equal(same, expected[:, None] == expected)


def test_blocks_by_number_and_name(layouts):
    topology = layouts.square().topology
    assert topology.block("body") == topology.block(0) == 0
    assert topology.vertex("a") == 0
    with pytest.raises(TopologyError, match="somewhere: no vertex named 'x'; known names: a, b, c, d"):
        topology.vertex("x", "somewhere")
    for key in (1, -1, False, 0.0):
        with pytest.raises(TopologyError, match=r"no block .*; expected a number from 0 to 0, or the name of a group"):
            topology.block(key)
    with pytest.raises(TopologyError, match="no group of blocks was asked for; expected some of: body"):
        topology.blocks_in([])
