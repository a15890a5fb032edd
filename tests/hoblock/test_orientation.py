import numpy as np
import pytest

from hoblock.errors import TopologyError
from hoblock.orientation import orient


def parallel(quads, edges, block_edges, rotation):
    """Whether bottom and top, and left and right, of every rotated block run from the first side to the other."""
    quads = np.take_along_axis(quads, (np.arange(4) + rotation[:, None]) % 4, axis=1)
    a, b, c, d = quads.T
    expected = np.stack([np.stack(pair, axis=-1) for pair in ((a, b), (b, c), (d, c), (a, d))], axis=1)
    return np.array_equal(edges[block_edges], expected)


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
@pytest.mark.parametrize("seed", range(5, 13))
def test_opposite_edges_are_parallel_and_in_one_chain(kind, seed, layouts):
    rng = np.random.default_rng(seed)
    quads = np.array(layouts.quads(kind)[1])
    number = rng.permutation(quads.max() + 1)
    quads = np.array([np.roll(number[quad], rng.integers(4)) for quad in rng.permutation(quads)])
    edges, block_edges, chains, rotation = orient(quads, [str(k) for k in number])
    assert parallel(quads, edges, block_edges, rotation)
    assert np.array_equal(chains[block_edges[:, 0]], chains[block_edges[:, 2]])
    assert np.array_equal(chains[block_edges[:, 1]], chains[block_edges[:, 3]])
    assert len(np.unique(np.sort(edges, axis=1), axis=0)) == len(edges)


def test_number_of_chains(layouts):
    expected = {"grid": 5, "disc": 3, "star": 5, "annulus": 6}
    for kind, count in expected.items():
        chains = orient(np.array(layouts.quads(kind)[1]), [str(k) for k in range(12)])[2]
        assert len(np.unique(chains)) == count
        assert chains.max() == count - 1


def test_a_single_block_keeps_its_first_vertex():
    edges, block_edges, _, rotation = orient(np.array([[7, 3, 9, 1]]), [str(k) for k in range(10)])
    assert list(rotation) == [0]
    assert edges[block_edges[0]].tolist() == [[7, 3], [3, 9], [1, 9], [7, 1]]


def test_a_strip_that_is_joined_with_a_twist_is_refused():
    quads = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [2, 3, 0, 5]])
    with pytest.raises(TopologyError, match="edge a–d has two blocks on the same side: blocks 0, 2"):
        orient(quads, list("abcdef"))


def test_overlapping_blocks():
    names = list("abcdefgh")
    three = np.array([[0, 1, 2, 3], [1, 0, 4, 5], [0, 1, 6, 7]])
    with pytest.raises(TopologyError, match=r"edge a–b belongs to more than two blocks: blocks 0, 1, 2 \(a,b,c,d; b"):
        orient(three, names)
    same_side = np.array([[0, 1, 2, 3], [0, 1, 4, 5]])
    with pytest.raises(TopologyError, match=r"edge a–b has two blocks on the same side: blocks 0, 1 .* must not"):
        orient(same_side, names)
