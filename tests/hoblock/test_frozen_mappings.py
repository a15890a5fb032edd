"""Structures and meshes are copied deeply and sent to other processes."""

import copy
import pickle

import numpy as np
import pytest

from hoblock import generate

COPIES = [copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))]  # noqa: S301


@pytest.mark.parametrize("copied", COPIES)
def test_copies_of_structures_make_the_same_mesh(copied, layouts):
    structure = layouts.annulus(counts=3)
    mesh, again = generate(structure, 3), generate(copied(structure), 3)
    np.testing.assert_array_equal(again.points, mesh.points)
    np.testing.assert_array_equal(again.cells, mesh.cells)


@pytest.mark.parametrize("copied", COPIES)
def test_copies_of_meshes_are_read_only_and_complete(copied, layouts):
    mesh = generate(layouts.annulus(counts=2), 2)
    again = copied(mesh)
    np.testing.assert_array_equal(again.points, mesh.points)
    assert again.order == mesh.order
    assert list(again.edge_groups) == ["inner", "outer"]
    for array in (again.points, again.cells, again.edge_groups["inner"]):
        assert not array.flags.writeable
    with pytest.raises(TypeError):
        again.edge_groups["new"] = again.edge_groups["inner"]


def test_copies_of_a_topology_find_edges(layouts):
    topology = layouts.square(counts=2).topology
    again = copy.deepcopy(topology)
    assert again.edge(0, 1) == topology.edge(0, 1)
    assert again.vertex("c") == topology.vertex("c")
