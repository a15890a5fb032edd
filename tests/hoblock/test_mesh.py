import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.mesh import QuadMesh


@pytest.fixture
def mesh():
    cells = np.array([[0, 1, 3, 4], [1, 2, 4, 5]])
    points = np.array([(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)], dtype=float)
    return QuadMesh(points, cells, 1, {"right": np.array([1])}, {"top": np.array([(0, 2), (1, 2)])})


def test_corners_are_counter_clockwise(mesh):
    assert mesh.corners.tolist() == [[0, 1, 4, 3], [1, 2, 5, 4]]


def test_coordinates(mesh):
    assert mesh.coordinates.shape == (2, 4, 2)
    assert mesh.coordinates[1, 2].tolist() == [1, 1]


def test_nodes_of_named_edges(mesh, layouts):
    assert mesh.edge_nodes("top").tolist() == [3, 4, 5]
    square = generate(layouts.square(counts=2, edges={"lower": [("a", "b")], "corner": [("b", "c"), ("c", "d")]}), 3)
    np.testing.assert_array_equal(square.points[square.edge_nodes("lower"), 1], 0)
    assert len(square.edge_nodes("lower")) == 7
    assert len(square.edge_nodes("corner")) == 13
    with pytest.raises(KeyError, match="upper"):
        square.edge_nodes("upper")


def test_with_points_shares_everything_else(mesh):
    moved = mesh.with_points(mesh.points + 1)
    assert moved.cells is mesh.cells
    assert moved.cell_groups is mesh.cell_groups
    assert moved.edge_groups is mesh.edge_groups
    np.testing.assert_array_equal(moved.points, mesh.points + 1)
    with pytest.raises(ValueError, match=r"with_points: shape \(5, 2\); expected \(6, 2\)"):
        mesh.with_points(mesh.points[:5])


def test_read_only(mesh):
    for array in (mesh.points, mesh.cells, mesh.cell_groups["right"], mesh.edge_groups["top"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    with pytest.raises(TypeError):
        mesh.cell_groups["left"] = np.array([0])
    with pytest.raises(AttributeError):
        mesh.order = 2
