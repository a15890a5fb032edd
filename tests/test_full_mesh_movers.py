"""The classical movers of `benchmarks/full_mesh_movers`: exact where they should be, and competent competitors."""

from __future__ import annotations

import importlib
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator

from hoblock import Bezier, BlockStructure, QuadMesh, generate
from hoblock.movers import Mover, PseudoSolid
from hoblock.quality import invalid_elements

pytest.importorskip("skfem")
pytest.importorskip("hofsi")

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
ORDERS = (1, 2, 4)

ONE_STEP = {
    "laplace": lambda m, *a, **k: m.Laplace(*a, **k),
    "laplace, area": lambda m, *a, **k: m.Laplace(*a, stiffening="area", **k),
    "elastic": lambda m, *a, **k: m.Elastic(*a, **k),
    "elastic, jacobian": lambda m, *a, **k: m.Elastic(*a, stiffening="jacobian", exponent=-2.0, **k),
    "elastic, not cached": lambda m, *a: m.Elastic(*a, cached=False),
    "biharmonic": lambda m, *a, **k: m.Biharmonic(*a, **k),
    "biharmonic, turned": lambda m, *a, **k: m.Biharmonic(*a, normals="turned", **k),
    "radial basis": lambda m, *a, **k: m.RadialBasis(*a, **k),
    "radial basis, not cached": lambda m, *a: m.RadialBasis(*a, cached=False),
    "radial basis, wendland": lambda m, *a, **k: m.RadialBasis(*a, kernel="wendland_c2", radius=3.0, **k),
    "radial basis, some centres": lambda m, *a, **k: m.RadialBasis(*a, fraction=0.5, **k),
    "inverse distance": lambda m, *a: m.InverseDistance(*a),
    "inverse distance, rotations": lambda m, *a: m.InverseDistance(*a, rotations=True),
    "macro-elements": lambda m, *a, **k: m.MacroElements(*a, **k),
}
INCREMENTAL = {
    f"{name}, incremental": lambda m, *a, make=make, **k: make(m, *a, incremental=True, **k)
    for name, make in ONE_STEP.items()
    if "not cached" not in name and "distance" not in name
}
MOVERS = {**ONE_STEP, **INCREMENTAL, "neo-hooke": lambda m, *a: m.NeoHooke(*a)}


@pytest.fixture
def movers(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("full_mesh_movers")


@pytest.fixture
def part(movers, monkeypatch):
    """A module of the package by its name."""
    return lambda name: importlib.import_module(f"full_mesh_movers.{name}")


@cache
def structure(curved: bool = True) -> BlockStructure:
    """A square body with bulging sides in a square, and two curved edges inside the mesh."""
    x = (-3.0, -1.0, 1.0, 3.0)
    vertices = {f"v{i}{j}": (x[i], x[j]) for i in range(4) for j in range(4)}
    blocks = [
        (f"v{i}{j}", f"v{i + 1}{j}", f"v{i + 1}{j + 1}", f"v{i}{j + 1}")
        for i in range(3)
        for j in range(3)
        if (i, j) != (1, 1)
    ]
    body = [("v11", "v21"), ("v21", "v22"), ("v22", "v12"), ("v12", "v11")]
    outer = [
        pair for k in range(3) for s in (0, 3) for pair in ((f"v{k}{s}", f"v{k + 1}{s}"), (f"v{s}{k}", f"v{s}{k + 1}"))
    ]
    curves = {}
    if curved:
        for first, second in (*body, ("v22", "v32"), ("v01", "v11")):
            a, b = np.array(vertices[first]), np.array(vertices[second])
            normal = np.array([(b - a)[1], (a - b)[0]])
            curves[first, second] = Bezier(np.array([a, 0.5 * (a + b) + 0.2 * normal, b]))
    return BlockStructure.build(
        vertices, {"fluid": blocks}, counts=2, edges={"body": body, "outer": outer}, curves=curves
    )


@cache
def ring(order: int, curved: bool = True) -> tuple[QuadMesh, np.ndarray, np.ndarray]:
    """Mesh, nodes on the body and nodes on the outer boundary."""
    mesh = generate(structure(curved), order)
    return mesh, mesh.edge_nodes("body"), mesh.edge_nodes("outer")


def whole_boundary(order: int, curved: bool = True) -> tuple[QuadMesh, np.ndarray, np.ndarray]:
    mesh, body, outer = ring(order, curved)
    return mesh, np.union1d(body, outer), np.zeros(0, dtype=np.int64)


def turned(points: np.ndarray, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, s], [-s, c]])


def displaced(points: np.ndarray, size: float) -> np.ndarray:
    """A motion of the body that is nothing simple: shifted, turned and bent."""
    return points + size * np.stack([0.6 + 0.3 * points[:, 1] ** 2, -0.3 + 0.5 * points[:, 0]], axis=-1)


def test_the_package_lists_what_it_has(movers):
    assert movers.__all__ == sorted(movers.__all__)
    assert all(hasattr(movers, name) for name in movers.__all__)


# What every method has to do


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", MOVERS)
def test_no_displacement_gives_the_reference(movers, name, order):
    mesh, body, outer = ring(order)
    moved = MOVERS[name](movers, mesh, body, outer).move(mesh.points, mesh.points[body])
    assert np.abs(moved - mesh.points).max() < 1e-12


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", MOVERS)
def test_translation_of_the_whole_boundary_translates_everything(movers, name, order):
    mesh, boundary, nothing = whole_boundary(order)
    shift = np.array([5.0, -0.7])
    mover = MOVERS[name](movers, mesh, boundary, nothing)
    assert np.abs(mover.move(mesh.points, mesh.points[boundary] + shift) - mesh.points - shift).max() < 1e-10


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", MOVERS)
def test_given_nodes_land_exactly(movers, name, order):
    mesh, body, outer = ring(order)
    positions = displaced(mesh.points[body], 0.1)
    current = mesh.points.copy()
    moved = MOVERS[name](movers, mesh, body, outer).move(current, positions)
    assert np.array_equal(moved[body], positions)
    assert np.array_equal(moved[outer], mesh.points[outer])
    assert np.array_equal(current, mesh.points)
    free = np.setdiff1d(np.arange(len(moved)), np.union1d(body, outer))
    assert np.abs(moved[free] - mesh.points[free]).max() > 0.02
    assert not invalid_elements(mesh.with_points(moved))


@pytest.mark.parametrize("name", ONE_STEP)
def test_one_step_results_depend_on_positions_only(movers, name):
    mesh, body, outer = ring(4)
    positions = displaced(mesh.points[body], 0.2)
    mover = ONE_STEP[name](movers, mesh, body, outer)
    first = mover.move(mesh.points, positions)
    mover.move(mesh.points, displaced(mesh.points[body], -0.2))
    elsewhere = np.random.default_rng(7).normal(size=mesh.points.shape)
    assert np.array_equal(mover.move(elsewhere, positions), first)


@pytest.mark.parametrize("name", INCREMENTAL)
def test_increments_differ_from_one_step_to_second_order(movers, name):
    mesh, body, outer = ring(2)
    at_once = ONE_STEP[name.removesuffix(", incremental")](movers, mesh, body, outer)
    mover = INCREMENTAL[name](movers, mesh, body, outer)
    differences = []
    for size in (0.01, 0.005):
        end = displaced(mesh.points[body], size)
        one = at_once.move(mesh.points, end)
        assert np.abs(mover.move(mesh.points, end) - one).max() < 1e-12  # on the reference they are the same
        half = mover.move(mesh.points, displaced(mesh.points[body], 0.5 * size))
        differences.append(np.abs(mover.move(half, end) - one).max())
    assert 1e-9 < differences[1] < 1e-4
    assert np.log2(differences[0] / differences[1]) == pytest.approx(2.0, abs=0.1)


# Patch tests


AFFINE = np.array([[1.3, 0.4], [-0.2, 0.8]])
PATCH = {
    name: make
    for name, make in MOVERS.items()
    if name.startswith(("laplace", "elastic", "radial")) and "jacobian" not in name and "not cached" not in name
}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", PATCH)
def test_affine_motions_of_the_boundary_are_reproduced(movers, name, order):
    mesh, boundary, nothing = whole_boundary(order)
    uniform = {} if name.startswith("radial") else {"exponent": 0.0}
    mover = PATCH[name](movers, mesh, boundary, nothing, **uniform)
    expected = mesh.points @ AFFINE.T + [1.0, 2.0]
    assert np.abs(mover.move(mesh.points, expected[boundary]) - expected).max() < 1e-10


@pytest.mark.parametrize("order", ORDERS)
def test_uniform_neo_hookean_solid_passes_the_patch_test(movers, order):
    mesh, boundary, nothing = whole_boundary(order)
    expected = mesh.points @ AFFINE.T
    mover = movers.NeoHooke(mesh, boundary, nothing, exponent=0.0)
    assert np.abs(mover.move(mesh.points, expected[boundary]) - expected).max() < 1e-9


@pytest.mark.parametrize("order", ORDERS)
def test_affine_motions_solve_the_mixed_biharmonic_form(movers, part, order):
    mesh, boundary, nothing = whole_boundary(order)
    sides = part("boundary_tangents").BoundaryTangents.of(mesh)
    t = sides.tangents(mesh.points)
    slope = np.stack([t.imag, -t.real], axis=-1) @ (AFFINE - np.eye(2)).T  # ∂u/∂n times the length
    load = np.zeros_like(mesh.points)
    np.add.at(load, sides.nodes, np.einsum("sqd,q,qi->sid", slope, sides.weights, sides.N))
    u = mesh.points @ (AFFINE - np.eye(2)).T
    given = np.where(np.isin(np.arange(len(u)), boundary)[:, None], u, np.nan)
    assert np.abs(movers.Biharmonic(mesh, boundary, nothing).displacement(np.nan_to_num(given), load) - u).max() < 1e-10


def test_biharmonic_polynomials_are_exact(movers, part):
    """u = (x³, x² y - y³/3 + x) are in the space and biharmonic; w = -Δu = (-6 x, 0)."""
    mesh, boundary, nothing = whole_boundary(4, curved=False)
    x, y = mesh.points.T
    u = np.stack([x**3, x**2 * y - y**3 / 3.0 + x], axis=-1)
    sides = part("boundary_tangents").BoundaryTangents.of(mesh)
    t = sides.tangents(mesh.points)
    sx, sy = np.moveaxis(np.einsum("qi,sid->sqd", sides.N, mesh.points[sides.nodes]), -1, 0)
    slope = np.stack([3.0 * sx**2 * t.imag, (2.0 * sx * sy + 1.0) * t.imag - (sx**2 - sy**2) * t.real], axis=-1)
    load = np.zeros_like(u)
    np.add.at(load, sides.nodes, np.einsum("sqd,q,qi->sid", slope, sides.weights, sides.N))
    solution = movers.Biharmonic(mesh, boundary, nothing).displacement(u, load)
    assert np.abs(solution - u).max() < 1e-10 * np.abs(u).max()


TURNING = {
    "biharmonic, turned": True,
    "biharmonic": False,
    "inverse distance, rotations": True,
    "inverse distance": False,
    "radial basis": True,
    "neo-hooke": True,
}


@pytest.mark.parametrize("name", TURNING)
def test_who_reproduces_rotations_of_the_boundary(movers, name):
    mesh, boundary, nothing = whole_boundary(2)
    expected = turned(mesh.points, 40.0)
    moved = MOVERS[name](movers, mesh, boundary, nothing).move(mesh.points, expected[boundary])
    assert bool(np.abs(moved - expected).max() < 1e-9) is TURNING[name]


def test_macro_elements_reproduce_affine_motions_on_straight_elements(movers):
    mesh, boundary, nothing = whole_boundary(4, curved=False)
    expected = mesh.points @ AFFINE.T
    mover = movers.MacroElements(mesh, boundary, nothing, exponent=0.0)
    assert np.abs(mover.move(mesh.points, expected[boundary]) - expected).max() < 1e-12


# Against other programs and formulas


@pytest.mark.parametrize("order", [1, 4])
def test_laplace_and_elastic_solve_the_equations_of_scikit_fem(movers, order):
    import skfem
    from skfem.helpers import ddot, grad, sym_grad, trace

    from hoblock.io.skfem import lagrange_element, node_dofs, to_skfem

    mesh, body, outer = ring(order)
    positions = displaced(mesh.points[body], 0.3)
    given = np.union1d(body, outer)
    basis = skfem.Basis(to_skfem(mesh), skfem.ElementVector(lagrange_element(order)), intorder=2 * order + 1)
    dofs = node_dofs(basis, mesh.cells)
    u = np.zeros(basis.N)
    u[dofs[body]] = positions - mesh.points[body]
    lam, mu = 0.3 / (1.3 * 0.4), 0.5 / 1.3
    for forms, make in (
        (lambda u, v, w: ddot(grad(u), grad(v)), movers.Laplace),
        (
            lambda u, v, w: lam * trace(grad(u)) * trace(grad(v)) + 2.0 * mu * ddot(sym_grad(u), sym_grad(v)),
            movers.Elastic,
        ),
    ):
        A = skfem.BilinearForm(forms).assemble(basis)
        solution = skfem.solve(*skfem.condense(A, x=u, D=dofs[given].ravel()))
        moved = make(mesh, body, outer, exponent=0.0).move(mesh.points, positions)
        assert np.abs(moved - mesh.points - solution[dofs]).max() < 1e-11


@pytest.mark.parametrize("kernel", ["thin_plate_spline", "cubic"])
def test_radial_basis_is_that_of_scipy(movers, kernel):
    mesh, body, outer = ring(2)
    boundary = np.concatenate([body, outer])
    positions = displaced(mesh.points[body], 0.3)
    data = np.concatenate([positions - mesh.points[body], np.zeros((len(outer), 2))])
    expected = mesh.points + RBFInterpolator(mesh.points[boundary], data, kernel=kernel, degree=1)(mesh.points)
    moved = movers.RadialBasis(mesh, body, outer, kernel=kernel).move(mesh.points, positions)
    assert np.abs(moved - expected).max() < 1e-11


def test_some_centres_are_spread_evenly(part):
    points = np.stack([np.linspace(0.0, 1.0, 101), np.zeros(101)], axis=-1)
    chosen = part("radial_basis").thinned(np.arange(101), points, 0.05)
    assert np.array_equal(chosen, [0, 25, 50, 75, 100])


def test_inverse_distance_is_the_weighted_mean(movers):
    mesh, body, outer = ring(2)
    positions = displaced(mesh.points[body], 0.3)
    moved = movers.InverseDistance(mesh, body, outer, exponent=2.5).move(mesh.points, positions)
    node = int(np.setdiff1d(np.arange(len(mesh.points)), np.union1d(body, outer))[17])
    weight = {k: np.hypot(*(mesh.points[k] - mesh.points[node])) ** -2.5 for k in (*body, *outer)}
    mean = sum(weight[k] * (positions[i] - mesh.points[k]) for i, k in enumerate(body)) / sum(weight.values())
    assert np.allclose(moved[node], mesh.points[node] + mean, rtol=0.0, atol=1e-13)


def test_macro_elements_of_order_one_are_elastic(movers):
    mesh, body, outer = ring(1)
    positions = displaced(mesh.points[body], 0.3)
    expected = movers.Elastic(mesh, body, outer).move(mesh.points, positions)
    assert np.abs(movers.MacroElements(mesh, body, outer).move(mesh.points, positions) - expected).max() < 1e-13


def test_macro_elements_blend_the_displacement(movers):
    mesh, body, outer = ring(4)
    positions = displaced(mesh.points[body], 0.3)
    u = (movers.MacroElements(mesh, body, outer).move(mesh.points, positions) - mesh.points)[mesh.cells]
    u = u.reshape(-1, 5, 5, 2)
    inner = ~np.isin(mesh.cells, np.union1d(body, outer)).reshape(-1, 5, 5)
    sides = inner[:, 0, 2]  # first sides inside the mesh
    assert sides.any()
    assert np.abs(u[sides, 0, 2] - 0.5 * (u[sides, 0, 0] + u[sides, 0, -1])).max() < 1e-13
    middle = 0.5 * (u[:, 0, 2] + u[:, -1, 2] + u[:, 2, 0] + u[:, 2, -1])
    corners = 0.25 * (u[:, 0, 0] + u[:, 0, -1] + u[:, -1, 0] + u[:, -1, -1])
    assert np.abs(u[:, 2, 2] - middle + corners).max() < 1e-13


@pytest.mark.parametrize("order", [1, 4])
def test_distance_from_a_square(part, order):
    mesh, body, _ = ring(order, curved=False)
    elements = part("elements").Elements.of(mesh)
    stiffening = part("stiffening").Stiffening.of(mesh, body, "distance", 1.0)
    found = stiffening.factor(elements, elements.geometry(mesh.points), mesh.points)
    x = np.abs(elements.N @ mesh.points[elements.cells])
    expected = np.hypot(*np.maximum(x - 1.0, 0.0).transpose(2, 0, 1))
    assert np.abs(found - expected / expected.max()).max() < 1e-12
    lobatto = part("elements").Elements.of(mesh, 7)
    assert not lobatto.inside.all()
    assert stiffening.factor(lobatto, lobatto.geometry(mesh.points), mesh.points).min() > 0.0


def test_exponent_minus_one_drops_the_jacobian(part):
    mesh, body, _ = ring(4)
    elements = part("elements").Elements.of(mesh)
    geometry = elements.geometry(mesh.points)
    for kind, size in (("jacobian", geometry.det_J), ("area", geometry.weights.sum(axis=1, keepdims=True))):
        k = part("stiffening").Stiffening.of(mesh, body, kind, -1.0).factor(elements, geometry, mesh.points)
        assert np.ptp(k * size) < 1e-12 * size.max()
        assert np.ptp(k) > 0.1


@pytest.mark.parametrize("name", ["elastic", "radial basis"])
def test_results_do_not_depend_on_what_is_cached(movers, name):
    mesh, body, outer = ring(4)
    positions = displaced(mesh.points[body], 0.3)
    cached, fresh = (
        ONE_STEP[kind](movers, mesh, body, outer).move(mesh.points, positions) for kind in (name, f"{name}, not cached")
    )
    assert np.abs(cached - fresh).max() < 1e-12


# Neo-Hooke


def test_neo_hookean_stress_and_moduli_are_derivatives(part):
    law = part("neo_hookean_law")
    F = np.eye(2)[:, :, None, None] + 0.4 * np.random.default_rng(11).uniform(-1.0, 1.0, (2, 2, 3, 5))
    h, lame = 1e-6, (0.6, 0.4)
    A, P = law.moduli(F, *lame), law.stress(F, *lame)
    for b in range(2):
        for C in range(2):
            step = np.zeros((2, 2, 1, 1))
            step[b, C] = h
            assert np.abs((law.energy(F + step, *lame) - law.energy(F - step, *lame)) / (2 * h) - P[b, C]).max() < 1e-7
            slope = (law.stress(F + step, *lame) - law.stress(F - step, *lame)) / (2 * h)
            assert np.abs(slope - A[:, :, b, C]).max() < 1e-7


def test_line_search_of_neo_hooke(movers):
    mesh, body, outer = ring(2)
    mover = movers.NeoHooke(mesh, body, outer)
    free = np.setdiff1d(np.arange(len(mesh.points)), np.union1d(body, outer))
    equilibrium = mover.move(mesh.points, displaced(mesh.points[body], 0.4))
    bump = np.zeros_like(mesh.points)
    bump[free] = 0.02 * np.random.default_rng(3).uniform(-1.0, 1.0, (len(free), 2))
    disturbed = equilibrium + bump
    assert mover._line_search(disturbed, -bump) == 1.0
    assert mover._line_search(disturbed, bump) == 0.0  # uphill
    fraction = mover._line_search(disturbed, -100.0 * bump)  # through elements that are turned over
    assert mover._energy(disturbed - 100.0 * bump) == np.inf
    assert 0.0 < fraction < 0.1
    assert mover._energy(equilibrium) < mover._energy(disturbed - 100.0 * fraction * bump) < mover._energy(disturbed)


def test_neo_hooke_is_elastic_for_small_displacements(movers):
    mesh, body, outer = ring(2, curved=False)  # where quadrature is exact, so that there is no other difference
    hyper, linear = (make(mesh, body, outer, stiffening="area") for make in (movers.NeoHooke, movers.Elastic))
    differences = []
    for size in (0.02, 0.01):
        positions = displaced(mesh.points[body], size)
        differences.append(np.abs(hyper.move(mesh.points, positions) - linear.move(mesh.points, positions)).max())
    assert differences[1] > 1e-8
    assert np.log2(differences[0] / differences[1]) == pytest.approx(2.0, abs=0.15)


def test_neo_hooke_survives_a_compression_that_turns_elastic_elements_over(movers):
    mesh, body, outer = ring(4)
    positions = mesh.points[body] + [1.35, 0.0]
    linear = movers.Elastic(mesh, body, outer).move(mesh.points, positions)
    hyper = movers.NeoHooke(mesh, body, outer, exponent=-1.0).move(mesh.points, positions)
    assert invalid_elements(mesh.with_points(linear))
    assert not invalid_elements(mesh.with_points(hyper))


def test_neo_hooke_does_not_depend_on_its_start(movers):
    mesh, body, outer = ring(2)
    mover = movers.NeoHooke(mesh, body, outer)
    positions = turned(mesh.points[body], 50.0)
    at_once = mover.move(mesh.points, positions)
    x = mover.move(mesh.points, mesh.points[body] + [0.5, -0.4])
    x = mover.move(x, turned(mesh.points[body], 25.0))
    assert np.abs(mover.move(x, positions) - at_once).max() < 1e-9
    upside_down = mesh.points @ np.diag([1.0, -1.0])
    assert np.abs(mover.move(upside_down, positions) - at_once).max() < 1e-9


def test_neo_hooke_says_that_there_is_no_mesh(movers):
    mesh, body, outer = ring(1)
    with pytest.raises(movers.MotionFailed, match=r"neo-Hooke: no equilibrium beyond 0\.\d+ of the way"):
        movers.NeoHooke(mesh, body, outer).move(mesh.points, mesh.points[body] + [2.5, 0.0])


# Block vertices


@pytest.mark.parametrize("method", ["rbf", "idw"])
def test_interpolated_vertices_are_a_mover(movers, method):
    blocks = layered()
    driven = np.unique(blocks.topology.edges[blocks.topology.edge_groups["body"]])
    mover: Mover = movers.InterpolatedVertices(blocks, driven, method)
    solid = PseudoSolid(blocks, driven)
    assert np.array_equal(mover.driven, solid.driven)
    assert np.array_equal(mover.free, solid.free)
    assert mover.free.size
    positions = displaced(blocks.vertices[driven], 0.3)
    moved = mover.move(np.full_like(blocks.vertices, np.nan), positions)
    assert np.array_equal(moved[driven], positions)
    fixed = np.setdiff1d(np.arange(len(moved)), np.union1d(driven, mover.free))
    assert np.array_equal(moved[fixed], blocks.vertices[fixed])
    assert 0.01 < np.abs(moved - blocks.vertices)[mover.free].max() < 0.5
    assert np.abs(mover.move(moved, blocks.vertices[driven]) - blocks.vertices).max() == 0.0
    whole = movers.InterpolatedVertices(blocks, blocks.topology.boundary_vertices, method)
    shifted = whole.move(moved, blocks.vertices[whole.driven] + [3.0, 4.0])
    assert np.abs(shifted - blocks.vertices - [3.0, 4.0]).max() < 1e-12
    expected = blocks.vertices @ AFFINE.T
    error = np.abs(whole.move(moved, expected[whole.driven]) - expected).max()
    assert bool(error < 1e-12) is (method == "rbf")


@cache
def layered() -> BlockStructure:
    """Two layers of blocks around a square."""
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    vertices = np.concatenate([corners, 1.7 * corners + [0.2, 0.1], 3.0 * corners])
    blocks = [
        (4 * i + k, 4 * i + (k + 1) % 4, 4 * i + 4 + (k + 1) % 4, 4 * i + 4 + k) for i in (0, 1) for k in range(4)
    ]
    body = [(k, (k + 1) % 4) for k in range(4)]
    return BlockStructure.build(vertices, [block[::-1] for block in blocks], edges={"body": body})


# Errors


def test_incremental_methods_need_a_valid_mesh(movers):
    mesh, body, outer = ring(2)
    current = mesh.points @ np.diag([1.0, -1.0])
    for make in (movers.Laplace, movers.Elastic, movers.Biharmonic, movers.MacroElements):
        with pytest.raises(movers.MotionFailed, match="det J = -"):
            make(mesh, body, outer, incremental=True).move(current, mesh.points[body])
    with pytest.raises(movers.MotionFailed, match="two in one place"):
        movers.RadialBasis(mesh, body, outer, incremental=True).move(np.zeros_like(current), mesh.points[body])


@pytest.mark.parametrize("name", MOVERS)
def test_bad_nodes_and_positions(movers, name):
    mesh, body, outer = ring(2)
    make = MOVERS[name]
    with pytest.raises(ValueError, match="both moving and fixed"):
        make(movers, mesh, body, np.union1d(body[:1], outer))
    with pytest.raises(ValueError, match="on the boundary, but neither moving nor fixed"):
        make(movers, mesh, body, outer[1:])
    with pytest.raises(ValueError, match="moving: expected ascending node numbers"):
        make(movers, mesh, body[::-1], outer)
    with pytest.raises(ValueError, match="fixed: array of shape"):
        make(movers, mesh, body, outer.astype(float))
    mover = make(movers, mesh, body, outer)
    with pytest.raises(ValueError, match="positions has shape"):
        mover.move(mesh.points, mesh.points)
    positions = mesh.points[body].copy()
    positions[3, 1] = np.nan
    with pytest.raises(ValueError, match=r"positions\[3\] is"):
        mover.move(mesh.points, positions)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda m, *a: m.Laplace(*a, stiffening="size"), "stiffening is 'size'"),
        (lambda m, *a: m.Elastic(*a, exponent=np.inf), "exponent is inf"),
        (lambda m, *a: m.Elastic(*a, poissons_ratio=0.5), "poissons_ratio is 0.5"),
        (lambda m, *a: m.NeoHooke(*a, poissons_ratio=-1.0), "poissons_ratio is -1"),
        (lambda m, *a: m.NeoHooke(*a, points=2), "points is 2"),
        (lambda m, *a: m.Biharmonic(*a, normals="free"), "normals is 'free'"),
        (lambda m, *a: m.RadialBasis(*a, kernel="gaussian"), "kernel is 'gaussian'"),
        (lambda m, *a: m.RadialBasis(*a, degree=0), "degree is 0"),
        (lambda m, *a: m.RadialBasis(*a, kernel="wendland_c2", radius=0.0), "radius is 0"),
        (lambda m, *a: m.RadialBasis(*a, fraction=0.0), "fraction is 0"),
        (lambda m, *a: m.InverseDistance(*a, exponent=0.0), "exponent is 0"),
    ],
)
def test_bad_parameters(movers, make, match):
    with pytest.raises(ValueError, match=match):
        make(movers, *ring(1))


def test_given_nodes_inside_elements(movers):
    mesh, body, outer = ring(2)
    inside = np.union1d(body, [mesh.cells[0, 4]])
    with pytest.raises(ValueError, match="inside an element"):
        movers.Elastic(mesh, inside, outer)


def test_bad_vertices(movers):
    blocks = layered()
    with pytest.raises(ValueError, match="ascending numbers of vertices"):
        movers.InterpolatedVertices(blocks, np.array([1, 0]))
    with pytest.raises(ValueError, match="method is 'spline'"):
        movers.InterpolatedVertices(blocks, np.arange(4), "spline")
    with pytest.raises(ValueError, match="finite positions of shape"):
        movers.InterpolatedVertices(blocks, np.arange(4)).move(blocks.vertices, np.full((4, 2), np.inf))
