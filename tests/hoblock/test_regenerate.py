"""Meshes of moved structures in the layout of an earlier one."""

import time

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.generate import changed_blocks, generate, regenerate
from hoblock.grading import Exponential
from hoblock.layout import layout

LAYOUTS = ("grid", "disc", "star", "annulus")


@pytest.mark.parametrize("kind", LAYOUTS)
def test_regenerate_is_generate_of_the_moved_structure(kind, layouts, rng):
    structure = layouts.random(kind, rng)
    mesh = generate(structure, 3)
    moved = structure.moved(structure.vertices + 0.03 * rng.uniform(-1, 1, structure.vertices.shape))
    again = regenerate(mesh, moved)
    assert again.cells is mesh.cells
    np.testing.assert_array_equal(again.points, generate(moved, 3).points)
    assert np.abs(again.points - mesh.points).max() > 0.01
    np.testing.assert_array_equal(regenerate(again, structure).points, mesh.points)


def test_regenerate_into_a_buffer(layouts, rng):
    structure = layouts.random("star", rng)
    mesh = generate(structure, 4)
    moved = structure.moved(structure.vertices * 1.1)
    out = np.full(mesh.points.shape, np.nan)
    again = regenerate(mesh, moved, out=out)
    assert np.shares_memory(again.points, out)
    np.testing.assert_array_equal(out, regenerate(mesh, moved).points)
    out[0] = 7.0  # the owner may still write
    assert again.points[0, 0] == 7.0


def test_regenerate_with_previous_writes_changed_blocks_only(layouts, rng):
    structure = layouts.random("grid", rng)
    mesh = generate(structure, 4)
    vertices = np.array(structure.vertices)
    corner = int(np.argmin(vertices.sum(axis=1)))  # the grid's corner belongs to one block
    vertices[corner] -= 0.05
    moved = structure.moved(vertices)
    changed = changed_blocks(structure, moved)
    assert changed.sum() == 1
    # Marks inside the blocks show which are written.
    inside = (np.arange(1, 4)[:, None] * 5 + np.arange(1, 4)).ravel()
    marked = np.array(mesh.points)
    marked[mesh.cells[:, inside]] = 99.0
    again = regenerate(mesh.with_points(marked), moved, previous=structure)
    block_of_cell = layout(structure, 4).block_of_cell
    for cell, block in enumerate(block_of_cell):
        nodes = again.points[mesh.cells[cell, inside]]
        assert (nodes == 99.0).all() != changed[block]
    np.testing.assert_array_equal(regenerate(mesh, moved, previous=structure).points, generate(moved, 4).points)


def test_regenerate_without_change_copies(layouts, rng):
    structure = layouts.random("disc", rng)
    mesh = generate(structure, 3)
    same = structure.moved(structure.vertices)
    assert not changed_blocks(structure, same).any()
    again = regenerate(mesh, same, previous=structure)
    np.testing.assert_array_equal(again.points, mesh.points)
    assert not np.shares_memory(again.points, mesh.points)


def test_changed_curves_change_both_blocks_beside_them(layouts):
    structure = BlockStructure.build(*layouts.quads("grid"), counts=2)
    topology = structure.topology
    edge = int(np.flatnonzero(topology.blocks_per_edge == 2)[0])
    ends = structure.vertices[topology.edges[edge]]
    bent = structure.moved(structure.vertices, {edge: layouts.bump(*ends, 0.1)})
    changed = changed_blocks(structure, bent)
    assert np.array_equal(changed, (topology.block_edges == edge).any(axis=1))
    mesh = generate(structure, 3)
    np.testing.assert_array_equal(regenerate(mesh, bent, previous=structure).points, generate(bent, 3).points)


def test_misuse_of_out_and_previous(layouts):
    structure = layouts.square(counts=2)
    mesh = generate(structure, 3)
    with pytest.raises(ValueError, match="out is read-only, as the points of meshes are"):
        regenerate(mesh, structure, out=mesh.points)
    with pytest.raises(ValueError, match="out is a list; expected an array"):
        regenerate(mesh, structure, out=[0.0])
    other = BlockStructure.build(*layouts.quads("disc"))
    graded = layouts.square(counts=2, gradings={("a", "b"): Exponential(2.0)})
    for previous in (other, graded):
        with pytest.raises(ValueError, match="previous has other blocks, counts or gradings"):
            regenerate(mesh, structure, previous=previous)
    named = structure.with_edge_group("all", [0, 1, 2, 3])
    np.testing.assert_array_equal(regenerate(mesh, structure, previous=named).points, mesh.points)


@pytest.mark.parametrize("buffer", [np.empty((98, 2))[::2], np.empty((49, 2), order="F"), np.empty((49, 3))[:, :2]])
def test_out_of_any_layout_in_memory(buffer, layouts):
    structure = layouts.square(counts=2)
    mesh = generate(structure, 3)
    moved = structure.moved(structure.vertices * [2.0, 1.0])
    assert np.shares_memory(regenerate(mesh, moved, out=buffer).points, buffer)
    np.testing.assert_allclose(buffer, mesh.points * [2.0, 1.0], atol=1e-15)


def test_regeneration_takes_less_time_than_writing_its_nodes_as_pairs(layouts):
    structure = layouts.wide()
    mesh = generate(structure, 4, check=False)
    buffer, values = np.empty_like(mesh.points), np.array(mesh.points)
    listed = np.random.default_rng(17).permutation(mesh.cells).ravel()
    nodes = listed[np.sort(np.unique(listed, return_index=True)[1])]  # as a mesh is numbered: in pieces
    pairs, regenerated = [], []
    for _ in range(9):
        start = time.process_time()
        buffer[nodes] = values
        middle = time.process_time()
        regenerate(mesh, structure, out=buffer)
        pairs.append(middle - start)
        regenerated.append(time.process_time() - middle)
    assert min(regenerated) < 0.8 * min(pairs)
