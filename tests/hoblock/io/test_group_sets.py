import numpy as np

from hoblock.generate import generate
from hoblock.io.group_sets import boundary_sides, group_sets, named_sides
from hoblock.mesh import QuadMesh


def test_overlaps_make_sets_of_their_own():
    groups = {"a": np.array([0, 1]), "b": np.array([1, 2]), "none": np.zeros(0, dtype=int), "ab": np.array([1])}
    sets, classes = group_sets(groups, 5)
    assert sets[:4] == [(0,), (1,), (2,), (3,)]
    assert [sets[k] for k in classes] == [(0,), (0, 1, 3), (1,), (), ()]


def test_without_groups_or_things():
    sets, classes = group_sets({}, 3)
    assert (sets, classes.tolist()) == ([()], [0, 0, 0])
    sets, classes = group_sets({"a": np.zeros(0, dtype=int)}, 0)
    assert (sets, classes.tolist()) == ([(0,)], [])


def test_named_sides_are_listed_once(layouts):
    mesh = generate(layouts.square(counts=2), 1)
    edges = {"a": np.array([(3, 2), (0, 0)]), "b": np.array([(0, 0), (1, 1)])}
    sides, members = named_sides(QuadMesh(mesh.points, mesh.cells, 1, {}, edges))
    assert sides.tolist() == [[0, 0], [1, 1], [3, 2]]
    assert {name: sides[k].tolist() for name, k in members.items()} == {name: k.tolist() for name, k in edges.items()}


def test_sides_on_the_boundary(layouts, rng):
    mesh = generate(layouts.annulus(5, counts=2), 3)
    found = set(map(tuple, boundary_sides(mesh).tolist()))
    assert found == {tuple(side) for members in mesh.edge_groups.values() for side in members.tolist()}
