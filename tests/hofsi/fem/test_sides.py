"""Element sides at the boundary."""

from hoblock import BlockStructure, generate
from hofsi.fem.sides import boundary_sides


def test_boundary_sides_are_those_of_one_element():
    vertices = {"a": (0, 0), "b": (2, 0), "c": (2, 1), "d": (0, 1)}
    around = {"bottom": [("a", "b")], "right": [("b", "c")], "top": [("d", "c")], "left": [("a", "d")]}
    counts = {("a", "b"): 3, ("b", "c"): 2}
    structure = BlockStructure.build(vertices, {"fluid": [("a", "b", "c", "d")]}, counts=counts, edges=around)
    mesh = generate(structure, 2)
    named = [tuple(pair) for name in around for pair in mesh.edge_groups[name].tolist()]
    assert sorted(map(tuple, boundary_sides(mesh).tolist())) == sorted(named)
    assert len(named) == 10
