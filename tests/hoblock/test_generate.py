"""Generated meshes: conforming, on their curves, graded, checked."""

from itertools import pairwise

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, NodalCurve, Parametric
from hoblock.errors import CurveError, GradingError, InvalidMeshError
from hoblock.generate import generate, raise_if_invalid, regenerate
from hoblock.grading import Exponential, Quadratic
from hoblock.layout import layout
from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.quality import det_jacobian, scaled_jacobian
from hoblock.reference import gauss_lobatto, tensor_quadrature

LAYOUTS = ("grid", "disc", "star", "annulus")


def area(mesh):
    points, weights = tensor_quadrature(mesh.order + 2)
    return float((det_jacobian(mesh, points) @ weights).sum())


@pytest.mark.parametrize("kind", LAYOUTS)
@pytest.mark.parametrize("seed", [11, 12, 13])
def test_conforming_on_random_structures(kind, seed, layouts):
    """Elements that touch share nodes, in the same direction, and no two nodes are in one place."""
    rng = np.random.default_rng(seed)
    structure = layouts.random(kind, rng)
    order = int(rng.integers(2, 6))
    mesh = generate(structure, order)
    assert np.array_equal(np.unique(mesh.cells), np.arange(len(mesh.points)))
    gaps = mesh.points[:, None] - mesh.points[None]
    distance = np.hypot(gaps[..., 0], gaps[..., 1]) + np.diag(np.ones(len(mesh.points)))
    assert distance.min() > 1e-4
    sides = mesh.cells[:, side_nodes(order)].reshape(-1, order + 1)
    by_ends = {}
    for side in sides:
        by_ends.setdefault(frozenset(side[[0, -1]]), []).append(tuple(side))
    assert all(len(set(equal)) == 1 and len(equal) <= 2 for equal in by_ends.values())
    # Euler's formula counts the elements' corners and sides once each; the annulus has a hole.
    corners = len(np.unique(mesh.corners))
    assert corners - len(by_ends) + len(mesh.cells) == (0 if kind == "annulus" else 1)
    assert len(mesh.points) == corners + len(by_ends) * (order - 1) + len(mesh.cells) * (order - 1) ** 2


@pytest.mark.parametrize("kind", LAYOUTS)
def test_area_is_that_inside_the_boundary(kind, layouts, rng):
    """Green's formula along the boundary nodes: the interior cannot matter."""
    structure = layouts.random(kind, rng)
    mesh = generate(structure, 4)
    sides = mesh.cells[:, side_nodes(4)]  # (e, 4, 5)
    _, first, uses = np.unique(np.sort(sides.reshape(-1, 5), axis=1), axis=0, return_index=True, return_counts=True)
    outer = first[uses == 1]
    nodes = mesh.points[sides.reshape(-1, 5)[outer]]
    sign = np.where(outer % 4 < 2, 1.0, -1.0)  # sides 0 and 1 run counter-clockwise
    points, weights = np.polynomial.legendre.leggauss(6)
    fit = np.linalg.inv(np.vander(gauss_lobatto(4), increasing=True))
    values = np.vander(points, 5, increasing=True) @ fit
    slopes = (np.vander(points, 5, increasing=True)[:, :4] * np.arange(1, 5)) @ fit[1:]
    x, dy = (values @ nodes)[..., 0], (slopes @ nodes)[..., 1]
    assert area(mesh) == pytest.approx(float((sign * (x * dy @ weights)).sum()), rel=1e-12)


def test_edge_nodes_lie_on_their_curves_at_graded_parameters(layouts):
    structure = layouts.square(
        counts=3, curves={("b", "a"): Arc.through((1, 0), (0.5, -0.2), (0, 0))}, gradings={("a", "b"): Exponential(1.5)}
    )
    plan = layout(structure, 4)
    edge, forward = structure.topology.edge(0, 1)
    assert forward
    mesh = generate(structure, 4)
    corners = Exponential(1.5)(np.linspace(0, 1, 4))
    inner = (gauss_lobatto(4) + 1) / 2
    t = np.concatenate([[0.0], *(a + (b - a) * inner[1:] for a, b in pairwise(corners))])
    arc = Arc.through((0, 0), (0.5, -0.2), (1, 0))
    np.testing.assert_allclose(mesh.points[plan.nodes_of_edge(edge)], arc(t), atol=1e-14)
    np.testing.assert_array_equal(mesh.points[plan.vertex_nodes], structure.vertices)


def test_different_gradings_on_opposite_edges_put_nodes_on_intersections_of_lines(layouts):
    gradings = {("a", "b"): Exponential(2.0), ("d", "c"): Quadratic(-0.5), ("a", "d"): Exponential(-1.0)}
    structure = layouts.square(counts=3, gradings=gradings)
    mesh = generate(structure, 3)
    plan = layout(structure, 3)
    bottom, right, top, left = (mesh.points[plan.nodes_of_edge(k)] for k in structure.topology.block_edges[0])
    others = {tuple(np.round(p, 10)) for p in mesh.points}
    for first, second in zip(bottom, top, strict=True):
        for start, stop in zip(left, right, strict=True):
            matrix = np.stack([second - first, start - stop], axis=-1)
            s, _ = np.linalg.solve(matrix, start - first)
            others.discard(tuple(np.round(first + s * (second - first), 10)))
    assert not others


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_area_of_an_annulus_converges_with_the_elements(order, layouts):
    exact = np.pi * 3.0
    errors = [abs(area(generate(layouts.annulus(4, counts=n), order)) - exact) for n in (1, 2, 4)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    # Nodes on the circle at Gauss-Lobatto points: the area converges at twice the order.
    assert np.all(np.abs(rates - 2 * order) < 0.35)


def test_area_of_an_annulus_converges_spectrally_with_the_order(layouts):
    errors = [abs(area(generate(layouts.annulus(3), order)) - 3 * np.pi) for order in range(2, 13)]
    assert errors[-1] < 1e-13
    above = [error for error in errors if error > 1e-12]
    assert len(above) >= 5
    ratios = np.array(above[1:]) / above[:-1]
    assert np.all(ratios < 0.12)
    assert ratios[-1] < 0.5 * ratios[0]  # faster than geometric


def test_groups_of_cells_and_sides(layouts):
    mesh = generate(layouts.annulus(5, counts=2), 3)
    assert mesh.cell_groups["blocks"].tolist() == list(range(20))
    assert {name: len(sides) for name, sides in mesh.edge_groups.items()} == {"inner": 10, "outer": 10}
    for name, radius in (("inner", 1.0), ("outer", 2.0)):
        np.testing.assert_allclose(np.hypot(*mesh.points[mesh.edge_nodes(name)].T), radius, atol=1e-14)


def test_nodal_curves_are_taken_as_they_are(layouts, rng):
    structure = layouts.square(counts=2, gradings={("a", "b"): Exponential(1.0)})
    edge, _ = structure.topology.edge(0, 1)
    t = np.linspace(0, 1, 7)
    points = np.stack([t, 0.03 * np.sin(9 * t) * t * (1 - t)], axis=-1)
    bent = structure.moved(structure.vertices, {edge: NodalCurve(points, 3)})
    mesh = generate(bent, 3)
    np.testing.assert_array_equal(mesh.points[layout(bent, 3).nodes_of_edge(edge)], points)
    finer = generate(bent, 6)  # the same polynomials, at more points
    curve = NodalCurve(points, 3)
    inner = (gauss_lobatto(6) + 1) / 2
    expected = curve(np.concatenate([inner[:-1] / 2, (1 + inner) / 2]))
    np.testing.assert_allclose(finer.points[layout(bent, 6).nodes_of_edge(edge)], expected, atol=1e-14)


def test_restricted_structure_has_the_same_elements(layouts):
    vertices, quads = layouts.quads("grid")
    blocks = {"fluid": quads[:4], "solid": quads[4:]}
    gradings = {(5, 6): Exponential(1.0), (1, 5): Exponential(-0.5)}
    whole = BlockStructure.build(vertices, blocks, counts=2, gradings=gradings)
    mesh = generate(whole, 3)
    parts = [generate(whole.restricted([name]), 3) for name in blocks]
    together = np.concatenate([part.coordinates for part in parts])
    np.testing.assert_allclose(together, mesh.coordinates, atol=1e-15)
    # Common nodes are in the same places bit by bit.
    common = {tuple(p) for p in parts[0].points} & {tuple(p) for p in parts[1].points}
    shared = whole.shared_edges(["fluid"], ["solid"])
    assert len(common) == len(np.unique(np.concatenate([layout(whole, 3).nodes_of_edge(k) for k in shared])))


def test_invalid_meshes_name_block_element_and_place(layouts):
    structure = layouts.square(counts=2, curves={("a", "b"): layouts.bump((0, 0), (1, 0), 1.4)})
    with pytest.raises(
        InvalidMeshError,
        match=r"4 of 4 elements are invalid: det J <= 0 somewhere\. Worst: element \d in "
        r"blocks\.body\[0\] \(a, b, c, d\), det J = -.* at \(xi, eta\) = .*, \(x, y\) = .*\. The curve of edge a–b",
    ):
        generate(structure, 4)
    mesh = generate(structure, 4, check=False)
    with pytest.raises(InvalidMeshError, match="Worst: element"):
        raise_if_invalid(mesh, structure)


def test_inverted_after_a_motion(layouts):
    structure = layouts.square()
    vertices = np.array(structure.vertices)
    vertices[:, 0] *= -1
    with pytest.raises(InvalidMeshError, match=r"1 of 1 elements .* The block is inverted"):
        generate(structure.moved(vertices), 2)


def test_bad_arguments(layouts):
    structure = layouts.square(counts=2)
    mesh = generate(structure, 2)
    with pytest.raises(ValueError, match="order is 0; expected an integer >= 1"):
        generate(structure, 0)
    other = BlockStructure.build(*layouts.quads("disc"))
    with pytest.raises(ValueError, match="regenerate: the mesh was made from another block structure; use generate"):
        regenerate(mesh, other)
    with pytest.raises(ValueError, match=r"out has shape \(3, 2\), type float64; expected \(25, 2\), float64"):
        regenerate(mesh, structure, out=np.zeros((3, 2)))
    with pytest.raises(ValueError, match="type float32"):
        regenerate(mesh, structure, out=np.zeros((25, 2), dtype=np.float32))
    buffer = np.array(mesh.points)
    kept = QuadMesh(buffer, mesh.cells, 2, {}, {})
    with pytest.raises(ValueError, match="out is the buffer of the mesh that is to be kept; use another"):
        regenerate(kept, structure, out=buffer, previous=structure)
    with pytest.raises(GradingError, match=r"edge a–b: .* is not strictly increasing"):
        generate(layouts.square(counts=100, gradings={("a", "b"): Exponential(-50)}), 1)
    three = NodalCurve(np.array([(0, 0), (0.5, 0.1), (0.7, 0), (1, 0)]), 1)
    nodal = layouts.square(counts=2, curves={("a", "b"): three})
    with pytest.raises(CurveError, match="edge a–b: the nodal curve has 3 elements; the edge has 2"):
        generate(nodal, 2)


@pytest.mark.parametrize("order", [-1, 33, 2.0, 2.5, "4", True, None])
def test_orders_are_integers_in_range(order, layouts):
    with pytest.raises(ValueError, match=r"order is .*; expected an integer"):
        generate(layouts.square(), order)


@pytest.mark.parametrize("order", [1, 2, 5, 8, 12, 16])
def test_quarter_annulus_of_graded_layers(order):
    """Eight layers by two elements: straight lines inside would make the inner layers overlap."""
    corners = np.array([(1, 0), (1.6, 0), (0, 1.6), (0, 1)])
    arcs = {(a, b): Arc.from_center((0.0, 0.0), corners[a], corners[b]) for a, b in ((0, 3), (1, 2))}
    layers = {(0, 1): Exponential(3.0), (3, 2): Exponential(3.0)}
    structure = BlockStructure.build(
        corners, [(0, 1, 2, 3)], counts={(0, 1): 8, (1, 2): 2}, curves=arcs, gradings=layers
    )
    mesh = generate(structure, order)
    assert len(mesh.cells) == 16
    assert scaled_jacobian(mesh).min() > (0.999 if order > 1 else 0.92)
    if order > 4:
        assert area(mesh) == pytest.approx(np.pi / 4 * (1.6**2 - 1), rel=1e-7)


def test_layers_a_hundred_thousand_times_thinner_than_long():
    height = 1e-5
    corners = np.array([(1, 0), (1 + height, 0), (0, 1 + height), (0, 1), (2, 0), (0, 2)])
    arcs = {(a, b): Arc.from_center((0.0, 0.0), corners[a], corners[b]) for a, b in ((0, 3), (1, 2), (4, 5))}
    structure = BlockStructure.build(corners, [(0, 1, 2, 3), (1, 4, 5, 2)], counts=4, curves=arcs)
    assert area(generate(structure, 6)) == pytest.approx(np.pi / 4 * 3, rel=1e-6)


def test_airfoil_from_parametric_edges(rng):
    def surface(t, side):  # NACA 0012, dense at the nose
        x = t**2
        y = 0.6 * (0.2969 * t - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
        return np.stack([x, side * y], axis=-1)

    middle = np.sqrt(0.3)
    thick = surface(np.array([middle]), 1.0)[0]
    vertices = {
        "nose": (0, 0), "tail": (1, 0), "top": thick, "bottom": thick * [1, -1],
        "W": (-1.5, 0), "E": (2.5, 0), "N": (0.3, 1.5), "S": (0.3, -1.5),
    }  # fmt: skip
    blocks = [
        ("nose", "top", "N", "W"), ("top", "tail", "E", "N"),
        ("bottom", "nose", "W", "S"), ("tail", "bottom", "S", "E"),
    ]  # fmt: skip
    walls = {
        ("nose", "top"): Parametric(lambda t: surface(middle * t, 1.0)),
        ("tail", "top"): Parametric(lambda t: surface(1 + (middle - 1) * t, 1.0)),
        ("bottom", "nose"): Parametric(lambda t: surface(middle * (1 - t), -1.0)),
        ("bottom", "tail"): Parametric(lambda t: surface(middle + (1 - middle) * t, -1.0)),
    }
    layers = {pair: Exponential(3.0) for pair in (("nose", "W"), ("top", "N"), ("tail", "E"), ("bottom", "S"))}
    structure = BlockStructure.build(vertices, blocks, counts=6, curves=walls, gradings=layers)
    coefficients = np.array([0.2969 / 1.5, -0.126 / 2, -0.3516 / 3, 0.2843 / 4, -0.1036 / 5])
    profile = 2 * 0.6 * coefficients.sum()
    assert area(generate(structure, 8)) == pytest.approx(6.0 - profile, rel=1e-9)


def test_parts_that_do_not_touch_and_regions_with_holes(layouts):
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    two = np.concatenate([square, square + np.array([3, 0])])
    mesh = generate(BlockStructure.build(two, [(0, 1, 2, 3), (4, 5, 6, 7)]), 3)
    assert len(mesh.points) == 32
    assert area(mesh) == pytest.approx(2.0)
    ring = generate(layouts.annulus(sectors=3, counts=4), 7)
    assert area(ring) == pytest.approx(3 * np.pi, rel=1e-7)


def test_strongly_different_gradings_of_opposite_edges(layouts):
    gradings = {("a", "b"): Exponential(20), ("d", "c"): Exponential(-20)}
    gradings |= {("a", "d"): Exponential(-20), ("b", "c"): Exponential(20)}
    assert area(generate(layouts.square(counts=10, gradings=gradings), 4)) == pytest.approx(1.0)


def test_a_curve_that_fails_between_its_ends_is_named(layouts):
    def gap(t):
        return np.stack([t, np.where((t > 0.2) & (t < 0.8), np.nan, 0.0)], axis=-1)

    with pytest.raises(CurveError, match="edge a–b: parametric curve: not finite at t = "):
        generate(layouts.square(counts=2, curves={("a", "b"): Parametric(gap)}), 3)

    def flat(t):
        return np.stack([t, 0 * t], axis=-1) if len(t) == 2 else t

    with pytest.raises(CurveError, match=r"edge a–b: the curve returned shape \(7,\) for 7 parameters; expected"):
        generate(layouts.square(counts=2, curves={("a", "b"): flat}), 3)


def test_vertices_that_are_infinite_are_invalid_without_warnings(layouts):
    structure = layouts.square(counts=2)
    vertices = np.array(structure.vertices)
    vertices[0] = np.inf
    with pytest.raises(InvalidMeshError, match="not finite"):
        generate(structure.moved(vertices), 2)


def test_gradings_and_curves_of_wrong_kinds(layouts):
    class NoHash:
        __hash__ = None

        def __call__(self, s):
            return s

    with pytest.raises(GradingError, match=r"edge a–b has .*, which has no hash"):
        layouts.square(gradings={("a", "b"): NoHash()})
    with pytest.raises(CurveError, match=r"edge a–b has <class .*; expected a function"):
        layouts.square(curves={("a", "b"): Arc})
    with pytest.raises(GradingError, match=r"edge a–b: .* fails on an array of parameters"):
        generate(layouts.square(counts=3, gradings={("a", "b"): lambda s: float(s)}), 2)
    with pytest.raises(GradingError, match=r"edge a–b: .* returned shape \(\) for 4 parameters"):
        generate(layouts.square(counts=3, gradings={("a", "b"): lambda s: 0.5}), 2)
