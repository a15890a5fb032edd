from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, generate
from hoblock.building import build_structure
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.errors import CaseError, NewtonError
from hofsi.fem.element import element_table
from hofsi.io.scene import load_case
from hofsi.solvers.solid import SolidSolver, SolidState

EXAMPLES = Path(__file__).parents[3] / "examples"
E, NU, RHO = 210.0, 0.3, 4.0
LAME, MU = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))
AROUND = ("bottom", "right", "top", "left")


def expression(text):
    return compile_expression(str(text), ("x", "y", "t"))


def displacement(on, x=None, y=None):
    components = (None if c is None else expression(c) for c in (x, y))
    return case.Displacement((on,) if isinstance(on, str) else on, *components)


def traction(on, x, y):
    return case.Traction((on,), expression(x), expression(y))


def pressure(on, value):
    return case.Pressure((on,), expression(value))


def pair(x, y):
    return expression(x), expression(y)


def initial(x, y):
    return tuple(compile_expression(str(text), ("x", "y")) for text in (x, y))


def solver(mesh, boundaries, tolerance=1e-11, max_iterations=25, **changes):
    body = replace(case.Solid("block", RHO, E, NU, tuple(mesh.cell_groups), tuple(boundaries)), **changes)
    return SolidSolver(mesh, [body], case.NonlinearSettings(tolerance, max_iterations))


def rectangle(order, columns=2, rows=2, size=(1.0, 1.0), turn=0.0, shape=None):
    corners = np.array([(0.0, 0.0), (size[0], 0.0), size, (0.0, size[1])]) @ rotation(turn).T
    edges = {"bottom": [(0, 1)], "right": [(1, 2)], "top": [(2, 3)], "left": [(3, 0)]}
    counts = {(0, 1): columns, (1, 2): rows}
    mesh = generate(BlockStructure.build(corners, {"solid": [(0, 1, 2, 3)]}, counts=counts, edges=edges), order)
    return mesh if shape is None else mesh.with_points(shape(mesh.points))


def bent(points):
    x, y = points.T
    return np.stack([x + 0.08 * np.sin(2.1 * y + 0.3) * (1 + x), y + 0.1 * x**2 - 0.06 * np.cos(1.7 * x) * y], axis=-1)


def quarter_ring(order, rings, count, inner=1.0, outer=2.0):
    vertices = {"a": (inner, 0.0), "b": (outer, 0.0), "c": (0.0, outer), "d": (0.0, inner)}
    curves = {
        ("b", "c"): Arc.from_center((0.0, 0.0), vertices["b"], vertices["c"]),
        ("a", "d"): Arc.from_center((0.0, 0.0), vertices["a"], vertices["d"]),
    }
    edges = {"bottom": [("a", "b")], "outer": [("b", "c")], "left": [("c", "d")], "inner": [("d", "a")]}
    counts = {("a", "b"): rings, ("b", "c"): count}
    return generate(
        BlockStructure.build(vertices, {"solid": [("a", "b", "c", "d")]}, counts=counts, curves=curves, edges=edges),
        order,
    )


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def equilibrium(s, load=None):
    step = s.begin_static()
    return step.solve(load)


def march(s, state, dt, count, guess=None):
    steps = []
    for _ in range(count):
        steps = [dt, *steps][:2]
        step = s.begin_step(state, steps, state.time + dt)
        state = step.accept(step.solve(guess=None if guess is None else guess(state)))
    return state


def plate(order=4, elements=8, **changes):
    """The plate of Wall and Ramm: 4 × 0.06, clamped at its left end."""
    mesh = rectangle(order, elements, 1, (4.0, 0.06))
    material = {"density": 0.1, "youngs_modulus": 2.5e6, "poissons_ratio": 0.35} | changes
    tip = int(np.argmax(mesh.points.sum(axis=1)))
    return solver(mesh, [displacement("left", 0, 0)], 1e-10, **material), tip


# Exact solutions


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff"])
def test_patch_of_distorted_elements_reproduces_a_linear_displacement(model):
    mesh = rectangle(2, 3, 2, shape=bent)
    H = np.array([[0.1, -0.3], [0.2, 0.15]])
    s = solver(mesh, [displacement(AROUND, "0.1*x - 0.3*y", "0.2*x + 0.15*y")], model=model)
    np.testing.assert_allclose(equilibrium(s), mesh.points @ H.T, atol=1e-12)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_uniaxial_tension(plane):
    stretch = 1.3
    lame = LAME if plane == "strain" else 2.0 * LAME * MU / (LAME + 2.0 * MU)
    modulus = lame + 2.0 * MU - lame**2 / (lame + 2.0 * MU)  # S_yy = 0
    strain = (stretch**2 - 1.0) / 2.0
    load = stretch * modulus * strain  # P_xx, per undeformed length
    across = np.sqrt(1.0 - 2.0 * lame / (lame + 2.0 * MU) * strain)
    mesh = rectangle(2, size=(2.0, 1.0))
    s = solver(mesh, [case.Roller(("left",)), case.Roller(("bottom",)), traction("right", load, 0)], plane=plane)
    np.testing.assert_allclose(equilibrium(s), mesh.points * [stretch - 1.0, across - 1.0], atol=1e-11)


def test_simple_shear_needs_the_exact_reactions():
    g = 0.4
    mesh = rectangle(3)
    s = solver(mesh, [displacement(AROUND, f"{g}*y", 0)])
    step = s.begin_static()
    reaction = step.reaction(step.solve())
    F = np.array([[1.0, g], [0.0, 1.0]])
    S = np.array([[LAME * g**2 / 2, MU * g], [MU * g, (LAME + 2.0 * MU) * g**2 / 2]])
    top = mesh.edge_nodes("top")
    inner = np.setdiff1d(top, np.union1d(mesh.edge_nodes("left"), mesh.edge_nodes("right")))
    shared = np.abs(mesh.points[inner, 0] - 0.5) < 1e-12  # by both elements of half a unit each
    per_node = np.where(shared, 2.0, 5.0) / 24.0  # GLL weights 1/6, 5/6, 5/6, 1/6 on [-1, 1]
    np.testing.assert_allclose(reaction[inner], per_node[:, None] * (F @ S)[:, 1], atol=1e-10)
    np.testing.assert_allclose(reaction.sum(axis=0), 0.0, atol=1e-10)


def test_prescribed_turn_of_half_a_circle_leaves_no_stress():
    mesh = rectangle(3, 2, 2)
    angle = "pi*t"
    turn = displacement("left", f"x*cos({angle}) - y*sin({angle}) - x", f"x*sin({angle}) + y*cos({angle}) - y")
    s = solver(mesh, [turn])
    state = s.initial_state()
    for time in np.linspace(0.25, 1.0, 4):
        step = s.begin_static(SolidState(state.displacements, state.velocities, float(time)))
        state = step.accept(step.solve())
    np.testing.assert_allclose(state.displacement, mesh.points @ (rotation(np.pi) - np.eye(2)).T, atol=1e-9)


def ring_displacement(r, p, a, b, outer_fixed):
    """Lamé's ring in plane strain under inner pressure: u = A r + B/r."""
    # σ_r = 2 (λ + μ) A - 2 μ B/r² is -p at a, and at b either σ_r = 0 or u = 0.
    first = [2.0 * (LAME + MU), -2.0 * MU / a**2]
    second = [b, 1.0 / b] if outer_fixed else [2.0 * (LAME + MU), -2.0 * MU / b**2]
    A, B = np.linalg.solve([first, second], [-p, 0.0])
    return A * r + B / r


@pytest.mark.parametrize(
    ("model", "p", "tolerance"), [("linear", 5.0, 1e-8), ("st-venant-kirchhoff", 1e-5, 1e-6), ("neo-hooke", 1e-5, 1e-6)]
)
@pytest.mark.parametrize("outer_fixed", [False, True])
def test_pressure_on_an_arc_gives_lames_ring(model, p, tolerance, outer_fixed):
    mesh = quarter_ring(6, 3, 2)
    boundaries = [case.Roller(("bottom",)), case.Roller(("left",)), pressure("inner", p)]
    boundaries += [case.Roller(("outer",))] if outer_fixed else []
    d = equilibrium(solver(mesh, boundaries, model=model))
    r = np.hypot(*mesh.points.T)
    exact = (ring_displacement(r, p, 1.0, 2.0, outer_fixed) / r)[:, None] * mesh.points
    np.testing.assert_allclose(d, exact, atol=tolerance * np.abs(exact).max())


@pytest.mark.parametrize("order", [1, 2, 3])
def test_error_falls_with_order_plus_one(order):
    """Manufactured solution with strains of 15 %; its loads are imposed in weak form."""
    errors = []
    N = element_table(order, order + 2).N
    for elements in (3, 6):
        mesh = rectangle(order, elements, elements, shape=bent)
        s = solver(mesh, [displacement(AROUND, "0.05*sin(3*x + y)", "0.05*cos(2*y - x)*x")])
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
        d = equilibrium(s, s.equations.internal_force(H, s.equations.stress(H)))
        exact = 0.05 * np.stack([np.sin(3 * x + y), np.cos(2 * y - x) * x], axis=-1)
        errors.append(np.sqrt(np.mean((np.einsum("qi,eid->eqd", N, d[mesh.cells]) - exact) ** 2)))
    assert errors[1] < 5e-3
    assert np.log2(errors[0] / errors[1]) > order + 0.75


def test_inclined_rollers_are_the_turned_problem():
    angle = 0.6
    results = []
    for turn in (0.0, angle):
        mesh = rectangle(3, 3, 2, (2.0, 1.0), turn)
        f = rotation(turn) @ [3.0, -6.0]
        s = solver(mesh, [case.Roller(("bottom", "left")), pressure("top", 9)], body_force=pair(f[0], f[1]))
        step = s.begin_static()
        d = step.solve()
        results.append((d @ rotation(turn), step.reaction(d) @ rotation(turn)))
    for straight, turned in zip(*results, strict=True):
        np.testing.assert_allclose(turned, straight, atol=1e-9 * np.abs(straight).max())
    assert np.abs(results[0][0]).max() > 0.02


def test_bar_of_two_materials_divides_its_elongation():
    vertices = {"a": (0.0, 0.0), "b": (1.0, 0.0), "c": (3.0, 0.0), "d": (3.0, 1.0), "e": (1.0, 1.0), "f": (0.0, 1.0)}
    blocks = {"soft": [("a", "b", "e", "f")], "hard": [("b", "c", "d", "e")]}
    edges = {"left": [("a", "f")], "right": [("c", "d")]}
    mesh = generate(BlockStructure.build(vertices, blocks, counts=2, edges=edges), 2)
    common = {"density": 1.0, "poissons_ratio": 0.0, "model": "linear"}
    held, pulled = case.Roller(("left",)), (traction("right", 2, 0), displacement("right", None, 0))
    soft = case.Solid(name="soft", youngs_modulus=10.0, blocks=("soft",), boundaries=(held,), **common)
    hard = case.Solid(name="hard", youngs_modulus=40.0, blocks=("hard",), boundaries=pulled, **common)
    d = SolidSolver(mesh, [soft, hard], case.NonlinearSettings()).begin_static().solve()
    x = mesh.points[:, 0]
    np.testing.assert_allclose(d[:, 0], np.where(x < 1.0, 0.2 * x, 0.2 + 0.05 * (x - 1.0)), atol=1e-12)


def test_separate_solids_in_one_mesh_do_not_know_each_other():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    vertices = np.concatenate([square, square + np.array([5.0, 0.0])])
    edges = {"first_left": [(0, 3)], "second_left": [(4, 7)]}
    blocks = {"first": [(0, 1, 2, 3)], "second": [(4, 5, 6, 7)]}
    mesh = generate(BlockStructure.build(vertices, blocks, counts=2, edges=edges), 2)
    solids = [
        case.Solid(name, RHO, modulus, NU, (name,), (displacement(f"{name}_left", 0, 0),), body_force=pair(0, -3))
        for name, modulus in (("first", E), ("second", 3.0 * E))
    ]
    d = SolidSolver(mesh, solids, case.NonlinearSettings()).begin_static().solve()
    alone = rectangle(2, 2, 2)
    for name, modulus in (("first", E), ("second", 3.0 * E)):
        own = np.unique(mesh.cells[mesh.cell_groups[name]])
        single = solver(alone, [displacement("left", 0, 0)], youngs_modulus=modulus, body_force=pair(0, -3))
        expected = equilibrium(single)
        shifted = mesh.points[own] - mesh.points[own].min(axis=0)
        match = np.abs(shifted[:, None] - alone.points).sum(axis=2).argmin(axis=1)
        np.testing.assert_allclose(d[own], expected[match], atol=1e-8)


# Statics


def test_supports_carry_the_loads():
    mesh = rectangle(3, 4, 2, (2.0, 1.0))
    boundaries = [displacement("left", 0, 0), pressure("top", 1.5), traction("right", 0.5, 1)]
    s = solver(mesh, boundaries, body_force=pair(0, -0.5))
    step = s.begin_static()
    load = np.zeros(mesh.points.shape)
    load[mesh.edge_nodes("bottom")] = [0.05, 0.01]
    d = step.solve(load)
    reaction = step.reaction(d, load)
    x = mesh.points + d
    top = mesh.points[:, 1] > 1.0 - 1e-9
    ends = x[top][np.argsort(mesh.points[top, 0])][[0, -1]]
    pushed = 1.5 * np.array([ends[1, 1] - ends[0, 1], -(ends[1, 0] - ends[0, 0])])  # -p ∫ n ds depends on the ends only
    applied = pushed + np.array([0.5, 1.0]) + np.array([0.0, -1.0]) + load.sum(axis=0)
    np.testing.assert_allclose(reaction.sum(axis=0), -applied, rtol=1e-9)
    free = np.setdiff1d(np.arange(len(d)), mesh.edge_nodes("left"))
    assert np.abs(reaction[free]).max() == 0.0


def test_no_load_no_displacement():
    s = solver(rectangle(2), [displacement("left", 0, 0)])
    assert np.abs(equilibrium(s)).max() == 0.0
    assert s.counts.factorisations == 0


def test_csm1_of_turek_and_hron():
    given = load_case(EXAMPLES / "csm1.toml")
    mesh = generate(build_structure(given.mesh), given.mesh.order)
    s = SolidSolver(mesh, given.solids, given.nonlinear)
    step = s.begin_static()
    state = step.accept(step.solve())
    tip = int(np.argmin(np.hypot(*(mesh.points - [0.6, 0.2]).T)))
    np.testing.assert_allclose(state.displacement[tip], [-7.18777e-3, -6.61029e-2], rtol=5e-4)


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff", "neo-hooke"])
def test_multigrid_bends_the_flag_as_factors_do(model):
    pytest.importorskip("pyamg")
    given = load_case(EXAMPLES / "csm1.toml")
    mesh = generate(build_structure(given.mesh), given.mesh.order)
    solids = [replace(given.solids[0], model=model)]
    direct, amg = (SolidSolver(mesh, solids, given.nonlinear, case.LinearSettings(kind)) for kind in ("direct", "amg"))
    expected = equilibrium(direct)
    step = amg.begin_static()
    np.testing.assert_allclose(step.solve(), expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    assert step._newton.tangent.factor.factor.iterations > 1  # of FGMRES


def test_slender_cantilever_is_bent_far_from_zero_in_one_go():
    s, tip = plate(body_force=pair(0, -600))
    step = s.begin_static()
    d = step.accept(step.solve()).displacement
    assert d[tip, 1] < -3.0
    x = s.mesh.points + d
    bottom = s.mesh.edge_nodes("bottom")
    order = bottom[np.argsort(s.mesh.points[bottom, 0])]
    length = np.sum(np.hypot(*np.diff(x[order], axis=0).T))
    assert length == pytest.approx(4.0, rel=2e-2)  # bends, does not stretch
    assert s.counts.iterations <= 25


def test_load_is_applied_in_parts_where_newton_does_not_converge_at_once():
    loads = {"body_force": pair(0, -600)}
    patient, tip = plate(**loads)
    expected = patient.begin_static().solve()
    hasty, _ = plate(**loads)
    hasty.nonlinear = case.NonlinearSettings(1e-10, 8)
    step = hasty.begin_static()
    with pytest.raises(NewtonError, match="after 8 iterations"):
        step._newton.solve(step.state.displacement, hasty.equations.loads.dead(0.0), 1e-10)
    d = hasty.begin_static().solve()
    np.testing.assert_allclose(d[tip], expected[tip], rtol=1e-7)


def test_follower_pressure_rolls_a_strip_up():
    """A cantilever under p = 24 EI/L³: its end turns by more than 180°, where dead loads would lead elsewhere."""
    mesh = rectangle(4, 10, 1, (1.0, 0.01))
    s = solver(mesh, [displacement("left", 0, 0), pressure("top", 2)], 1e-10, youngs_modulus=1e6, poissons_ratio=0.0)
    step = s.begin_static()
    d = step.solve()
    end = mesh.edge_nodes("right")
    elastica = [-1.38903, -0.51141]  # of the inextensible middle line, by collocation
    np.testing.assert_allclose(d[end].mean(axis=0), elastica, atol=0.01)  # the thickness
    x, top = mesh.points + d, mesh.edge_nodes("top")
    first, last = x[top[np.argmin(mesh.points[top, 0])]], x[top[np.argmax(mesh.points[top, 0])]]
    pushed = 2.0 * np.array([last[1] - first[1], first[0] - last[0]])
    np.testing.assert_allclose(step.reaction(d).sum(axis=0), -pushed, rtol=1e-7)


def test_parts_of_a_prescribed_movement_add_up():
    mesh = rectangle(2, 4, 2, (2.0, 1.0))
    s = solver(mesh, [displacement("left", 0, 0), displacement("right", "0.6", "-0.8")])
    step = s.begin_static()
    at_once = step.solve()
    in_parts = step._newton.solve_by_parts(step.state.displacement, s.equations.loads.dead(0.0), 1e-11)
    np.testing.assert_allclose(in_parts, at_once, atol=1e-9)
    np.testing.assert_allclose(in_parts[mesh.edge_nodes("right")], np.tile([0.6, -0.8], (5, 1)), atol=1e-14)


def test_hopeless_load_is_reported_with_numbers():
    s = solver(rectangle(1, 2, 1), [displacement("left", 0, 0), traction("right", 20, 20)], max_iterations=1)
    with pytest.raises(NewtonError, match=r"solid, t = 0: .*of the load was reached") as caught:
        equilibrium(s)
    assert caught.value.reason == "max_iterations"


def test_load_that_is_not_finite_is_reported():
    s = solver(rectangle(1, 2, 1), [displacement("left", 0, 0)])
    load = np.zeros(s.mesh.points.shape)
    load[1, 0] = np.nan
    with pytest.raises(NewtonError, match="residual is not finite") as caught:
        equilibrium(s, load)
    assert caught.value.reason == "diverged"


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff", "neo-hooke"])
def test_solid_without_support_is_reported(model):
    s = solver(rectangle(1, 2, 1), [], body_force=pair(1, 0), model=model)
    with pytest.raises(CaseError, match=r"solid\[0\].boundary: solid 'block' is not held: it can move anywhere"):
        equilibrium(s)


def test_solid_turned_inside_out_is_not_accepted():
    mesh = rectangle(1, 1, 1)
    step = solver(mesh, [displacement("left", 0, 0)]).begin_static()
    with pytest.raises(NewtonError, match=r"turned inside out: det F is -0\.5") as caught:
        step.accept(mesh.points * [-1.5, 0.0])
    assert caught.value.reason == "inverted"


# Dynamics


def test_free_fall_has_exact_velocity_and_second_order_position():
    errors = []
    for dt in (0.1, 0.05):
        mesh = rectangle(2)
        s = solver(mesh, [], body_force=pair(0, -2.0 * RHO), initial_velocity=initial(1, 0))
        state = march(s, s.initial_state(), dt, round(1.0 / dt))
        np.testing.assert_allclose(state.velocity, np.tile([1.0, -2.0], (len(mesh.points), 1)), atol=1e-10)
        np.testing.assert_allclose(state.displacement[:, 0], 1.0, atol=1e-10)
        np.testing.assert_allclose(state.displacement[:, 1], state.displacement[0, 1], atol=1e-10)
        errors.append(abs(state.displacement[0, 1] + 1.0))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)


def bar(dt, count, model="linear"):
    """First longitudinal mode of a bar, clamped at the left; ω = π/2 for E/ρ = 1 and length 1."""
    mesh = rectangle(4, 2, 1, (1.0, 0.1))
    boundaries = [displacement("left", 0, None), displacement(("bottom", "top"), None, 0)]
    s = solver(
        mesh,
        boundaries,
        youngs_modulus=3.0,
        density=3.0,
        poissons_ratio=0.0,
        model=model,
        initial_displacement=initial("1e-3*sin(pi*x/2)", 0),
    )
    return s, march(s, s.initial_state(), dt, count)


def test_vibrating_bar_follows_its_mode_with_second_order():
    errors = []
    for dt in (0.02, 0.01):
        s, state = bar(dt, round(2.0 / dt))  # half a period
        exact = -1e-3 * np.sin(np.pi * s.mesh.points[:, 0] / 2.0)
        errors.append(np.abs(state.displacement[:, 0] - exact).max() / 1e-3)
    assert errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)


def test_vibrating_bar_keeps_its_energy_but_for_the_damping_of_the_scheme():
    s, state = bar(0.01, 0)
    K = s.equations.tangent(
        s.equations.gradient(state.displacement), s.equations.stress(s.equations.gradient(state.displacement)), 0.0, []
    )

    def energy(state):
        d, v = state.displacement, state.velocity
        return 0.5 * np.sum(v * (s.equations.mass @ v)) + 0.5 * np.sum(d * s.equations.applied(K, d))

    energies = [energy(state)]
    exact = 0.1 * 3.0 * 1e-6 * (np.pi / 2.0) ** 2 / 4.0
    assert energies[0] == pytest.approx(exact, rel=1e-9)
    for _ in range(4):
        state = march(s, state, 0.01, 50)
        energies.append(energy(state))
    assert (np.diff(energies) < 0.0).all()
    assert energies[-1] > 0.995 * energies[0]


def test_linear_solid_is_factorised_once_for_all_steps():
    s, _ = bar(0.01, 20)
    assert s.counts.assemblies == s.counts.factorisations == 2  # one for the first step of first order
    assert s.counts.solves <= 40


def test_changed_step_size_keeps_the_velocity_consistent():
    mesh = rectangle(1, 1, 1)
    s = solver(mesh, [displacement(AROUND, "t*t", "3*t")])
    state = SolidState(
        (np.tile([1.0, 3.0], (len(mesh.points), 1)), np.tile([0.81, 2.7], (len(mesh.points), 1))),
        (np.tile([2.0, 3.0], (len(mesh.points), 1)), np.tile([1.8, 3.0], (len(mesh.points), 1))),
        1.0,
    )
    step = s.begin_step(state, [0.3, 0.1], 1.3)
    after = step.accept(step.solve())
    np.testing.assert_allclose(after.displacement, np.tile([1.69, 3.9], (len(mesh.points), 1)), atol=1e-9)
    np.testing.assert_allclose(after.velocity, np.tile([2.6, 3.0], (len(mesh.points), 1)), atol=1e-9)
    assert len(after.displacements) == 2
    assert after.time == 1.3


@pytest.mark.parametrize("guess", ["state", "velocity"])
def test_thin_plate_swings_through_large_deflections_without_failure(guess):
    s, tip = plate(body_force=pair(0, -10))
    deflection = []
    state, dt = s.initial_state(), 0.02
    for k in range(25):
        step = s.begin_step(state, [dt, dt], (k + 1) * dt)
        start = None if guess == "state" else state.displacement + dt * state.velocity
        state = step.accept(step.solve(guess=start))
        deflection.append(state.displacement[tip, 1])
    assert min(deflection) < -0.65
    assert s.counts.factorisations <= 4 * 25
    assert s.counts.iterations <= 10 * 25


def test_thrown_plate_deflects_more_than_a_quarter_of_its_length():
    s, tip = plate(body_force=pair(0, -100))
    state = march(s, s.initial_state(), 0.02, 15, guess=lambda state: state.displacement + 0.02 * state.velocity)
    assert state.displacement[tip, 1] < -1.0
    assert s.equations.lowest_volume_ratio(state.displacement) > 0.9


def test_later_solutions_of_a_step_reuse_the_tangent():
    s, tip = plate(body_force=pair(0, -10))
    state = march(s, s.initial_state(), 0.005, 5)
    step = s.begin_step(state, [0.005, 0.005], state.time + 0.005)
    load = np.zeros(s.mesh.points.shape)
    d = step.solve(load)
    before = replace(s.counts)
    for k in range(1, 4):
        load[tip, 1] = 0.002 * 0.1**k
        d = step.solve(load, d)
    assert s.counts.factorisations == before.factorisations
    assert s.counts.iterations - before.iterations <= 12
    fresh = s.begin_step(state, [0.005, 0.005], state.time + 0.005).solve(load)
    np.testing.assert_allclose(d, fresh, atol=1e-9)


def test_loose_tolerance_saves_iterations():
    s, _ = plate(body_force=pair(0, -10))
    state = march(s, s.initial_state(), 0.01, 3)
    counts = []
    for tolerance in (1e-3, None):
        before = s.counts.iterations
        s.begin_step(state, [0.01, 0.01], state.time + 0.01).solve(tolerance=tolerance)
        counts.append(s.counts.iterations - before)
    assert counts[0] < counts[1]


def test_reaction_of_a_moving_solid_contains_its_inertia():
    mesh = rectangle(2)
    s = solver(mesh, [displacement(AROUND, "t*t", 0)])
    state = SolidState((np.zeros(mesh.points.shape),) * 2, (np.zeros(mesh.points.shape),) * 2, 0.0)
    state = march(s, state, 0.1, 12)
    step = s.begin_step(state, [0.1, 0.1], state.time + 0.1)
    reaction = step.reaction(step.solve())
    # The inner nodes accelerate with the frame: all in all ρ · area · 2.
    np.testing.assert_allclose(reaction.sum(axis=0), [2.0 * RHO, 0.0], rtol=5e-2, atol=1e-9)


def test_initial_fields_are_expressions_and_states_cannot_be_written():
    mesh = rectangle(2)
    s = solver(mesh, [], initial_displacement=initial("x*y", 2), initial_velocity=initial(0, "x"))
    state = s.initial_state(3.0)
    np.testing.assert_allclose(state.displacement[:, 0], mesh.points.prod(axis=1))
    np.testing.assert_array_equal(state.displacement[:, 1], 2.0)
    np.testing.assert_allclose(state.velocity[:, 1], mesh.points[:, 0])
    assert state.time == 3.0
    with pytest.raises(ValueError, match="read-only"):
        state.displacement[0] = 1.0


def test_starting_value_does_not_change_the_result():
    s, tip = plate(body_force=pair(0, -10))
    state = march(s, s.initial_state(), 0.01, 3)
    results = [
        s.begin_step(state, [0.01, 0.01], state.time + 0.01).solve(guess=guess)
        for guess in (None, state.displacement + 0.01 * state.velocity, 0.5 * state.displacement)
    ]
    for d in results[1:]:
        np.testing.assert_allclose(d[tip], results[0][tip], rtol=1e-7)
