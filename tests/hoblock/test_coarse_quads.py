import numpy as np
import pytest

from hoblock.coarse_quads import structure_from_mesh, structure_from_quads
from hoblock.curves import LagrangeEdge, Reversed
from hoblock.errors import TopologyError
from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.reference import equispaced, gauss_lobatto, tensor_basis

POINTS = [(0, 0), (1, 0), (1, 1), (0, 1), (1 + 1e-12, 0), (2, 0), (2, 1), (1, 1), (9, 9)]


def nearest(points, others):
    return max(np.hypot(*(others - point).T).min() for point in points)


def test_clockwise_quads_duplicate_and_unused_points():
    structure = structure_from_quads(
        POINTS,
        [[0, 1, 2, 3], [7, 6, 5, 4]],
        block_groups={"one": [0]},
        edge_groups={"top": [[3, 2], [7, 6], [2, 3]]},
        counts={("0", "1"): 3, ("5", "6"): 2},
    )
    topology = structure.topology
    assert topology.vertex_names == ("0", "1", "2", "3", "5", "6")
    assert {name: blocks.tolist() for name, blocks in topology.block_groups.items()} == {"one": [0], "blocks": [1]}
    assert [topology.edge_name(k) for k in topology.edge_groups["top"]] == ["3–2", "2–6"]
    assert not structure.curves
    assert len(generate(structure, 4).cells) == 3 * 2 + 2


@pytest.mark.parametrize("kind", ["grid", "annulus"])
@pytest.mark.parametrize("order", [1, 2, 4, 7])
def test_a_mesh_whose_elements_are_transfinite_is_reproduced(kind, order, layouts, rng):
    mesh = generate(layouts.random(kind, rng, graded=False), order)
    structure = structure_from_mesh(mesh)
    assert len(structure.topology.quads) == len(mesh.cells)
    again = generate(structure, order)
    assert len(again.points) == len(mesh.points)
    assert nearest(again.points, mesh.points) < 1e-13
    halves = generate(structure_from_mesh(mesh, counts=2), order)  # the polynomial itself, cut in four
    assert nearest(mesh.points[mesh.corners].reshape(-1, 2), halves.points) < 1e-13


@pytest.mark.parametrize("target", ["gmsh", "vtk"])
@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_node_orders_and_quads_without_inner_nodes(target, order, layouts):
    mesh = generate(layouts.annulus(5, counts=1), order)
    x = equispaced(order)
    grid = np.stack(np.meshgrid(x, x, indexing="xy"), axis=-1).reshape(-1, 2)
    values = tensor_basis(gauss_lobatto(order), grid)
    points = (values @ mesh.coordinates).reshape(-1, 2)
    cells = np.arange(len(points)).reshape(len(mesh.cells), -1)[:, node_order(order, target)]
    for quads in (cells, cells[:, : 4 * order]):
        structure = structure_from_quads(points, quads, order=order, node_order=target)
        assert len(structure.topology.vertex_names) == 10
        assert {type(curve) for curve in structure.curves.values()} <= {LagrangeEdge, Reversed}
        assert len(structure.curves) == 10  # the radial sides are straight
        assert nearest(generate(structure, order).points, mesh.points) < 1e-13
    turned = structure_from_quads(points * [1, -1], cells, node_order=target)
    assert nearest(generate(turned, order).points, mesh.points * [1, -1]) < 1e-13


def test_names_of_groups_come_with_the_mesh(layouts):
    mesh = generate(layouts.annulus(3, counts=2), 3)
    groups = {"inner": mesh.edge_groups["inner"]}
    structure = structure_from_mesh(QuadMesh(mesh.points, mesh.cells, 3, {"fluid": np.arange(12)}, groups))
    assert {name: len(found) for name, found in structure.topology.edge_groups.items()} == {"inner": 6}
    radii = np.hypot(*structure.vertices[structure.topology.edges[structure.topology.edge_groups["inner"]]].T)
    np.testing.assert_allclose(radii, 1.0, atol=1e-14)


QUAD = [[0, 1, 2, 3]]


@pytest.mark.parametrize(
    ("points", "quads", "options", "match"),
    [
        (POINTS, [[0, 1, 2]], {}, r"quads: shape \(1, 3\); expected \(b, 4\), \(b, 8\)"),
        (POINTS, np.zeros((0, 4), dtype=int), {}, r"quads: shape \(0, 4\)"),
        (POINTS, [[0, 1, 2, 30]], {}, "quads: points 0 to 30; expected numbers from 0 to 8"),
        (POINTS, np.ones((1, 4)), {}, "quads: the type is float64; expected integers"),
        (POINTS, [[0, 1, 4, 3]], {}, r"quads\[0\]: corners \[0, 1, 4, 3\]; expected four points further apart"),
        ([(0, 0, 1)] * 4, QUAD, {}, r"points: shape \(4, 3\); expected \(n, 2\)"),
        (POINTS, QUAD, {"edge_groups": {"w": [[0, 8]]}}, r"edge_groups.w: \[0, 8\] are not both corners of quads"),
        (POINTS, QUAD, {"edge_groups": {"w": [0, 1]}}, r"edge_groups.w: shape \(2,\); expected \(k, 2\)"),
        (POINTS, QUAD, {"edge_groups": {"w": [[0, 2]]}}, "no block edge joins '0' and '2'"),
        (POINTS, QUAD, {"block_groups": {"w": [1]}}, "block_groups.w: 1 to 1; expected 0 to 0"),
        (POINTS, QUAD, {"node_order": "mfem"}, "node_order is 'mfem'; expected 'gmsh', 'vtk' or 'lexicographic'"),
        (POINTS, QUAD, {"names": ["p"] * 9}, "names: two vertices are called 'p'"),
        (POINTS, QUAD, {"counts": 0}, "0 elements; expected at least 1"),
        (
            POINTS,
            [list(range(8))],
            {"node_order": "lexicographic"},
            "quads: 8 points row by row; expected 4, 9",
        ),
    ],
)
def test_arrays_that_do_not_fit(points, quads, options, match):
    with pytest.raises(TopologyError, match=match):
        structure_from_quads(points, quads, **options)


def test_neighbours_must_agree_about_their_side():
    corners = [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)]
    middles = [(0.5, 0), (1.1, 0.5), (0.5, 1), (0, 0.5), (1.5, 0), (2, 0.5), (1.5, 1), (0.9, 0.5)]
    quads = [[0, 1, 4, 3, 6, 7, 8, 9], [1, 2, 5, 4, 10, 11, 12, 13]]
    match = "two of them have the side 4–1, with points up to 0.2 apart; expected the same points. Check the node order"
    with pytest.raises(TopologyError, match=match):
        structure_from_quads(corners + middles, quads)
    quads[1][-1] = 7
    assert len(structure_from_quads(corners + middles, quads).curves) == 1
    with pytest.raises(TopologyError, match="spacing is 'even'; expected 'equispaced' or 'gll'"):
        structure_from_quads(corners + middles, quads, spacing="even")
