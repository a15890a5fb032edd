"""Solids whose displacements are known."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hofsi import case
from hofsi.fem.element import element_table
from hofsi.solvers.solid import SolidSolver, SolidState


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff"])
def test_patch_of_distorted_elements_reproduces_a_linear_displacement(solids, model):
    mesh = solids.rectangle(2, 3, 2, shape=solids.bent)
    H = np.array([[0.1, -0.3], [0.2, 0.15]])
    s = solids.solver(mesh, [solids.displacement(solids.around, "0.1*x - 0.3*y", "0.2*x + 0.15*y")], model=model)
    np.testing.assert_allclose(solids.equilibrium(s), mesh.points @ H.T, atol=1e-12)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_uniaxial_tension(solids, plane):
    stretch = 1.3
    lame = solids.LAME if plane == "strain" else 2.0 * solids.LAME * solids.MU / (solids.LAME + 2.0 * solids.MU)
    modulus = lame + 2.0 * solids.MU - lame**2 / (lame + 2.0 * solids.MU)  # S_yy = 0
    strain = (stretch**2 - 1.0) / 2.0
    load = stretch * modulus * strain  # P_xx, per undeformed length
    across = np.sqrt(1.0 - 2.0 * lame / (lame + 2.0 * solids.MU) * strain)
    mesh = solids.rectangle(2, size=(2.0, 1.0))
    s = solids.solver(
        mesh, [case.Roller(("left",)), case.Roller(("bottom",)), solids.traction("right", load, 0)], plane=plane
    )
    np.testing.assert_allclose(solids.equilibrium(s), mesh.points * [stretch - 1.0, across - 1.0], atol=1e-11)


def test_simple_shear_needs_the_exact_reactions(solids):
    g = 0.4
    mesh = solids.rectangle(3)
    s = solids.solver(mesh, [solids.displacement(solids.around, f"{g}*y", 0)])
    step = s.begin_static()
    reaction = step.reaction(step.solve())
    F = np.array([[1.0, g], [0.0, 1.0]])
    S = np.array([[solids.LAME * g**2 / 2, solids.MU * g], [solids.MU * g, (solids.LAME + 2.0 * solids.MU) * g**2 / 2]])
    top = mesh.edge_nodes("top")
    inner = np.setdiff1d(top, np.union1d(mesh.edge_nodes("left"), mesh.edge_nodes("right")))
    shared = np.abs(mesh.points[inner, 0] - 0.5) < 1e-12  # by both elements of half a unit each
    per_node = np.where(shared, 2.0, 5.0) / 24.0  # GLL weights 1/6, 5/6, 5/6, 1/6 on [-1, 1]
    np.testing.assert_allclose(reaction[inner], per_node[:, None] * (F @ S)[:, 1], atol=1e-10)
    np.testing.assert_allclose(reaction.sum(axis=0), 0.0, atol=1e-10)


def test_prescribed_turn_of_half_a_circle_leaves_no_stress(solids):
    mesh = solids.rectangle(3, 2, 2)
    angle = "pi*t"
    turn = solids.displacement("left", f"x*cos({angle}) - y*sin({angle}) - x", f"x*sin({angle}) + y*cos({angle}) - y")
    s = solids.solver(mesh, [turn])
    state = s.initial_state()
    for time in np.linspace(0.25, 1.0, 4):
        step = s.begin_static(SolidState(state.displacements, state.velocities, float(time)))
        state = step.accept(step.solve())
    np.testing.assert_allclose(state.displacement, mesh.points @ (solids.rotation(np.pi) - np.eye(2)).T, atol=1e-9)


def ring_displacement(solids, r, p, a, b, outer_fixed):
    """Lamé's ring in plane strain under inner pressure: u = A r + B/r."""
    # σ_r = 2 (λ + μ) A - 2 μ B/r² is -p at a, and at b either σ_r = 0 or u = 0.
    first = [2.0 * (solids.LAME + solids.MU), -2.0 * solids.MU / a**2]
    second = [b, 1.0 / b] if outer_fixed else [2.0 * (solids.LAME + solids.MU), -2.0 * solids.MU / b**2]
    A, B = np.linalg.solve([first, second], [-p, 0.0])
    return A * r + B / r


@pytest.mark.parametrize(
    ("model", "p", "tolerance"), [("linear", 5.0, 1e-8), ("st-venant-kirchhoff", 1e-5, 1e-6), ("neo-hooke", 1e-5, 1e-6)]
)
@pytest.mark.parametrize("outer_fixed", [False, True])
def test_pressure_on_an_arc_gives_lames_ring(solids, model, p, tolerance, outer_fixed):
    mesh = solids.quarter_ring(6, 3, 2)
    boundaries = [case.Roller(("bottom",)), case.Roller(("left",)), solids.pressure("inner", p)]
    boundaries += [case.Roller(("outer",))] if outer_fixed else []
    d = solids.equilibrium(solids.solver(mesh, boundaries, model=model))
    r = np.hypot(*mesh.points.T)
    exact = (ring_displacement(solids, r, p, 1.0, 2.0, outer_fixed) / r)[:, None] * mesh.points
    np.testing.assert_allclose(d, exact, atol=tolerance * np.abs(exact).max())


@pytest.mark.parametrize("order", [1, 2, 3])
def test_error_falls_with_order_plus_one(solids, order):
    """Manufactured solution with strains of 15 %; its loads are imposed in weak form."""
    errors = []
    N = element_table(order, order + 2).N
    for elements in (3, 6):
        mesh = solids.rectangle(order, elements, elements, shape=solids.bent)
        s = solids.solver(mesh, [solids.displacement(solids.around, "0.05*sin(3*x + y)", "0.05*cos(2*y - x)*x")])
        x, y = np.moveaxis(np.einsum("qi,eid->eqd", N, mesh.coordinates), -1, 0)
        H = 0.05 * np.stack(
            [
                3.0 * np.cos(3 * x + y),
                np.cos(3 * x + y),
                np.cos(2 * y - x) + x * np.sin(2 * y - x),
                -2.0 * x * np.sin(2 * y - x),
            ],
            axis=-1,
        ).reshape(*x.shape, 2, 2)
        d = solids.equilibrium(s, s.equations.internal_force(H, s.equations.stress(H)))
        exact = 0.05 * np.stack([np.sin(3 * x + y), np.cos(2 * y - x) * x], axis=-1)
        errors.append(np.sqrt(np.mean((np.einsum("qi,eid->eqd", N, d[mesh.cells]) - exact) ** 2)))
    assert errors[1] < 5e-3
    assert np.log2(errors[0] / errors[1]) > order + 0.75


def test_inclined_rollers_are_the_turned_problem(solids):
    angle = 0.6
    results = []
    for turn in (0.0, angle):
        mesh = solids.rectangle(3, 3, 2, (2.0, 1.0), turn)
        f = solids.rotation(turn) @ [3.0, -6.0]
        s = solids.solver(
            mesh, [case.Roller(("bottom", "left")), solids.pressure("top", 9)], body_force=solids.pair(f[0], f[1])
        )
        step = s.begin_static()
        d = step.solve()
        results.append((d @ solids.rotation(turn), step.reaction(d) @ solids.rotation(turn)))
    for straight, turned in zip(*results, strict=True):
        np.testing.assert_allclose(turned, straight, atol=1e-9 * np.abs(straight).max())
    assert np.abs(results[0][0]).max() > 0.02


def test_bar_of_two_materials_divides_its_elongation(solids):
    vertices = {"a": (0.0, 0.0), "b": (1.0, 0.0), "c": (3.0, 0.0), "d": (3.0, 1.0), "e": (1.0, 1.0), "f": (0.0, 1.0)}
    blocks = {"soft": [("a", "b", "e", "f")], "hard": [("b", "c", "d", "e")]}
    edges = {"left": [("a", "f")], "right": [("c", "d")]}
    mesh = generate(BlockStructure.build(vertices, blocks, counts=2, edges=edges), 2)
    common = {"density": 1.0, "poissons_ratio": 0.0, "model": "linear"}
    held, pulled = case.Roller(("left",)), (solids.traction("right", 2, 0), solids.displacement("right", None, 0))
    soft = case.Solid(name="soft", youngs_modulus=10.0, blocks=("soft",), boundaries=(held,), **common)
    hard = case.Solid(name="hard", youngs_modulus=40.0, blocks=("hard",), boundaries=pulled, **common)
    d = SolidSolver(mesh, [soft, hard], case.NonlinearSettings()).begin_static().solve()
    x = mesh.points[:, 0]
    np.testing.assert_allclose(d[:, 0], np.where(x < 1.0, 0.2 * x, 0.2 + 0.05 * (x - 1.0)), atol=1e-12)


def test_separate_solids_in_one_mesh_do_not_know_each_other(solids):
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    vertices = np.concatenate([square, square + np.array([5.0, 0.0])])
    edges = {"first_left": [(0, 3)], "second_left": [(4, 7)]}
    blocks = {"first": [(0, 1, 2, 3)], "second": [(4, 5, 6, 7)]}
    mesh = generate(BlockStructure.build(vertices, blocks, counts=2, edges=edges), 2)
    bodies = [
        case.Solid(
            name,
            solids.RHO,
            modulus,
            solids.NU,
            (name,),
            (solids.displacement(f"{name}_left", 0, 0),),
            body_force=solids.pair(0, -3),
        )
        for name, modulus in (("first", solids.E), ("second", 3.0 * solids.E))
    ]
    d = SolidSolver(mesh, bodies, case.NonlinearSettings()).begin_static().solve()
    alone = solids.rectangle(2, 2, 2)
    for name, modulus in (("first", solids.E), ("second", 3.0 * solids.E)):
        own = np.unique(mesh.cells[mesh.cell_groups[name]])
        single = solids.solver(
            alone, [solids.displacement("left", 0, 0)], youngs_modulus=modulus, body_force=solids.pair(0, -3)
        )
        expected = solids.equilibrium(single)
        shifted = mesh.points[own] - mesh.points[own].min(axis=0)
        match = np.abs(shifted[:, None] - alone.points).sum(axis=2).argmin(axis=1)
        np.testing.assert_allclose(d[own], expected[match], atol=1e-8)
