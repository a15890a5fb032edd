import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import TopologyError
from hoblock.generate import generate
from hoblock.io.skfem import lagrange_element, node_dofs, to_skfem
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.numbering import number_nodes
from hoblock.quality import det_jacobian
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_quadrature

skfem = pytest.importorskip("skfem")

ONE = skfem.Functional(lambda w: 1.0 + 0.0 * w.x[0])


def quarter_annulus(count, inner=1.0, outer=1.6):
    vertices = {"a": (inner, 0), "b": (outer, 0), "c": (0, outer), "d": (0, inner)}
    curves = {
        (first, second): Arc.from_center((0, 0), vertices[first], vertices[second])
        for first, second in (("b", "c"), ("a", "d"))
    }
    edges = {"outer": [("b", "c")], "inner": [("a", "d")], "bottom": [("a", "b")], "left": [("d", "c")]}
    return BlockStructure.build(vertices, {"ring": [tuple("abcd")]}, edges=edges, curves=curves, counts=count)


def turn_some(mesh, rng):
    """The same mesh with the local axes of many elements turned by quarter circles."""
    n = mesh.order + 1
    grid = np.arange(n * n).reshape(n, n)
    turns = rng.integers(0, 4, len(mesh.cells))
    orders = np.stack([np.rot90(grid, k).ravel() for k in range(4)])
    edge_groups = {}
    for name, sides in mesh.edge_groups.items():
        element, side = sides.T
        edge_groups[name] = np.stack([element, (side - turns[element]) % 4], axis=1)
    cells = np.take_along_axis(mesh.cells, orders[turns], axis=1)
    return QuadMesh(np.array(mesh.points), cells, mesh.order, dict(mesh.cell_groups), edge_groups)


def jump(m, element, intorder=8):
    """Largest jump of a random field across the sides inside the mesh."""
    sides = [skfem.InteriorFacetBasis(m, element, side=side, intorder=intorder) for side in (0, 1)]
    u = np.random.default_rng(5).normal(size=sides[0].N)
    difference = sides[0].interpolate(u) - sides[1].interpolate(u)
    return float(np.abs(np.asarray(difference)).max())


@pytest.mark.parametrize("order", [1, 2, 3, 5, 8, 12])
def test_element_is_a_nodal_basis_with_the_gradients_of_its_values(order):
    element = lagrange_element(order)
    assert element.doflocs.shape == ((order + 1) ** 2, 2)
    X = np.random.default_rng(7).uniform(0.05, 0.95, (2, 9))
    h = 1e-6
    for i in range(len(element.doflocs)):
        at_nodes, _ = element.lbasis(element.doflocs.T, i)
        np.testing.assert_allclose(at_nodes, np.eye(len(element.doflocs))[i], atol=1e-13)
        value, gradient = element.lbasis(X, i)
        for d in range(2):
            shift = h * np.eye(2)[d][:, None]
            slope = (element.lbasis(X + shift, i)[0] - element.lbasis(X - shift, i)[0]) / (2 * h)
            np.testing.assert_allclose(gradient[d], slope, atol=1e-6)
        per_element, _ = element.lbasis(np.stack([X, X[:, ::-1]], axis=1), i)
        np.testing.assert_array_equal(per_element, [value, value[::-1]])
    with pytest.raises(ValueError, match="Index larger"):
        element.lbasis(X, len(element.doflocs))


@pytest.mark.parametrize(("order", "kind"), [(1, "ElementQuad1"), (2, "ElementQuad2")])
def test_dofs_agree_with_scikit_fems_own_elements(order, kind):
    own = getattr(skfem, kind)()
    ours = lagrange_element(order)
    np.testing.assert_array_equal(ours.doflocs, own.doflocs)
    X = np.random.default_rng(8).uniform(size=(2, 5))
    for i in range((order + 1) ** 2):
        for mine, theirs in zip(ours.lbasis(X, i), own.lbasis(X, i), strict=True):
            np.testing.assert_allclose(mine, theirs, atol=1e-14)
    grid = np.stack(np.meshgrid(gauss_lobatto(order), gauss_lobatto(order)), axis=-1).reshape(-1, 2)
    np.testing.assert_allclose(own.doflocs, (grid[node_order(order, "skfem")] + 1) / 2)


@pytest.mark.parametrize("order", range(1, 11))
def test_integrals_are_those_of_the_mesh(order, layouts):
    mesh = generate(layouts.annulus(5, counts=2), order)
    m = to_skfem(mesh)
    basis = skfem.Basis(m, lagrange_element(order))
    area = ONE.assemble(basis)
    x = mesh.coordinates
    grid = np.linspace(-1, 1, 3)
    places = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
    mapped = tensor_basis(gauss_lobatto(order), places) @ x
    np.testing.assert_allclose(m.mapping().F((places.T + 1) / 2).transpose(1, 2, 0), mapped, atol=1e-13)
    points, weights = tensor_quadrature(order + 1)
    assert area == pytest.approx(float((det_jacobian(mesh, points) @ weights).sum()), rel=1e-13)
    if order > 7:
        assert area == pytest.approx(3 * np.pi, rel=1e-12)
    around = skfem.FacetBasis(m, lagrange_element(order))
    flux = skfem.Functional(lambda w: 0.5 * (w.n[0] * w.x[0] + w.n[1] * w.x[1]))
    assert flux.assemble(around) == pytest.approx(area, rel=1e-13)  # Gauss's theorem


def test_boundaries_and_subdomains_keep_their_names():
    mesh = generate(quarter_annulus(3), 6)
    m = to_skfem(mesh)
    assert set(m.boundaries) == {"outer", "inner", "bottom", "left"}
    for name, length in {"outer": 0.8 * np.pi, "inner": 0.5 * np.pi, "bottom": 0.6, "left": 0.6}.items():
        basis = skfem.FacetBasis(m, lagrange_element(6), facets=m.boundaries[name])
        assert ONE.assemble(basis) == pytest.approx(length, rel=1e-10)
    part = skfem.Basis(m, lagrange_element(6), elements="ring")
    assert ONE.assemble(part) == pytest.approx(np.pi / 4 * (1.6**2 - 1), rel=1e-10)
    dofs = skfem.Basis(m, lagrange_element(3)).get_dofs("outer")
    assert len(dofs.all()) == 3 * 3 + 1


@pytest.mark.parametrize("seed", [3, 4])
def test_normals_of_a_side_inside_point_out_of_its_elements(layouts, seed):
    vertices, quads = layouts.quads("grid")
    edges = {"interface": [(1, 5), (5, 9)]}
    structure = BlockStructure.build(vertices, {"fluid": quads}, edges=edges, counts=2)
    mesh = generate(structure, 3)
    sides = np.array(mesh.edge_groups["interface"])
    center = mesh.coordinates[sides[:, 0]].mean(axis=1)
    expected = np.where(center[:, 0] < vertices[1, 0], 1.0, -1.0)
    other = turn_some(mesh, np.random.default_rng(seed))
    for some in (mesh, other):
        m = to_skfem(some)
        basis = skfem.FacetBasis(m, lagrange_element(2), facets=m.boundaries["interface"])
        np.testing.assert_allclose(basis.normals[0], np.full(basis.normals[0].shape, expected[0]), atol=1e-14)


@pytest.mark.parametrize("q", range(1, 7))
@pytest.mark.parametrize("kind", ["ring", "star", "disc", "turned"])
def test_fields_are_continuous(q, kind, layouts):
    if kind == "ring":
        mesh = generate(layouts.annulus(5, counts=2), 4)
    else:
        vertices, quads = layouts.quads("star" if kind == "turned" else kind)
        mesh = generate(BlockStructure.build(vertices, quads, counts=2), 3)
    if kind == "turned":
        mesh = turn_some(mesh, np.random.default_rng(11))
    m = to_skfem(mesh)
    assert jump(m, lagrange_element(q)) < 1e-12
    if q > 2:
        assert jump(m, skfem.ElementQuadP(q)) < 1e-12


def test_without_common_directions_elements_of_order_3_would_jump(layouts):
    """What `to_skfem` spares its users: scikit-fem does not notice."""
    vertices, quads = layouts.quads("star")
    mesh = turn_some(generate(BlockStructure.build(vertices, quads, counts=2), 1), np.random.default_rng(11))
    plain = skfem.MeshQuad(mesh.points.T, mesh.corners.T)
    assert jump(plain, skfem.ElementQuadP(3)) > 0.01
    assert jump(to_skfem(mesh), skfem.ElementQuadP(3)) < 1e-12


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("p", "q"), [(1, 1), (3, 3), (2, 5), (4, 2)])
def test_nodal_values_and_dofs(p, q, turned, layouts):
    mesh = generate(layouts.annulus(5, counts=2), p)
    if turned:
        mesh = turn_some(mesh, np.random.default_rng(13))
    cells = mesh.cells if p == q else number_nodes(mesh.corners, q)[0]
    m = to_skfem(mesh)
    scalar = skfem.Basis(m, lagrange_element(q))
    dofs = node_dofs(scalar, cells)
    assert sorted(dofs) == list(range(scalar.N))
    grid = np.stack(np.meshgrid(gauss_lobatto(q), gauss_lobatto(q)), axis=-1).reshape(-1, 2)
    places = tensor_basis(gauss_lobatto(p), grid) @ mesh.coordinates
    np.testing.assert_allclose(scalar.doflocs[:, dofs[cells]].transpose(1, 2, 0), places, atol=1e-14)
    vector = skfem.Basis(m, skfem.ElementVector(lagrange_element(q)))
    pairs = node_dofs(vector, cells)
    assert pairs.shape == (len(dofs), 2)
    assert sorted(pairs.ravel()) == list(range(vector.N))
    u = np.empty(vector.N)
    u[pairs[cells]] = places
    field = vector.interpolate(u)
    if q >= p:
        np.testing.assert_allclose(np.asarray(field), vector.global_coordinates(), atol=1e-13)


@pytest.mark.parametrize("q", range(1, 7))
def test_poisson_on_a_curved_domain_converges_at_order_q_plus_1(q):
    """-Δu = f with u = sin(2x + 1) e^y given on the boundary; geometry of order q as well."""

    def exact(x):
        return np.sin(2 * x[0] + 1) * np.exp(x[1])

    @skfem.BilinearForm
    def stiffness(u, v, w):
        return u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1]

    @skfem.LinearForm
    def load(v, w):
        return 3.0 * exact(w.x) * v

    errors = []
    for count in (8, 16):
        m = to_skfem(generate(quarter_annulus(count), q))
        basis = skfem.Basis(m, lagrange_element(q))
        given = exact(basis.doflocs)
        boundary = basis.get_dofs(list(m.boundaries)).all()
        u = skfem.solve(*skfem.condense(stiffness.assemble(basis), load.assemble(basis), x=given, D=boundary))
        fine = skfem.Basis(m, lagrange_element(q), intorder=4 * q + 6)
        error = skfem.Functional(lambda w: (w.u - exact(w.x)) ** 2)
        errors.append(np.sqrt(error.assemble(fine, u=fine.interpolate(u))))
    order = np.log2(errors[0] / errors[1])
    assert q + 0.8 < order < q + 1.8, errors


def test_inverse_map_finds_points_of_strongly_curved_elements(layouts):
    structure = layouts.annulus(3)  # an element spans 120°
    m = to_skfem(generate(structure, 8))
    X = np.random.default_rng(17).uniform(size=(2, 3, 40))
    X[:, :, :4] = np.array([[0, 1, 1, 0], [0, 0, 1, 1]])[:, None]
    mapping = m.mapping()
    found = mapping.invF(mapping.F(X))
    np.testing.assert_allclose(found, X, atol=1e-12)
    with pytest.raises(ValueError, match="away from its element; expected points inside it"):
        mapping.invF(mapping.F(X) + 5.0)


@pytest.mark.parametrize("turned", [False, True])
def test_fields_can_be_probed_at_places(turned):
    mesh = generate(quarter_annulus(3), 5)
    if turned:
        mesh = turn_some(mesh, np.random.default_rng(19))
    basis = skfem.Basis(to_skfem(mesh), lagrange_element(5))
    rng = np.random.default_rng(21)
    radius, angle = rng.uniform(1.001, 1.599, 50), rng.uniform(0.001, np.pi / 2 - 0.001, 50)
    places = radius * np.stack([np.cos(angle), np.sin(angle)])
    u = basis.doflocs[0] - 3.0 * basis.doflocs[1]
    np.testing.assert_allclose(basis.probes(places) @ u, places[0] - 3.0 * places[1], atol=1e-12)
    on_the_circle = 1.6 * np.array([[np.cos(0.3)], [np.sin(0.3)]])  # a little outside the mesh
    assert basis.probes(on_the_circle) @ u == pytest.approx(on_the_circle[0] - 3.0 * on_the_circle[1], abs=1e-4)
    with pytest.raises(ValueError, match=r"place \(0\.5, 0\.0\) is outside the mesh"):
        basis.probes(np.array([[1.2, 0.5], [0.3, 0.0]]))


def test_thin_elements_keep_their_facets(layouts):
    """Boundary layers: first height 1e-5 on a coordinate of size 1."""
    structure = quarter_annulus(1, inner=1.0, outer=1.0 + 1e-5)
    m = to_skfem(generate(structure, 5))
    length = ONE.assemble(skfem.FacetBasis(m, lagrange_element(2), facets="bottom"))
    assert length == pytest.approx(1e-5, rel=1e-9)


def test_what_scikit_fem_would_do_to_the_corners_alone_is_refused():
    m = to_skfem(generate(quarter_annulus(2), 3))
    with pytest.raises(NotImplementedError, match="generate the mesh with more elements"):
        m.refined()
    for change in (lambda: m.translated((1.0, 0.0)), lambda: m.restrict([0, 1]), lambda: m.scaled(2.0)):
        with pytest.raises(ValueError, match="transform or cut the mesh in hoblock"):
            change()


def test_bad_arguments_are_named(layouts):
    mesh = generate(layouts.square(counts=2), 2)
    m = to_skfem(mesh)
    with pytest.raises(ValueError, match=r"cells have shape \(4, 9\); expected \(4, 16\) for elements of order 3"):
        node_dofs(skfem.Basis(m, lagrange_element(3)), mesh.cells)
    with pytest.raises(ValueError, match="ElementQuadP, whose degrees of freedom are no nodal values"):
        node_dofs(skfem.Basis(m, skfem.ElementQuadP(3)), mesh.cells)
    with pytest.raises(ValueError, match="order is 0"):
        lagrange_element(0)
    cells = np.array([[0, 1, 2, 3], [0, 1, 4, 5], [0, 1, 6, 7]])
    with pytest.raises(TopologyError, match="belongs to more than two"):
        to_skfem(QuadMesh(np.random.default_rng(6).normal(size=(8, 2)), cells, 1, {}, {}))
