import numpy as np
import pytest

from hoblock.numbering import corner_nodes, number_nodes, side_nodes
from hoblock.reference import equispaced


def test_corners_and_sides_of_order_two():
    assert corner_nodes(2).tolist() == [0, 2, 8, 6]
    assert side_nodes(2).tolist() == [[0, 1, 2], [2, 5, 8], [6, 7, 8], [0, 3, 6]]


@pytest.mark.parametrize("order", [1, 3, 6])
def test_sides_run_along_the_increasing_coordinate(order):
    x = equispaced(order)
    grid = np.stack(np.meshgrid(x, x, indexing="xy"), axis=-1).reshape(-1, 2)
    bottom, right, top, left = grid[side_nodes(order)]
    for side, varying, fixed in ((bottom, 0, -1), (right, 1, 1), (top, 0, 1), (left, 1, -1)):
        np.testing.assert_array_equal(side[:, varying], x)
        np.testing.assert_array_equal(side[:, 1 - varying], fixed)
    assert grid[corner_nodes(order)].tolist() == [[-1, -1], [1, -1], [1, 1], [-1, 1]]


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_nodes_are_one_to_one_with_places(kind, order, layouts, rng):
    """Whatever the rotation of the elements: equispaced nodes of bilinear elements coincide iff their numbers do."""
    vertices, quads = layouts.quads(kind)
    quads = np.array([np.roll(quad, rng.integers(4)) for quad in quads])
    labels = rng.permutation(500)[: len(vertices)]  # identities may be any integers
    cells, count = number_nodes(labels[quads], order)
    t = (equispaced(order) + 1) / 2
    u, v = (grid.ravel()[:, None] for grid in np.meshgrid(t, t, indexing="xy"))
    a, b, c, d = (vertices[quads[:, k]][:, None] for k in range(4))
    places = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    assert cells.shape == places.shape[:2]
    assert np.array_equal(np.unique(cells), np.arange(count))
    distinct, node_of_place = np.unique(np.round(places.reshape(-1, 2), 9) + 0.0, axis=0, return_inverse=True)
    assert len(distinct) == count
    pairs = np.unique(np.stack([cells.ravel(), node_of_place.ravel()]), axis=1)
    assert pairs.shape[1] == count


def test_corners_come_first_then_edges_then_interiors():
    cells, count = number_nodes(np.array([[0, 1, 2, 3], [1, 4, 5, 2]]), 3)
    assert count == 6 + 7 * 2 + 2 * 4
    assert cells[:, corner_nodes(3)].max() == 5
    assert sorted(cells[:, [5, 6, 9, 10]].ravel()) == list(range(20, 28))
    assert np.array_equal(cells[0, side_nodes(3)[1]], cells[1, side_nodes(3)[3]])


def test_edges_are_numbered_in_the_order_of_their_corners():
    cells, count = number_nodes(np.array([(7, 900, 5, 3), (900, 11, 4, 5)]), 3)
    assert count == 28
    np.testing.assert_array_equal(cells[0, side_nodes(3)[1]], cells[1, side_nodes(3)[3]])
    assert np.unique(cells).size == count
