"""Forces on parts of the boundary: exact where the flow is, conservative, right at the ends of open edges."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from hoblock import Arc, BlockStructure, generate
from hofsi import case
from hofsi.errors import CaseError
from hofsi.fem.geometry import physical_gradients, side_geometry
from hofsi.solvers.fluid_forces import BoundaryForce

NOBODY = np.zeros((0, 2))
VISCOSITY, LENGTH = 0.1, 3.0
DROP = 8.0 * VISCOSITY * LENGTH
PROFILE = "4*y*(1 - y)"
SHEAR = 4.0 * VISCOSITY * LENGTH  # on each wall


def poiseuille(flows, order, outlet, turn=0.0):
    """Conditions of Poiseuille flow in a channel of length 3, and the pressure at the outlet."""
    Q = flows.rotation(turn)
    depth = f"({Q[1, 1]}*y + ({Q[0, 1]})*x)"
    inlet = flows.velocity("left", *(f"({Q[a, 0]})*4*{depth}*(1 - {depth})" for a in range(2)))
    walls = case.NoSlip(("top", "bottom"))
    level, last = {
        "do-nothing": (0.0, case.DoNothing(("right",))),
        "traction": (1.5, flows.traction("right", -1.5, "0.1*4*(1 - 2*y)")),
        "parallel": (1.5, flows.velocity("right", None, 0, traction_x=-1.5)),
        "given": (0.0, flows.velocity("right", PROFILE, 0)),
    }[outlet]
    mesh = flows.grid(order, 4, 3, size=(LENGTH, 1.0), turn=turn)
    solver = flows.solver(mesh, [inlet, walls, last], viscosity=VISCOSITY)
    if outlet == "given":
        level = -DROP / 2.0  # zero mean
    return solver, flows.steady(solver), level


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize("outlet", ["do-nothing", "traction", "parallel", "given"])
def test_every_side_of_a_channel_feels_its_share(flows, order, outlet):
    solver, state, level = poiseuille(flows, order, outlet)
    mean = level + DROP / 2.0
    expected = {
        "bottom": (SHEAR, -LENGTH * mean),
        "top": (SHEAR, LENGTH * mean),
        "left": (-(level + DROP), 0.0),
        "right": (level, 0.0),
    }
    for name, force in expected.items():
        computed = BoundaryForce(solver, [name]).evaluate(state)
        np.testing.assert_allclose(computed, force, rtol=0.0, atol=1e-11, err_msg=name)
    both = BoundaryForce(solver, ["bottom", "top"]).evaluate(state)
    np.testing.assert_allclose(both, [2.0 * SHEAR, 0.0], rtol=0.0, atol=1e-11)


def test_the_bare_residual_of_an_open_wall_would_be_wrong(flows):
    solver, state, _ = poiseuille(flows, 2, "do-nothing")
    bare = -state.reaction[solver.mesh.edge_nodes("bottom"), 0].sum()
    assert abs(bare - SHEAR) > 0.05 * SHEAR


def test_forces_turn_with_the_channel(flows):
    turn = 0.6
    solver, state, _ = poiseuille(flows, 3, "do-nothing", turn)
    wall = BoundaryForce(solver, ["bottom"]).evaluate(state)
    expected = flows.rotation(turn) @ [SHEAR, -LENGTH * DROP / 2.0]
    np.testing.assert_allclose(wall, expected, rtol=0.0, atol=1e-11)


def test_slip_walls_at_the_ends_of_a_wall_and_of_their_own(flows):
    # Half of the profile: the top is a line of symmetry, inclined, so that its traction is normal in a turned frame.
    turn = 0.4
    Q = flows.rotation(turn)
    depth = f"({Q[1, 1]}*y + ({Q[0, 1]})*x)"
    inlet = flows.velocity("left", *(f"({Q[a, 0]})*{depth}*(2 - {depth})" for a in range(2)))
    conditions = [inlet, case.NoSlip(("bottom",)), case.Slip(("top",)), case.DoNothing(("right",))]
    solver = flows.solver(flows.grid(3, 4, 3, size=(LENGTH, 1.0), turn=turn), conditions, viscosity=VISCOSITY)
    state = flows.steady(solver)
    drop = 2.0 * VISCOSITY * LENGTH
    expected = {
        "bottom": (2.0 * VISCOSITY * LENGTH, -LENGTH * drop / 2.0),
        "top": (0.0, LENGTH * drop / 2.0),
        "left": (-drop, VISCOSITY),
    }
    for name, force in expected.items():
        computed = Q.T @ BoundaryForce(solver, [name]).evaluate(state)
        np.testing.assert_allclose(computed, force, rtol=0.0, atol=1e-11, err_msg=name)


def test_half_of_a_symmetric_flow_carries_half_of_the_forces(flows):
    # Coarse on purpose: the symmetry of the discrete solutions is exact, the shear at the line of symmetry is not zero.
    profile = "9*y*(2 - y)*exp(-3*(y - 1)**2)"
    inlet, outlet = flows.velocity("left", profile, 0), case.DoNothing(("right",))
    conditions = [inlet, case.NoSlip(("bottom",)), case.Slip(("top",)), outlet]
    half = flows.solver(flows.rectangle(2, 4, 2, high=(2.0, 1.0)), conditions, viscosity=0.3)
    conditions = [inlet, case.NoSlip(("bottom", "top")), outlet]
    whole = flows.solver(flows.rectangle(2, 4, 4, high=(2.0, 2.0)), conditions, viscosity=0.3)
    first, second = flows.steady(half), flows.steady(whole)
    for name in ("left", "right", "bottom"):
        full = BoundaryForce(whole, [name]).evaluate(second)[0] * (1.0 if name == "bottom" else 0.5)
        assert BoundaryForce(half, [name]).evaluate(first)[0] == pytest.approx(full, abs=1e-11), name


def test_pressure_outlet_carries_its_pressure(flows):
    conditions = [flows.velocity("left", 2, 0), case.Slip(("top", "bottom")), flows.pressure("right", 4.25)]
    solver = flows.solver(flows.grid(2, size=(2.0, 1.0)), conditions)
    state = flows.steady(solver)
    expected = {"right": (4.25, 0.0), "left": (-4.25, 0.0), "top": (0.0, 8.5), "bottom": (0.0, -8.5)}
    for name, force in expected.items():
        computed = BoundaryForce(solver, [name]).evaluate(state)
        np.testing.assert_allclose(computed, force, rtol=0.0, atol=1e-11, err_msg=name)


def test_weight_of_a_fluid_at_rest_lies_on_the_floor(flows):
    # Zero mean pressure: +1 at the bottom, -1 at the top, and the sides pull nothing.
    solver = flows.solver(flows.grid(3), [case.NoSlip(flows.around)], body_force=("0", "-2"))
    state = flows.steady(solver)
    expected = {"bottom": (0.0, -1.0), "top": (0.0, -1.0), "left": (0.0, 0.0), "right": (0.0, 0.0)}
    for name, force in expected.items():
        computed = BoundaryForce(solver, [name]).evaluate(state)
        np.testing.assert_allclose(computed, force, rtol=0.0, atol=1e-12, err_msg=name)
    np.testing.assert_allclose(BoundaryForce(solver, flows.around).evaluate(state), [0.0, -2.0], rtol=0.0, atol=1e-12)


def test_forces_on_the_wetted_side_of_a_solid(flows):
    mesh = flows.grid(3)
    top = mesh.edge_nodes("top")
    conditions = [case.NoSlip(("left", "right", "bottom"))]
    solver = flows.solver(mesh, conditions, body_force=("0", "-2"), interface=top)
    step = solver.begin_steady(solver.initial_state(), mesh.points)
    step.solve(np.zeros((len(top), 2)))
    force = BoundaryForce(solver, ["top"]).evaluate(step.accept())
    np.testing.assert_allclose(force, [0.0, -1.0], rtol=0.0, atol=1e-12)


def test_moving_walls_push_with_mass_times_acceleration(flows):
    # Plug flow u = t between slip walls whose mesh slides along: p falls by ρ a unit length.
    mesh = flows.grid(2, size=(2.0, 1.0))
    conditions = [flows.velocity("left", "t", 0), case.Slip(("top", "bottom")), flows.pressure("right", 0)]
    solver = flows.solver(mesh, conditions, density=3.0)
    state = flows.march(solver, solver.initial_state(), (0.1, 0.2), lambda t: mesh.points + t * np.array([0.5, 0.0]))
    np.testing.assert_allclose(BoundaryForce(solver, ["left"]).evaluate(state), [-6.0, 0.0], rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(BoundaryForce(solver, ["top"]).evaluate(state), [0.0, 6.0], rtol=0.0, atol=1e-11)


# A body in a stream ---------------------------------------------------------------------------------------------------


def stream(flows, order):
    """Flow past a cylinder off the axis of a square."""
    angle = np.pi / 4.0 * np.array([-3.0, -1.0, 1.0, 3.0])
    circle = [0.1, 0.15] + 0.3 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    vertices = np.concatenate([circle, [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]])
    ring = [(k, (k + 1) % 4) for k in range(4)]
    names = {
        "cylinder": ring,
        **{name: [(4 + a, 4 + b)] for name, (a, b) in zip(("bottom", "right", "top", "left"), ring, strict=True)},
    }
    curves = {pair: Arc.from_center((0.1, 0.15), vertices[pair[0]], vertices[pair[1]]) for pair in ring}
    quads = {"fluid": [(a, 4 + a, 4 + b, b) for a, b in ring]}
    structure = BlockStructure.build(vertices, quads, edges=names, curves=curves, counts=2)
    conditions = [
        flows.velocity("left", "1 - y**2", 0),
        case.NoSlip(("top", "bottom", "cylinder")),
        case.DoNothing(("right",)),
    ]
    solver = flows.solver(generate(structure, order), conditions, viscosity=0.05)
    return solver, flows.steady(solver)


def stress_integral(solver, state, name):
    """-∫ σ·n on named edges from the computed fields."""
    space, total = solver.space, np.zeros(2)
    X = state.points[0][space.velocity_cells]
    for side in side_geometry(X, solver.mesh.edge_groups[name], space.velocity_sides):
        u = state.velocity[space.velocity_cells[side.elements]]
        p = state.pressure[space.pressure_cells[side.elements]] @ space.pressure_sides[side.number].N.T
        gradient = np.stack([dN @ u for dN in physical_gradients(side, side.table)], axis=-1)
        stress = 0.05 * (gradient + gradient.swapaxes(2, 3)) - p[..., None, None] * np.eye(2)
        total -= np.einsum("kqab,kqb->a", stress, side.normals)
    return total


def test_residual_and_stress_agree_and_the_residual_is_far_better(flows):
    solver, state = stream(flows, 10)
    reference = BoundaryForce(solver, ["cylinder"]).evaluate(state)
    assert reference[0] > 1.0
    np.testing.assert_allclose(stress_integral(solver, state, "cylinder"), reference, rtol=0.0, atol=2e-4)
    solver, state = stream(flows, 8)
    by_residual = np.abs(BoundaryForce(solver, ["cylinder"]).evaluate(state) - reference).max()
    by_stress = np.abs(stress_integral(solver, state, "cylinder") - reference).max()
    assert by_residual < 0.05 * by_stress
    assert by_residual < 1e-5


def test_a_closed_contour_needs_no_correction(flows):
    solver, state = stream(flows, 3)
    force = BoundaryForce(solver, ["cylinder"])
    bare = -state.reaction[solver.mesh.edge_nodes("cylinder")].sum(axis=0)
    np.testing.assert_array_equal(force.evaluate(state), bare)


def test_all_forces_together_balance_the_momentum(flows):
    solver, state = stream(flows, 6)
    names = ["left", "right", "top", "bottom", "cylinder"]
    total = BoundaryForce(solver, names).evaluate(state)
    parts = sum(BoundaryForce(solver, [name]).evaluate(state) for name in names)
    np.testing.assert_allclose(parts, total, rtol=0.0, atol=1e-2)  # the corners' shares are integrated
    space, geometry = solver.space, solver.geometry(state.points[0])
    gradients = physical_gradients(geometry, space.velocity)
    u = state.velocity[space.velocity_cells]
    gradient = np.stack([dN @ u for dN in gradients], axis=-1)
    inertia = np.einsum("eq,eqab,eqb->a", geometry.weights, gradient, space.velocity.N @ u)
    np.testing.assert_allclose(total, -inertia, rtol=0.0, atol=1e-10)
    # ∫ ρ u·∇u is what flows out less what flows in, but for what is left of ∇·u.
    y, w = leggauss(6)
    flux = -np.array([w @ (1.0 - y**2) ** 2, 0.0])
    X = state.points[0][space.velocity_cells]
    for side in side_geometry(X, solver.mesh.edge_groups["right"], space.velocity_sides):
        at = side.table.N @ u[side.elements]
        flux += np.einsum("kqa,kqb,kqb->a", at, at, side.normals)
    np.testing.assert_allclose(inertia, flux, rtol=0.0, atol=2e-2)


# Names ----------------------------------------------------------------------------------------------------------------


def test_sides_named_twice_count_once(flows):
    solver, state, _ = poiseuille(flows, 2, "do-nothing")
    once, twice = (BoundaryForce(solver, names).evaluate(state) for names in (["bottom"], ["bottom", "bottom"]))
    np.testing.assert_array_equal(twice, once)


def test_unknown_names_are_reported(flows):
    solver, _, _ = poiseuille(flows, 2, "do-nothing")
    with pytest.raises(CaseError, match=r"no edges named 'flag' at the fluid; known: bottom, left, right, top"):
        BoundaryForce(solver, ["flag"])


def test_edges_inside_the_fluid_are_reported(flows):
    vertices = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (2, 1), "e": (1, 1), "f": (0, 1)}
    edges = {"middle": [("b", "e")], "around": [("a", "b"), ("b", "c"), ("c", "d"), ("d", "e"), ("e", "f"), ("f", "a")]}
    quads = {"fluid": [("a", "b", "e", "f"), ("b", "c", "d", "e")]}
    structure = BlockStructure.build(vertices, quads, edges=edges, counts=2)
    solver = flows.solver(generate(structure, 2), [case.NoSlip(("around",))])
    with pytest.raises(CaseError, match="2 element sides of middle have the fluid on both sides"):
        BoundaryForce(solver, ["middle"])


@pytest.mark.parametrize("outlet", ["do-nothing", "traction", "parallel", "given"])
def test_every_side_of_a_channel_has_its_moment(flows, outlet):
    """Pressure falls linearly, shear is the same everywhere: moments about a point far from everything."""
    solver, state, level = poiseuille(flows, 3, outlet)
    about = np.array([-0.7, 0.4])
    mean = level + DROP / 2.0
    lever = LENGTH / 2.0 + 0.7
    tilt = DROP / LENGTH * LENGTH**3 / 12.0  # of the pressure along a wall about its middle
    expected = {
        "bottom": -LENGTH * mean * lever + tilt + 0.4 * SHEAR,
        "top": LENGTH * mean * lever - tilt - 0.6 * SHEAR,
        "left": (level + DROP) * (0.5 - 0.4),
        "right": -level * (0.5 - 0.4),
    }
    # On upright sides the shear of the profile has no resultant, but none of it acts across the lever either.
    for name in ("bottom", "top", "left", "right"):
        computed = BoundaryForce(solver, [name]).moment(state, about)
        assert computed == pytest.approx(expected[name], abs=1e-11), name


def test_the_moment_changes_with_the_point_as_that_of_a_force_does(flows):
    solver, state, _ = poiseuille(flows, 2, "do-nothing")
    wall = BoundaryForce(solver, ["bottom"])
    force = wall.evaluate(state)
    shift = np.array([0.3, -1.1])
    change = wall.moment(state, shift) - wall.moment(state, np.zeros(2))
    assert change == pytest.approx(-(shift[0] * force[1] - shift[1] * force[0]), abs=1e-12)


@pytest.mark.parametrize("order", [3, 5])
def test_moment_between_cylinders_that_turn(flows, order):
    """Couette's flow: 4 π μ ω r₁² r₂²/(r₂² - r₁²) on the inner one, the same the other way round outside."""
    conditions = [flows.velocity("inner", "-y", "x"), case.NoSlip(("outer",))]
    # Convection in advective form conserves angular momentum only as well as the velocity is free of divergence.
    solver = flows.solver(flows.annulus(order, sectors=8, rings=3), conditions, viscosity=0.2, model="stokes")
    state = flows.steady(solver)
    exact = 4.0 * np.pi * 0.2 * 0.25 / 0.75
    inner, outer = (BoundaryForce(solver, [name]).moment(state, np.array([0.0, 0.0])) for name in ("inner", "outer"))
    assert inner == pytest.approx(-exact, rel={3: 2e-4, 5: 1e-6}[order])
    assert inner + outer == pytest.approx(0.0, abs=1e-11)  # angular momentum is conserved
