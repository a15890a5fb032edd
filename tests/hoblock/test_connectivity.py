import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.connectivity import connectivity
from hoblock.generate import generate
from hoblock.numbering import corner_nodes, number_nodes


@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
def test_nodes_are_shared_exactly_as_elements_share_corners_and_sides(kind, order, layouts, rng):
    structure = layouts.random(kind, rng)
    numbers = connectivity(structure.topology, order)
    corners = numbers.cells[:, corner_nodes(order)]
    reference, count = number_nodes(corners, order)
    assert count == numbers.node_count
    # One to one: equal numbers exactly where the independent numbering has equal numbers.
    pairs = np.unique(np.stack([numbers.cells.ravel(), reference.ravel()], axis=-1), axis=0)
    assert len(pairs) == count
    assert len(np.unique(pairs[:, 0])) == len(np.unique(pairs[:, 1])) == count
    assert pairs[:, 0].min() == 0
    assert pairs[:, 0].max() == count - 1


def test_vertices_come_first_then_edges_then_interiors_row_by_row(layouts):
    structure = layouts.square(counts={("a", "b"): 2, ("b", "c"): 1})
    numbers = connectivity(structure.topology, 3)
    (patch,) = numbers.patches
    assert (patch.rows, patch.columns) == (2, 5)
    assert patch.start == 4 + 2 * 5 + 2 * 2
    np.testing.assert_array_equal(numbers.vertex_nodes, np.arange(4))
    inner = np.arange(patch.start, patch.stop).reshape(2, 5)
    np.testing.assert_array_equal(numbers.cells[0].reshape(4, 4)[1:3, 1:3], inner[:, :2])
    np.testing.assert_array_equal(numbers.cells[1].reshape(4, 4)[1:3, 1:3], inner[:, 3:])
    np.testing.assert_array_equal(numbers.cells[0].reshape(4, 4)[1:3, 3], inner[:, 2])


def test_edges_lie_between_their_vertices_and_interiors_in_their_blocks(layouts, rng):
    structure = layouts.random("disc", rng)
    numbers = connectivity(structure.topology, 4)
    points = generate(structure, 4).points
    for edge, (first, second) in enumerate(structure.topology.edges):
        nodes = numbers.edge_nodes[numbers.edge_offsets[edge] : numbers.edge_offsets[edge + 1]]
        np.testing.assert_array_equal(points[nodes[[0, -1]]], structure.vertices[[first, second]])
        assert len(nodes) == structure.topology.counts[edge] * 4 + 1
    blocks = np.concatenate([patch.blocks for patch in numbers.patches])
    assert sorted(blocks) == list(range(len(structure.topology.quads)))


@pytest.mark.parametrize("count", [40, 3])
def test_many_equal_blocks_and_few_number_their_elements_alike(count):
    """The two ways of writing cells agree: a strip of blocks, as one patch, against the same strip by elements."""
    x = np.repeat(np.arange(count + 1.0), 2)
    vertices = np.stack([x, np.tile([0.0, 1.0], count + 1)], axis=-1)
    quads = [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(count)]
    structure = BlockStructure.build(vertices, quads, counts=2)
    mesh = generate(structure, 2)
    centres = mesh.points[mesh.cells].mean(axis=1)
    expected = [(k + 0.25 + 0.5 * i, 0.25 + 0.5 * j) for k in range(count) for j in range(2) for i in range(2)]
    np.testing.assert_allclose(np.sort(centres.view("f8,f8").ravel()).view(float).reshape(-1, 2), sorted(expected))
    np.testing.assert_allclose(centres[:, 0] // 1, np.repeat(np.arange(count), 4))
