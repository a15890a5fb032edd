"""Forces of solids on their supports and loads."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.build import build
from hofsi.errors import CaseError
from hofsi.io.scene import load_case
from hofsi.quantities import evaluators
from hofsi.simulate import simulate
from hofsi.solvers.solid import SolidSolver
from hofsi.solvers.solid_forces import SolidForce

CSM1 = Path(__file__).parents[4] / "examples" / "csm1.toml"
SIDES = ("bottom", "right", "top", "left")


def expression(text):
    return compile_expression(str(text), ("x", "y", "t"))


def given(on, x=None, y=None):
    return case.Displacement((on,), *(None if c is None else expression(c) for c in (x, y)))


def solver(mesh, boundaries, **changes):
    values = {"density": 2.0, "youngs_modulus": 1e3, "poissons_ratio": 0.3} | changes
    body = case.Solid(name="block", blocks=tuple(mesh.cell_groups), boundaries=tuple(boundaries), **values)
    return SolidSolver(mesh, [body], case.NonlinearSettings(1e-12))


def rectangle(order=3, columns=3, rows=2, size=(2.0, 1.0), turn=0.0):
    c, s = np.cos(turn), np.sin(turn)
    corners = np.array([(0.0, 0.0), (size[0], 0.0), size, (0.0, size[1])]) @ np.array([[c, s], [-s, c]])
    edges = {name: [(k, (k + 1) % 4)] for k, name in enumerate(SIDES)}
    edges["around"] = [pair for (pair,) in list(edges.values())]
    counts = {(0, 1): columns, (1, 2): rows}
    return generate(BlockStructure.build(corners, {"solid": [(0, 1, 2, 3)]}, counts=counts, edges=edges), order)


def at_rest(s):
    step = s.begin_static()
    return step.accept(step.solve())


def force(s, state, *names):
    return SolidForce(s, names).evaluate(state)


def test_the_clamp_of_csm1_carries_the_weight_of_the_flag():
    asked = load_case(CSM1)
    quantities = tuple(case.Force(f"F_{c}", ("clamp",), c) for c in ("x", "y"))
    problem = build(replace(asked, quantities=(*quantities, case.Force("none", ("flag",), "y", 7.0))))
    (record,) = simulate(problem)
    found = {name: evaluate(record) for name, evaluate in evaluators(problem).items()}
    weight = -2.0 * problem.solid.solver.equations.mass.sum()
    assert weight == pytest.approx(-2000.0 * 0.007006707, rel=1e-5)  # 0.4 × 0.02 without a part of the disk
    assert found["F_y"] == pytest.approx(weight, rel=1e-9)
    assert found["F_x"] == pytest.approx(0.0, abs=1e-9 * abs(weight))
    assert found["none"] == 0.0


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff", "neo-hooke"])
def test_momentum_is_balanced_in_every_step(model):
    pull = case.Traction(("right",), expression("10*sin(3*t)"), expression("-5*t"))
    mesh = rectangle()
    s = solver(mesh, [given("left", 0, 0), pull], model=model, body_force=(expression(0), expression("-4*x")))
    state, steps = s.initial_state(), []
    clamp, momentum = SolidForce(s, ("left",)), [np.zeros(2), np.zeros(2)]
    for k in range(1, 9):
        steps = [0.05, *steps][:2]
        step = s.begin_step(state, steps, 0.05 * k)
        state = step.accept(step.solve())
        momentum = [(s.equations.mass @ state.velocity).sum(axis=0), *momentum][:3]
        weights = (1.0, -1.0, 0.0) if k == 1 else (1.5, -2.0, 0.5)
        rate = sum(w * m for w, m in zip(weights, momentum, strict=True)) / 0.05
        t = state.time
        applied = np.array([10.0 * np.sin(3.0 * t), -5.0 * t - 8.0])
        np.testing.assert_allclose(clamp.evaluate(state), applied - rate, atol=1e-8)
        np.testing.assert_allclose(force(s, state, "right"), [-10.0 * np.sin(3.0 * t), 5.0 * t], rtol=1e-12)
    assert np.abs(rate).max() > 0.1


def test_a_load_is_what_the_surroundings_do_and_the_force_its_opposite():
    mesh = rectangle()
    push = case.Pressure(("top",), expression(3.0))
    s = solver(mesh, [given("left", 0, 0), push])
    state = at_rest(s)
    ends = (mesh.points + state.displacement)[mesh.edge_nodes("top")]
    first, last = ends[np.argmin(ends[:, 0])], ends[np.argmax(ends[:, 0])]
    expected = 3.0 * np.array([first[1] - last[1], last[0] - first[0]])
    np.testing.assert_allclose(force(s, state, "top"), expected, rtol=1e-12)
    assert force(s, state, "top")[1] > 0.0
    np.testing.assert_allclose(force(s, state, "left"), -expected, rtol=1e-8)
    np.testing.assert_array_equal(force(s, state, "right", "bottom"), 0.0)


def corners():
    """Clamps that meet, a roller at a clamp, and a given component."""
    around = [given("left", 0, 0), given("bottom", 0, 0), case.Roller(("right",)), given("top", None, "0.05*x")]
    return rectangle(), around, {"body_force": (expression("3*x"), expression("-2*y"))}


def test_forces_on_parts_add_up_to_that_on_all():
    mesh, around, loads = corners()
    s = solver(mesh, around, **loads)
    state = at_rest(s)
    parts = np.array([force(s, state, name) for name in SIDES])
    np.testing.assert_allclose(parts.sum(axis=0), force(s, state, "around"), rtol=1e-11)
    np.testing.assert_allclose(force(s, state, "around"), [6.0, -2.0], rtol=1e-7)
    np.testing.assert_allclose(parts[0] + parts[3], force(s, state, "left", "bottom"), rtol=1e-9)
    assert parts[1, 1] == pytest.approx(0.0, abs=1e-12)  # the roller on the right has no friction
    assert parts[2, 0] == 0.0  # at the top x is free


def test_divided_corners_converge():
    _, around, loads = corners()
    found = []
    for count in (2, 4, 12):
        s = solver(rectangle(3, 2 * count, count), around, **loads)
        found.append(force(s, at_rest(s), "left"))
    errors = [np.abs(f - found[-1]).max() for f in found[:-1]]
    assert errors[0] < 0.02 * np.abs(found[-1]).max()
    assert errors[1] < 0.6 * errors[0]


def test_uniform_stress_gives_exact_forces_on_every_side():
    """Corners shared by two clamps take the integrals of the stress, which are exact here."""
    F, e, nu = np.array([[1.05, 0.1], [-0.02, 0.9]]), 1e3, 0.3
    mesh = rectangle(turn=0.4)
    s = solver(mesh, [given(name, "0.05*x + 0.1*y", "-0.02*x - 0.1*y") for name in SIDES])
    state = at_rest(s)
    E = (F.T @ F - np.eye(2)) / 2.0
    S = e * nu / ((1 + nu) * (1 - 2 * nu)) * np.trace(E) * np.eye(2) + e / (1 + nu) * E
    c, sine = np.cos(0.4), np.sin(0.4)
    np.testing.assert_allclose(force(s, state, "right"), -(F @ S) @ [c, sine], rtol=1e-9)
    np.testing.assert_allclose(force(s, state, "top"), -2.0 * (F @ S) @ [-sine, c], rtol=1e-9)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_rollers_that_meet_share_a_corner_by_direction(turn):
    c, s_ = np.cos(turn), np.sin(turn)
    load = np.array([[c, -s_], [s_, c]]) @ [-3.0, -5.0]
    s = solver(
        rectangle(turn=turn), [case.Roller(("bottom", "left"))], body_force=(expression(load[0]), expression(load[1]))
    )
    state = at_rest(s)
    np.testing.assert_allclose(force(s, state, "left"), 6.0 * np.array([-c, -s_]), atol=1e-8)
    np.testing.assert_allclose(force(s, state, "bottom"), 10.0 * np.array([s_, -c]), atol=1e-8)


def test_symmetry_planes_of_a_ring_carry_its_hoop_stress():
    vertices = {"a": (1.0, 0.0), "b": (2.0, 0.0), "c": (0.0, 2.0), "d": (0.0, 1.0)}
    curves = {
        ends: Arc.from_center((0.0, 0.0), vertices[ends[0]], vertices[ends[1]]) for ends in (("b", "c"), ("a", "d"))
    }
    edges = {"bottom": [("a", "b")], "outer": [("b", "c")], "left": [("c", "d")], "inner": [("d", "a")]}
    structure = BlockStructure.build(vertices, {"solid": [("a", "b", "c", "d")]}, counts=2, curves=curves, edges=edges)
    push = case.Pressure(("inner",), expression(4.0))
    s = solver(generate(structure, 6), [case.Roller(("bottom", "left")), push], model="linear")
    state = at_rest(s)
    np.testing.assert_allclose(force(s, state, "bottom"), [0.0, 4.0], atol=1e-8)  # ∫ σ_φ dr = p a
    np.testing.assert_allclose(force(s, state, "inner"), [-4.0, -4.0], rtol=1e-8)


def test_what_cannot_be_evaluated_is_refused():
    s = solver(rectangle(), [given("left", 0, 0)])
    with pytest.raises(CaseError, match="no edges named 'lft' at the solid; known: around, bottom, left, right, top"):
        SolidForce(s, ("lft",))
    with pytest.raises(ValueError, match="reaction of an initial state is not known"):
        force(s, s.initial_state(), "left")


def test_reactions_cannot_be_written():
    state = at_rest(solver(rectangle(), [given("left", 0, 0), case.Pressure(("top",), expression(1.0))]))
    with pytest.raises(ValueError, match="read-only"):
        state.reaction[0] = 1.0
