from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.errors import CaseError
from hofsi.fem.assembly import MatrixPattern
from hofsi.solvers.solid_equations import SolidEquations

E, NU, RHO = 210.0, 0.3, 4.0
LAME, MU = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))


def bent(points):
    x, y = points.T
    return np.stack([x + 0.08 * np.sin(2.1 * y + 0.3) * (1 + x), y + 0.1 * x**2 - 0.06 * np.cos(1.7 * x) * y], axis=-1)


def mesh_of(order, columns=3, rows=2, shape=bent):
    """Two blocks side by side, "left_half" and "right_half", bent."""
    vertices = {"a": (0.0, 0.0), "b": (0.5, 0.0), "c": (1.0, 0.0), "d": (1.0, 1.0), "e": (0.5, 1.0), "f": (0.0, 1.0)}
    blocks = {"left_half": [("a", "b", "e", "f")], "right_half": [("b", "c", "d", "e")]}
    edges = {
        "bottom": [("a", "b"), ("b", "c")],
        "right": [("c", "d")],
        "top": [("d", "e"), ("e", "f")],
        "left": [("f", "a")],
    }
    counts = {("a", "b"): columns, ("b", "c"): columns, ("a", "f"): rows}
    mesh = generate(BlockStructure.build(vertices, blocks, counts=counts, edges=edges), order)
    return mesh.with_points(shape(mesh.points))


def expression(text):
    return compile_expression(text, ("x", "y", "t"))


def solid(blocks=("left_half", "right_half"), boundaries=(), **changes):
    given = case.Solid("block", RHO, E, NU, tuple(blocks), tuple(boundaries))
    return replace(given, **changes)


def force_of(equations, d, time=0.0, pressures=()):
    H = equations.gradient(d)
    f = equations.internal_force(H, equations.stress(H))
    for pressure in pressures:
        outside = np.zeros_like(f)
        pressure.add_force(outside, d)
        f = f - outside
    return f


def assembled(equations, K):
    return MatrixPattern(equations.dofs, 2 * len(equations.mesh.points)).matrix(K)


def tangent_at(equations, d, mass_factor=0.0, pressures=()):
    H = equations.gradient(d)
    return assembled(equations, equations.tangent(H, equations.stress(H), mass_factor, list(pressures)))


class Reference:
    """The same solid in scikit-fem, on the same bent biquadratic elements with the same quadrature points."""

    def __init__(self, mesh, columns, rows, shape):
        skfem = pytest.importorskip("skfem")
        self.skfem = skfem
        straight = skfem.MeshQuad2.from_mesh(
            skfem.MeshQuad.init_tensor(np.linspace(0, 1, 2 * columns + 1), np.linspace(0, 1, rows + 1))
        )
        element = skfem.ElementVector(skfem.ElementQuad2())
        where = skfem.Basis(straight, element, intorder=7).doflocs.T
        bent_mesh = replace(straight, doflocs=shape(straight.doflocs.T).T)
        self.basis = skfem.Basis(bent_mesh, element, intorder=7)  # 4 × 4 Gauss points, as p + 2
        mine = shape(where)
        distance = np.abs(mine[:, None] - mesh.points[None]).sum(axis=-1)
        nodes = distance.argmin(axis=1)
        assert distance.min(axis=1).max() < 1e-12
        component = np.zeros(len(nodes), dtype=int)
        for node in np.unique(nodes):
            component[np.flatnonzero(nodes == node)] = [0, 1]
        self.to_mine = 2 * nodes + component

    def matrix(self, form):
        A = self.skfem.BilinearForm(form).assemble(self.basis).tocoo()
        n = len(self.to_mine)
        dense = np.zeros((n, n))
        np.add.at(dense, (self.to_mine[A.row], self.to_mine[A.col]), A.data)
        return dense

    def vector(self, form, d):
        field = self.basis.interpolate(d.ravel()[self.to_mine])
        b = self.skfem.LinearForm(form).assemble(self.basis, u=field)
        result = np.zeros(len(b))
        result[self.to_mine] = b
        return result.reshape(-1, 2)


@pytest.fixture(scope="module")
def compared():
    mesh = mesh_of(2)
    return mesh, Reference(mesh, 3, 2, bent)


def test_mass_agrees_with_scikit_fem(compared):
    mesh, reference = compared
    expected = reference.matrix(lambda u, v, w: RHO * (u[0] * v[0] + u[1] * v[1]))
    M = SolidEquations(mesh, [solid()]).mass.toarray()
    np.testing.assert_allclose(np.kron(M, np.eye(2)), expected, atol=1e-12 * expected.max())


def test_linear_stiffness_agrees_with_scikit_fem(compared):
    mesh, reference = compared

    def form(u, v, w):
        du, dv = u.grad, v.grad
        strain, virtual = (du + du.swapaxes(0, 1)) / 2.0, (dv + dv.swapaxes(0, 1)) / 2.0
        return LAME * (strain[0, 0] + strain[1, 1]) * (virtual[0, 0] + virtual[1, 1]) + 2.0 * MU * np.sum(
            strain * virtual, axis=(0, 1)
        )

    expected = reference.matrix(form)
    for model in ("linear", "st-venant-kirchhoff"):  # the same without displacement
        equations = SolidEquations(mesh, [solid(model=model)])
        K = tangent_at(equations, np.zeros(mesh.points.shape)).toarray()
        np.testing.assert_allclose(K, expected, atol=1e-12 * np.abs(expected).max())


def test_residual_agrees_with_scikit_fem(compared):
    mesh, reference = compared
    d = 0.1 * np.random.default_rng(51).standard_normal(mesh.points.shape)

    def form(v, w):
        H, dv = w.u.grad, v.grad
        F = H + np.eye(2)[:, :, None, None]
        C = np.einsum("ki...,kj...->ij...", F, F)
        strain = (C - np.eye(2)[:, :, None, None]) / 2.0
        S = LAME * (strain[0, 0] + strain[1, 1]) * np.eye(2)[:, :, None, None] + 2.0 * MU * strain
        return np.einsum("ik...,kj...,ij...->...", F, S, dv)

    expected = reference.vector(form, d)
    np.testing.assert_allclose(
        force_of(SolidEquations(mesh, [solid()]), d), expected, atol=1e-12 * np.abs(expected).max()
    )


@pytest.mark.parametrize("order", [1, 3])
def test_tangent_is_the_derivative_of_the_residual_with_follower_pressure(order):
    mesh = mesh_of(order, 2, 2)
    everywhere = case.Pressure(("bottom", "right", "top", "left"), expression("4000*(1 + x*y)"))
    equations = SolidEquations(mesh, [solid(boundaries=[everywhere])])
    rng = np.random.default_rng(52)
    d, change = 0.05 * rng.standard_normal((2, *mesh.points.shape))
    pressures = equations.loads.pressures(0.0)
    K = tangent_at(equations, d, 7.0, pressures)
    step = 1e-5
    plus, minus = (force_of(equations, d + s * change, pressures=pressures) for s in (step, -step))
    expected = (plus - minus) / (2.0 * step) + 7.0 * (equations.mass @ change)
    np.testing.assert_allclose((K @ change.ravel()).reshape(-1, 2), expected, atol=1e-7 * np.abs(expected).max())
    # The pressure's part is there and is not small.
    without = tangent_at(equations, d, 7.0)
    assert np.abs((K - without) @ change.ravel()).max() > 1e-2 * np.abs(expected).max()


def test_follower_pressure_on_a_closed_curve_has_no_resultant_and_no_moment():
    mesh = mesh_of(3)
    pressure = case.Pressure(("bottom", "right", "top", "left"), expression("11"))
    equations = SolidEquations(mesh, [solid(boundaries=[pressure])])
    d = 0.1 * np.random.default_rng(53).standard_normal(mesh.points.shape)
    f = np.zeros(mesh.points.shape)
    for load in equations.loads.pressures(0.0):
        load.add_force(f, d)
    x = mesh.points + d
    assert np.abs(f).sum() > 1.0
    np.testing.assert_allclose(f.sum(axis=0), 0.0, atol=1e-12)
    assert np.sum(x[:, 0] * f[:, 1] - x[:, 1] * f[:, 0]) == pytest.approx(0.0, abs=1e-12)


def test_linear_solids_are_pressed_on_their_undeformed_sides():
    mesh = mesh_of(2)
    pressure = case.Pressure(("right", "top"), expression("11"))
    equations = SolidEquations(mesh, [solid(model="linear", boundaries=[pressure])])
    d = 0.1 * np.random.default_rng(54).standard_normal(mesh.points.shape)
    (f, g) = np.zeros((2, *mesh.points.shape))
    for load in equations.loads.pressures(0.0):
        load.add_force(f, d)
        load.add_force(g, 0.0 * d)
    np.testing.assert_array_equal(f, g)
    difference = tangent_at(equations, d, pressures=equations.loads.pressures(0.0)) - tangent_at(equations, d)
    assert abs(difference).max() == 0.0


def test_resultants_of_body_forces_and_tractions():
    mesh = mesh_of(3)
    traction = case.Traction(("bottom", "right", "top", "left"), expression("x"), expression("2*y*t"))
    equations = SolidEquations(mesh, [solid(boundaries=[traction], body_force=(expression("3"), expression("x*t")))])
    weights = equations.mass.sum() / RHO  # the area
    first = equations.mass @ mesh.points
    moment = first.sum(axis=0)[0] / RHO  # ∫ x
    without = SolidEquations(mesh, [solid(body_force=(expression("3"), expression("x*t")))]).loads.dead(2.0)
    np.testing.assert_allclose(without.sum(axis=0), [3.0 * weights, 2.0 * moment], rtol=1e-11)
    # ∫ (x, 4 y) ds by fine straight pieces
    pieces = np.zeros(2)
    s = np.linspace(0.0, 1.0, 4001)
    for a, b in (((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0, 1)), ((0, 1), (0, 0))):
        line = np.outer(1.0 - s, a) + np.outer(s, b)
        curve = bent(line)
        middle, length = (curve[1:] + curve[:-1]) / 2.0, np.hypot(*np.diff(curve, axis=0).T)
        pieces += [np.sum(length * middle[:, 0]), np.sum(length * 4.0 * middle[:, 1])]
    np.testing.assert_allclose((equations.loads.dead(2.0) - without).sum(axis=0), pieces, rtol=1e-5)


def test_dead_loads_are_kept_only_if_they_do_not_depend_on_time():
    mesh = mesh_of(1)
    steady = SolidEquations(mesh, [solid(body_force=(expression("x"), expression("0")))]).loads
    assert steady.dead(0.0) is steady.dead(1.0)
    changing = SolidEquations(mesh, [solid(body_force=(expression("t"), expression("0")))]).loads
    np.testing.assert_allclose(changing.dead(3.0), 3.0 * changing.dead(1.0), rtol=1e-14)


def test_pressures_that_are_zero_are_left_out():
    loads = SolidEquations(mesh_of(1), [solid(boundaries=[case.Pressure(("top",), expression("t"))])]).loads
    assert loads.pressures(0.0) == []
    assert len(loads.pressures(1.0)) == 1


def test_materials_belong_to_their_blocks():
    mesh = mesh_of(2, shape=np.copy)
    soft = solid(("left_half",), youngs_modulus=1.0, density=2.0, model="linear")
    hard = solid(("right_half",), youngs_modulus=100.0, density=3.0, plane="stress")
    equations = SolidEquations(mesh, [soft, hard])
    assert equations.mass.sum() == pytest.approx(0.5 * (2.0 + 3.0))
    H = np.array([[0.1, 0.0], [0.2, 0.0]])
    S = equations.stress(equations.gradient(mesh.points @ H.T))
    quadratic = np.array([[0.05, 0.0], [0.0, 0.0]]) / 2.0
    strain = (H + H.T) / 2.0
    lame, mu = NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), 1.0 / (2.0 * (1.0 + NU))
    for group, factor, l, e in (
        ("left_half", 1.0, lame, strain),
        ("right_half", 100.0, 2.0 * lame * mu / (lame + 2.0 * mu), strain + quadratic),
    ):
        expected = factor * (l * np.trace(e) * np.eye(2) + 2.0 * mu * e)
        own = S[mesh.cell_groups[group]].reshape(-1, 3)
        np.testing.assert_allclose(own, np.tile(expected[[0, 1, 0], [0, 1, 1]], (len(own), 1)), atol=1e-11)


def test_conditions_of_a_solid_stay_on_its_own_elements():
    mesh = mesh_of(2, shape=np.copy)
    load = case.Traction(("bottom",), expression("1"), expression("0"))
    equations = SolidEquations(mesh, [solid(("left_half",), [load]), solid(("right_half",))])
    f = equations.loads.dead(0.0)
    assert f[:, 0].sum() == pytest.approx(0.5)
    assert np.abs(f[mesh.points[:, 0] > 0.5 + 1e-9]).max() == 0.0


def test_shared_forces_add_up_again():
    mesh = mesh_of(2)
    equations = SolidEquations(mesh, [solid()])
    f = np.random.default_rng(55).standard_normal(mesh.points.shape)
    total = np.zeros(f.size)
    np.add.at(total, equations.dofs, equations.shared(f))
    np.testing.assert_allclose(total.reshape(-1, 2), f, atol=1e-14)


def test_applied_element_matrices_are_the_assembled_ones():
    mesh = mesh_of(2)
    equations = SolidEquations(mesh, [solid()])
    rng = np.random.default_rng(56)
    K, d = rng.standard_normal((*equations.dofs.shape, equations.dofs.shape[1])), rng.standard_normal(mesh.points.shape)
    np.testing.assert_allclose(equations.applied(K, d).ravel(), assembled(equations, K) @ d.ravel(), atol=1e-11)


def test_volume_ratio_is_that_of_the_most_compressed_point():
    mesh = mesh_of(2, shape=np.copy)
    H = np.array([[-0.3, 0.1], [0.0, 0.2]])
    d = mesh.points @ H.T
    assert SolidEquations(mesh, [solid()]).lowest_volume_ratio(d) == pytest.approx(0.7 * 1.2)
    assert SolidEquations(mesh, [solid(model="linear")]).lowest_volume_ratio(d) == 1.0


def test_rounding_estimate_bounds_what_rounding_does():
    mesh = mesh_of(3, shape=lambda points: points * [1.0, 0.01])  # thin
    equations = SolidEquations(mesh, [solid()])
    angle = 1.0
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    d = mesh.points @ (R - np.eye(2)).T
    H = equations.gradient(d)
    noise = np.linalg.norm(equations.internal_force(H, equations.stress(H)))  # zero but for rounding
    estimate = equations.rounding(d, H)
    assert 0.0 < noise < estimate < 1e3 * noise


def test_elements_without_a_solid_are_reported():
    with pytest.raises(CaseError, match=r"solid\[0\]: 6 elements of the mesh belong to no solid"):
        SolidEquations(mesh_of(1), [solid(("left_half",))])


def test_elements_of_two_solids_are_reported():
    second = solid(("right_half",), name="other", place="solid[1]")
    with pytest.raises(CaseError, match=r"solid\[1\]\.blocks: solids 'block' and 'other' share 6 elements"):
        SolidEquations(mesh_of(1), [solid(), second])
