"""Neo-Hookean solids against closed forms, other discretisations and other laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from hoblock import BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.errors import NewtonError
from hofsi.fem.assembly import MatrixPattern
from hofsi.fem.element import element_table
from hofsi.solvers.solid import SolidSolver, SolidState
from hofsi.solvers.solid_equations import SolidEquations

E, NU, RHO = 210.0, 0.3, 4.0
LAME, MU = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))
AROUND = ("bottom", "right", "top", "left")
PLANES = pytest.mark.parametrize("plane", ["strain", "stress"])


def expression(text):
    return compile_expression(str(text), ("x", "y", "t"))


def displacement(on, x=None, y=None):
    components = (None if c is None else expression(c) for c in (x, y))
    return case.Displacement((on,) if isinstance(on, str) else on, *components)


def traction(on, x, y):
    return case.Traction((on,), expression(x), expression(y))


def bent(points):
    x, y = points.T
    return np.stack([x + 0.08 * np.sin(2.1 * y + 0.3) * (1 + x), y + 0.1 * x**2 - 0.06 * np.cos(1.7 * x) * y], axis=-1)


def rectangle(order, columns=2, rows=2, size=(1.0, 1.0), shape=None):
    """Two blocks side by side, "first" and "second"."""
    w, h = size
    corners = [(0.0, 0.0), (w / 2, 0.0), (w, 0.0), (w, h), (w / 2, h), (0.0, h)]
    blocks = {"first": [(0, 1, 4, 5)], "second": [(1, 2, 3, 4)]}
    edges = {"bottom": [(0, 1), (1, 2)], "right": [(2, 3)], "top": [(3, 4), (4, 5)], "left": [(5, 0)]}
    counts = {(0, 1): columns, (1, 2): columns, (0, 5): rows}
    mesh = generate(BlockStructure.build(corners, blocks, counts=counts, edges=edges), order)
    return mesh if shape is None else mesh.with_points(shape(mesh.points))


def solid(boundaries=(), blocks=("first", "second"), **changes):
    return replace(case.Solid("block", RHO, E, NU, blocks, tuple(boundaries), model="neo-hooke"), **changes)


def solver(mesh, boundaries, tolerance=1e-11, **changes):
    return SolidSolver(mesh, [solid(boundaries, **changes)], case.NonlinearSettings(tolerance, 25))


def equilibrium(s):
    return s.begin_static().solve()


def stretched(stretch, plane):
    """Lateral stretch and first stress in uniaxial tension."""
    thick = 2.0 if plane == "stress" else 1.0  # how many directions shrink
    a = brentq(lambda a: MU * (a**2 - 1.0) + LAME * np.log(stretch * a**thick), 1e-3, 1e3, xtol=1e-15)
    return a, MU * (stretch - 1.0 / stretch) + LAME * np.log(stretch * a**thick) / stretch


@PLANES
@pytest.mark.parametrize("stretch", [0.4, 1.3, 2.5])
def test_uniaxial_tension_and_compression(plane, stretch):
    across, load = stretched(stretch, plane)
    mesh = rectangle(2, 1, 1, (2.0, 1.0))
    s = solver(mesh, [case.Roller(("left",)), case.Roller(("bottom",)), traction("right", load, 0)], plane=plane)
    np.testing.assert_allclose(equilibrium(s), mesh.points * [stretch - 1.0, across - 1.0], atol=1e-10)


@PLANES
def test_simple_shear_needs_the_exact_reactions(plane):
    """No volume changes, so that both plane cases are the same: P = μ (F - F⁻ᵀ)."""
    g = 0.7
    mesh = rectangle(3, 1, 1)
    step = solver(mesh, [displacement(AROUND, f"{g}*y", 0)], plane=plane).begin_static()
    reaction = step.reaction(step.solve())
    top = mesh.edge_nodes("top")
    inner = np.setdiff1d(top, np.union1d(mesh.edge_nodes("left"), mesh.edge_nodes("right")))
    shared = np.abs(mesh.points[inner, 0] - 0.5) < 1e-12  # by both elements of half a unit each
    per_node = np.where(shared, 2.0, 5.0) / 24.0  # GLL weights 1/6, 5/6, 5/6, 1/6 on [-1, 1]
    np.testing.assert_allclose(reaction[inner], per_node[:, None] * [[MU * g, 0.0]], atol=1e-10)
    np.testing.assert_allclose(reaction.sum(axis=0), 0.0, atol=1e-10)


@PLANES
@pytest.mark.parametrize("order", [1, 2, 5])
def test_patch_of_distorted_elements_reproduces_a_large_homogeneous_deformation(order, plane):
    mesh = rectangle(order, 2, 2, shape=bent)
    s = solver(mesh, [displacement(AROUND, "0.5*x - 0.4*y", "0.3*x - 0.35*y")], plane=plane)
    np.testing.assert_allclose(equilibrium(s), mesh.points @ [[0.5, 0.3], [-0.4, -0.35]], atol=1e-10)


@PLANES
@pytest.mark.parametrize("order", [1, 2, 3])
def test_error_falls_with_order_plus_one(order, plane):
    """Manufactured solution with strains of 45 %; its loads are imposed in weak form."""
    errors = []
    N = element_table(order, order + 2).N
    for elements in (2, 4):
        mesh = rectangle(order, elements, 2 * elements, shape=bent)
        s = solver(mesh, [displacement(AROUND, "0.15*sin(3*x + y)", "0.15*cos(2*y - x)*x")], plane=plane)
        x, y = np.moveaxis(np.einsum("qi,eid->eqd", N, mesh.coordinates), -1, 0)
        rows = [
            [3.0 * np.cos(3 * x + y), np.cos(3 * x + y)],
            [np.cos(2 * y - x) + x * np.sin(2 * y - x), -2.0 * x * np.sin(2 * y - x)],
        ]
        H = 0.15 * np.moveaxis(np.array(rows), (0, 1), (2, 3))
        d = s.begin_static().solve(s.equations.internal_force(H, s.equations.stress(H)))
        exact = 0.15 * np.stack([np.sin(3 * x + y), np.cos(2 * y - x) * x], axis=-1)
        errors.append(np.sqrt(np.mean((np.einsum("qi,eid->eqd", N, d[mesh.cells]) - exact) ** 2)))
    assert errors[1] < 1e-2
    assert np.log2(errors[0] / errors[1]) > order + 0.7


@PLANES
def test_small_loads_are_those_of_linear_elasticity(plane):
    mesh = rectangle(3, 2, 2, shape=bent)
    boundaries = [displacement("left", 0, 0), traction("right", "1e-6", "2e-6*y")]
    found, linear = (
        equilibrium(solver(mesh, boundaries, model=model, plane=plane)) for model in ("neo-hooke", "linear")
    )
    np.testing.assert_allclose(found, linear, atol=1e-6 * np.abs(linear).max())


def test_internal_force_agrees_with_scikit_fem():
    """On the same biquadratic elements with the same 4 × 4 Gauss points."""
    skfem = pytest.importorskip("skfem")
    mesh = rectangle(2, 1, 2, shape=bent)
    straight = skfem.MeshQuad2.from_mesh(skfem.MeshQuad.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 1, 3)))
    element = skfem.ElementVector(skfem.ElementQuad2())
    where = bent(skfem.Basis(straight, element, intorder=7).doflocs.T)
    basis = skfem.Basis(replace(straight, doflocs=bent(straight.doflocs.T).T), element, intorder=7)
    nodes = np.abs(where[:, None] - mesh.points[None]).sum(axis=-1).argmin(axis=1)
    component = np.zeros(len(nodes), dtype=int)
    for node in np.unique(nodes):
        component[np.flatnonzero(nodes == node)] = [0, 1]
    mine = 2 * nodes + component
    d = 0.02 * np.random.default_rng(61).standard_normal(mesh.points.shape)

    def form(v, w):
        F = np.moveaxis(w.u.grad + np.eye(2)[:, :, None, None], (0, 1), (-2, -1))
        inverse, J = np.linalg.inv(F).swapaxes(-1, -2), np.linalg.det(F)
        P = MU * (F - inverse) + (LAME * np.log(J))[..., None, None] * inverse
        return np.sum(np.moveaxis(P, (-2, -1), (0, 1)) * v.grad, axis=(0, 1))

    b = skfem.LinearForm(form).assemble(basis, u=basis.interpolate(d.ravel()[mine]))
    expected = np.zeros(len(b))
    expected[mine] = b
    equations = SolidEquations(mesh, [solid()])
    H = equations.gradient(d)
    found = equations.internal_force(H, equations.stress(H)).ravel()
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


@PLANES
def test_newton_converges_quadratically(plane):
    mesh = rectangle(2, 2, 2, shape=bent)
    equations = SolidEquations(mesh, [solid(plane=plane)])
    free = np.setdiff1d(np.arange(2 * len(mesh.points)), 2 * mesh.edge_nodes("left")[:, None] + [0, 1])
    load = np.zeros(mesh.points.shape)
    load[mesh.edge_nodes("right")] = [4.0, -2.0]
    pattern, d, norms = MatrixPattern(equations.dofs, load.size), np.zeros(mesh.points.shape), []
    for _ in range(12):
        H = equations.gradient(d)
        S = equations.stress(H)
        residual = (equations.internal_force(H, S) - load).ravel()[free]
        norms.append(np.linalg.norm(residual))
        K = pattern.matrix(equations.tangent(H, S, 0.0, [])).toarray()[np.ix_(free, free)]
        d.ravel()[free] -= np.linalg.solve(K, residual)
    assert np.abs(d).max() > 0.1
    last = next(k for k, norm in enumerate(norms) if norm < 1e-5 * norms[0])
    assert norms[last + 1] < 1e-8 * norms[0]
    assert norms[last + 2] < 1e-12 * norms[0]


# Strong deformation


def uniaxial_strain(stretch):
    """First stress where nothing moves across."""
    return MU * (stretch - 1.0 / stretch) + LAME * np.log(stretch) / stretch


def test_strong_compression_where_st_venant_kirchhoff_collapses():
    """P of the latter has its extremum at 1/√3 of the length; this law bears any load."""
    mesh = rectangle(2, 2, 2)
    boundaries = [case.Roller(("left",)), displacement(("bottom", "top"), None, 0)]
    pushed = [*boundaries, traction("right", uniaxial_strain(0.2), 0)]
    s = solver(mesh, pushed)
    step = s.begin_static()
    d = step.accept(step.solve()).displacement
    np.testing.assert_allclose(d, mesh.points * [-0.8, 0.0], atol=1e-8)
    other = solver(mesh, pushed, model="st-venant-kirchhoff").begin_static()
    with pytest.raises(NewtonError):
        other.accept(other.solve())


@pytest.mark.parametrize("stretch", [0.5, 0.1])
def test_increments_that_would_invert_elements_are_shortened(stretch, monkeypatch):
    mesh = rectangle(2, 2, 2)
    boundaries = [case.Roller(("left",)), displacement(("bottom", "top"), None, 0)]
    s = solver(mesh, [*boundaries, traction("right", uniaxial_strain(stretch), 0)])
    step = s.begin_static()
    seen = []
    evaluated = step._newton._at
    monkeypatch.setattr(step._newton, "_at", lambda *given: seen.append(evaluated(*given)) or seen[-1])
    d = step._newton.solve(step.state.displacement, s.equations.loads.dead(0.0), 1e-11)
    np.testing.assert_allclose(d, mesh.points * [stretch - 1.0, 0.0], atol=1e-8)
    assert not all(point.finite for point in seen)
    assert s.counts.iterations <= 20


def test_prescribed_movement_that_inverts_elements_is_applied_in_parts():
    """The first increment takes the linear answer: the soft half is turned over by the movement of its end."""
    mesh = rectangle(2, 2, 2, (2.0, 1.0))
    pushed = (displacement(("right",), -1.6, 0), displacement(("bottom", "top"), None, 0))
    pair = [
        solid((displacement("left", 0, 0), displacement(("bottom", "top"), None, 0)), ("first",)),
        solid(pushed, ("second",), name="hard", youngs_modulus=20.0 * E),
    ]
    s = SolidSolver(mesh, pair, case.NonlinearSettings(1e-11, 25))
    step = s.begin_static()
    with pytest.raises(NewtonError, match="residual is not finite") as caught:
        step._newton.solve(step.state.displacement, s.equations.loads.dead(0.0), 1e-11)
    assert caught.value.reason == "diverged"
    d = step.accept(step.solve()).displacement
    middle = d[np.abs(mesh.points[:, 0] - 1.0) < 1e-12, 0]
    first, second = 1.0 + middle.mean(), 1.0 - 1.6 - middle.mean()
    assert uniaxial_strain(first) == pytest.approx(20.0 * uniaxial_strain(second), rel=1e-8)


def test_inverted_state_is_an_error_not_a_nan():
    mesh = rectangle(1, 1, 1)
    s = solver(mesh, [displacement("left", 0, 0)])
    inverted = SolidState((mesh.points * [-1.5, 0.0],), (np.zeros(mesh.points.shape),), 0.0)
    with pytest.raises(NewtonError, match="not finite"):
        s.begin_step(inverted, [0.1], 0.1).solve()


@PLANES
def test_thin_plate_is_bent_far_as_a_st_venant_kirchhoff_one(plane):
    """Large rotations, small strains: the laws agree; one static step, then motion with as many iterations."""
    mesh = rectangle(4, 4, 1, (4.0, 0.06))
    tip = int(np.argmax(mesh.points.sum(axis=1)))
    material = {"density": 0.1, "youngs_modulus": 2.5e6, "poissons_ratio": 0.35, "plane": plane}
    load = {"body_force": (expression(0), expression(-100))}
    tips, iterations = [], []
    for model in ("st-venant-kirchhoff", "neo-hooke"):
        s = solver(mesh, [displacement("left", 0, 0)], 1e-10, model=model, **material, **load)
        tips.append(equilibrium(s)[tip])
        state, before = s.initial_state(), s.counts.iterations
        for k in range(8):
            step = s.begin_step(state, [0.02, 0.02], 0.02 * (k + 1))
            state = step.accept(step.solve(guess=state.displacement + 0.02 * state.velocity))
        iterations.append(s.counts.iterations - before)
    assert tips[0][1] < -2.0
    np.testing.assert_allclose(tips[1], tips[0], rtol=1e-3)
    assert iterations[1] < 1.3 * iterations[0]


# Several laws on one mesh


LAWS = ({"model": "neo-hooke", "plane": "stress"}, {"model": "st-venant-kirchhoff"})


@pytest.mark.parametrize("ratio", [0.3, 0.49, 0.4999, 0.49999])
def test_nearly_incompressible_bars_are_bent_in_as_few_iterations(ratio):
    """By more than half of its length at once: the pressure that rotations leave behind on the way must not count."""
    mesh = rectangle(4, 5, 2, size=(1.0, 0.1))
    s = solver(
        mesh, [displacement("left", 0, 0), traction("right", 0, 0.9)], youngs_modulus=210.0, poissons_ratio=ratio
    )
    tip = equilibrium(s)[mesh.edge_nodes("right"), 1].mean()
    assert 0.5 < tip < 0.75
    assert s.counts.iterations <= 16


@pytest.mark.parametrize("first", [*LAWS, {"model": "neo-hooke"}, {"model": "linear"}])
@pytest.mark.parametrize("second", LAWS)
def test_every_element_obeys_its_own_law(first, second):
    """Also where the elements of a law are no range of numbers."""
    rng = np.random.default_rng(62)
    mesh = rectangle(2, 2, 2, shape=bent)
    shuffled = mesh.cells[rng.permutation(len(mesh.cells))]
    d = 0.05 * rng.standard_normal(mesh.points.shape)
    for cells in (mesh.cells, shuffled):
        at_left = np.flatnonzero(mesh.points[cells].mean(axis=1)[:, 0] < 0.55)
        groups = {"first": at_left, "second": np.setdiff1d(np.arange(len(cells)), at_left)}
        own = replace(mesh, cells=cells, cell_groups=groups, edge_groups={})
        both = SolidEquations(own, [solid(blocks=("first",), **first), solid(blocks=("second",), **second)])
        H = both.gradient(d)
        S = both.stress(H)
        K, mean = both.tangent(H, S, 3.0, []), both.mean_stress(H, 0.5 * H)
        linear = both.linearised_stress(0.5 * H, S, 0.5 * H, S, 0.9 * S)
        for name, law in (("first", first), ("second", second)):
            alone = SolidEquations(own, [solid(**law)])
            part = groups[name]
            np.testing.assert_allclose(S[part], alone.stress(H)[part], atol=1e-12)
            np.testing.assert_allclose(mean[part], alone.mean_stress(H, 0.5 * H)[part], atol=1e-12)
            expected = alone.linearised_stress(0.5 * H, S, 0.5 * H, S, 0.9 * S)
            np.testing.assert_allclose(linear[part], expected[part], atol=1e-11)
            np.testing.assert_allclose(K[part], alone.tangent(H, S, 3.0, [])[part], atol=1e-10)
            table = element_table(2, 3)
            for element in part.tolist():
                found, one = (equations.first_stress(d, element, table) for equations in (both, alone))
                np.testing.assert_allclose(found, one, atol=1e-11)


def test_bar_of_two_laws_divides_its_elongation():
    """Without lateral contraction: P = μ (l - 1/l) on the one side, E l (l² - 1)/2 on the other."""
    mesh = rectangle(2, 1, 2, (2.0, 1.0))
    load = 30.0
    held = (case.Roller(("left",)), case.Roller(("bottom",)))
    pulled = (case.Roller(("bottom",)), traction("right", load, 0))
    pair = [
        solid(held, ("first",), poissons_ratio=0.0),
        solid(pulled, ("second",), name="other", poissons_ratio=0.0, model="st-venant-kirchhoff"),
    ]
    step = SolidSolver(mesh, pair, case.NonlinearSettings(1e-12, 25)).begin_static()
    d = step.solve()
    first = brentq(lambda l: 0.5 * E * (l - 1.0 / l) - load, 1.0, 3.0, xtol=1e-15)
    second = brentq(lambda l: 0.5 * E * l * (l**2 - 1.0) - load, 1.0, 3.0, xtol=1e-15)
    x = mesh.points[:, 0]
    exact = np.where(x < 1.0, (first - 1.0) * x, first - 1.0 + (second - 1.0) * (x - 1.0))
    np.testing.assert_allclose(d, np.stack([exact, 0.0 * x], axis=-1), atol=1e-10)
    np.testing.assert_allclose(step.reaction(d).sum(axis=0), [-load, 0.0], atol=1e-8)


def test_bent_block_of_two_laws_is_in_equilibrium_with_its_supports():
    mesh = rectangle(3, 2, 2, (2.0, 1.0))
    pair = [
        solid((displacement("left", 0, 0), case.Pressure(("top",), expression(5))), ("first",), plane="stress"),
        solid((case.Pressure(("top",), expression(5)),), ("second",), name="other", model="st-venant-kirchhoff"),
    ]
    step = SolidSolver(mesh, pair, case.NonlinearSettings(1e-11, 25)).begin_static()
    d = step.solve()
    x, top = mesh.points + d, mesh.edge_nodes("top")
    first, last = x[top[np.argmin(mesh.points[top, 0])]], x[top[np.argmax(mesh.points[top, 0])]]
    pushed = 5.0 * np.array([last[1] - first[1], first[0] - last[0]])
    np.testing.assert_allclose(step.reaction(d).sum(axis=0), -pushed, atol=1e-7)
    assert d[:, 1].min() < -0.3
