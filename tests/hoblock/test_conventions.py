"""The statements of docs/conventions.md that a test can check."""

import re
from pathlib import Path

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.generate import generate
from hoblock.grading import Exponential
from hoblock.layout import layout
from hoblock.numbering import corner_nodes, side_nodes
from hoblock.quality import det_jacobian
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient

PAGE = Path(__file__).parents[2] / "docs" / "conventions.md"


@pytest.fixture(scope="module")
def drawing():
    if not PAGE.exists():
        pytest.skip("docs/conventions.md is not beside these tests")
    return re.search(r"## Reference element.*?## Blocks", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]


def test_the_drawing_of_an_element_of_order_two_is_what_is_numbered(drawing):
    rows = re.findall(r"(\d) (\d) (\d)\n", drawing)
    drawn = np.array(rows, dtype=int)[::-1]  # η upwards
    i, j = np.meshgrid(np.arange(3), np.arange(3), indexing="xy")
    np.testing.assert_array_equal(drawn, i + 3 * j)
    x = gauss_lobatto(2)
    grid = np.stack(np.meshgrid(x, x, indexing="xy"), axis=-1).reshape(-1, 2)
    np.testing.assert_array_equal(tensor_basis(x, grid), np.eye(9))
    corners = [drawn[0, 0], drawn[0, -1], drawn[-1, -1], drawn[-1, 0]]
    assert corner_nodes(2).tolist() == corners
    assert side_nodes(2).tolist() == [drawn[0].tolist(), drawn[:, 2].tolist(), drawn[2].tolist(), drawn[:, 0].tolist()]


def test_the_drawing_shows_all_sides_along_the_increasing_coordinate(drawing):
    assert re.search(r"side 2, \+ξ\s+3 ─+► 2", drawing)
    assert re.search(r"0 ─+► 1\s+side 0, \+ξ", drawing)
    assert drawing.count("▲") == 3  # sides 3 and 1, and the axis
    assert "▼" not in drawing
    assert "◄" not in drawing


@pytest.mark.parametrize("kind", ["grid", "disc", "star", "annulus"])
def test_parallel_edges_of_every_block_and_element(kind, layouts, rng):
    structure = layouts.random(kind, rng)
    topology = structure.topology
    a, b, c, d = topology.quads.T
    bottom, right, top, left = (topology.edges[topology.block_edges[:, k]] for k in range(4))
    for edge, (first, second) in ((bottom, (a, b)), (right, (b, c)), (top, (d, c)), (left, (a, d))):
        np.testing.assert_array_equal(edge, np.stack([first, second], axis=-1))
    for order in (2, 3):
        mesh = generate(structure, order)
        sides = mesh.cells[:, side_nodes(order)].reshape(-1, order + 1)
        directions = {frozenset(side[[0, -1]]): set() for side in sides}
        for side in sides:
            directions[frozenset(side[[0, -1]])].add(tuple(side))
        assert all(len(ways) == 1 for ways in directions.values())
        assert det_jacobian(mesh, np.zeros((1, 2))).min() > 0  # counter-clockwise


def test_chains_carry_one_number_of_elements(layouts, rng):
    topology = layouts.random("disc", rng).topology
    for chain in np.unique(topology.chains):
        assert len(np.unique(topology.counts[topology.chains == chain])) == 1


def test_gradings_and_curves_run_from_the_edges_first_vertex_as_written(layouts):
    for first, second in (("a", "b"), ("b", "a")):
        structure = layouts.square(counts=4, gradings={(first, second): Exponential(2.0)})
        x = np.unique(generate(structure, 1).points[:, 0][generate(structure, 1).points[:, 1] == 0])
        dense_at_zero = x[1] - x[0] < x[-1] - x[-2]
        assert dense_at_zero == (first == "a")


def test_block_coordinates(layouts):
    """Nodes of an edge run from its first vertex; u along the bottom, v along the left edge."""
    structure = BlockStructure.build(*layouts.quads("grid"), counts=2)
    plan, mesh = layout(structure, 3), generate(structure, 3)
    for edge, (first, second) in enumerate(structure.topology.edges):
        nodes = plan.nodes_of_edge(edge)
        np.testing.assert_array_equal(mesh.points[nodes[[0, -1]]], structure.vertices[[first, second]])
    first_cell = np.flatnonzero(plan.block_of_cell == 0)[0]
    corner = mesh.points[mesh.corners[first_cell, 0]]
    np.testing.assert_array_equal(corner, structure.vertices[structure.topology.quads[0, 0]])


def test_axes_of_arrays(layouts):
    mesh = generate(layouts.square(counts=2), 3)
    assert mesh.points.shape == (49, 2)
    assert mesh.cells.shape == (4, 16)
    assert tensor_gradient(gauss_lobatto(3), np.zeros((5, 2))).shape == (5, 16, 2)
