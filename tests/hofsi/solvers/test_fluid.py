"""The fluid: flows whose solutions are known, and what moves with the mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hofsi import case
from hofsi.fem.geometry import physical_gradients
from hofsi.solvers.fluid import FluidState

LINEAR = ("linearised", "extrapolated")
MODES = ("newton", "picard", "linearised", "extrapolated")


def rate(errors, ratio=2.0):
    return np.log(errors[-2] / errors[-1]) / np.log(ratio)


# Moving meshes --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("sizes", [(0.1,) * 4, (0.1, 0.07, 0.15, 0.05)])
def test_constant_flow_stays_constant_on_a_moving_mesh(flows, mode, sizes):
    mesh = flows.rectangle(3, 3, 2, bend=0.03)
    conditions = [flows.velocity(("left", "top", "bottom"), 1.3, -0.7), flows.traction("right", 0, 0)]
    solver = flows.solver(
        mesh, conditions, density=2.0, viscosity=0.05, convection=mode, initial_velocity=("1.3", "-0.7")
    )
    state = solver.initial_state(0.0, flows.wobble(mesh.points, 0.0))
    # A wrong pressure to start from, so that the solver has something to do.
    state = replace(state, pressure=np.random.default_rng(5).standard_normal(state.pressure.shape))
    state = flows.march(solver, state, sizes, lambda t: flows.wobble(mesh.points, t), linear=mode in LINEAR)
    assert solver.counts.factorisations >= 1
    np.testing.assert_allclose(state.velocity, np.broadcast_to([1.3, -0.7], state.velocity.shape), rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(state.pressure, 0.0, atol=1e-11)


def test_mesh_velocity_is_the_backward_difference_of_the_positions(flows):
    mesh = flows.rectangle(2, 2, 2)
    solver = flows.solver(mesh, [case.NoSlip(flows.around)])
    sizes = (0.1, 0.25)
    old = FluidState(
        (np.zeros(mesh.points.shape),) * 2,
        np.zeros(solver.space.pressure_count),
        (flows.wobble(mesh.points, 0.25), flows.wobble(mesh.points, 0.0)),
        np.zeros(mesh.points.shape),
        0.25,
    )
    step = solver.begin_step(old, flows.wobble(mesh.points, 0.35), sizes, 0.35, convection="newton")
    a, b, c = (flows.wobble(mesh.points, t) for t in (0.35, 0.25, 0.0))
    # Derivative at 0.35 of the parabola through the three positions, by divided differences.
    first, second = (a - b) / 0.1, (b - c) / 0.25
    np.testing.assert_allclose(step.mesh_velocity, first + 0.1 * (first - second) / 0.35, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("mode", MODES)
def test_a_box_that_is_pushed_carries_its_fluid_along(flows, mode):
    # Positions of second degree in time, velocities of first: the backward differences are exact.
    a, density = np.array([0.8, -0.3]), 2.5
    mesh = flows.grid(3)
    solver = flows.solver(mesh, [case.NoSlip(flows.around)], density=density, viscosity=0.1, convection=mode)

    def at(t):
        return mesh.points + a * t**2 / 2.0

    still = np.ones(mesh.points.shape)
    state = FluidState(
        (0.3 * a * still, 0.1 * a * still), np.zeros(solver.space.pressure_count), (at(0.3), at(0.1)), 0.0 * still, 0.3
    )
    state = flows.march(solver, state, (0.2, 0.25), at, linear=mode in LINEAR, steps=(0.2,))
    np.testing.assert_allclose(state.velocity, state.time * a * still, rtol=0.0, atol=1e-11)
    middle = at(state.time).min(axis=0) + 0.5
    pressure = f"-{density}*({a[0]}*(x - {middle[0]}) + {a[1]}*(y - {middle[1]}))"
    assert flows.pressure_error(solver, state, pressure) < 1e-10
    # The walls push the fluid: mass times acceleration.
    np.testing.assert_allclose(state.reaction.sum(axis=0), density * a, rtol=0.0, atol=1e-10)


def test_slip_walls_carry_the_fluid_along_at_a_right_angle_only(flows):
    # A slip box in uniform motion around fluid at rest relative to x: only the normal velocity is imposed.
    mesh = flows.grid(2)
    solver = flows.solver(
        mesh,
        [case.Slip(("top", "bottom")), flows.velocity("left", 0.4, "0.9"), flows.traction("right", 0, 0)],
        initial_velocity=("0.4", "0.9"),
    )
    drift = np.array([-1.7, 0.9])
    state = flows.march(solver, solver.initial_state(), (0.1, 0.1, 0.2), lambda t: mesh.points + t * drift)
    np.testing.assert_allclose(state.velocity, np.broadcast_to([0.4, 0.9], state.velocity.shape), rtol=0.0, atol=1e-12)


# Exact solutions ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [2, 3, 5])
@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_linear_velocity_on_curved_elements_is_exact(flows, order, model):
    # u = G x with tr G = 0: u·∇u = G² x, balanced by a body force with p = 0.
    G = np.array([[0.4, 1.1], [-0.6, -0.4]])
    x, y = ("0.4*x + 1.1*y", "-0.6*x - 0.4*y")
    H = 3.0 * G @ G if model == "navier-stokes" else np.zeros((2, 2))
    force = tuple(f"{row[0]}*x + ({row[1]})*y" for row in H)
    mesh = flows.rectangle(order, 3, 2, bend=0.06)
    stress = 0.2 * (G + G.T)
    conditions = [flows.velocity(("left", "bottom", "top"), x, y), flows.traction("right", *stress[:, 0])]
    solver = flows.solver(mesh, conditions, density=3.0, viscosity=0.2, body_force=force, model=model)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, mesh.points @ G.T, rtol=0.0, atol=1e-11)
    assert np.abs(state.pressure).max() < 1e-11


class Poiseuille:
    """u = 4 y (1 - y) in a channel of length 3; p falls by 8 μ a unit length."""

    viscosity, length = 0.1, 3.0
    drop = 8.0 * 0.1 * 3.0

    @classmethod
    def conditions(cls, flows, outlet):
        inlet = flows.velocity("left", flows.parabola, 0)
        walls = case.NoSlip(("top", "bottom"))
        if outlet == "do-nothing":
            return 0.0, [inlet, walls, case.DoNothing(("right",))]
        if outlet == "traction":  # σ·n = (-p, μ ∂u/∂y)
            return 1.5, [inlet, walls, flows.traction("right", -1.5, "0.1*4*(1 - 2*y)")]
        free = flows.velocity("right", None, 0, traction_x=-1.5)
        if outlet == "parallel":
            return 1.5, [inlet, walls, free]
        return 1.5, [flows.velocity("left", None, 0, traction_x=1.5 + cls.drop), walls, free]


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize("outlet", ["do-nothing", "traction", "parallel", "pressure drop"])
def test_poiseuille_flow_is_exact(flows, order, outlet):
    level, conditions = Poiseuille.conditions(flows, outlet)
    solver = flows.solver(flows.grid(order, 4, 3, size=(3.0, 1.0)), conditions, viscosity=Poiseuille.viscosity)
    state = flows.steady(solver)
    expected = flows.field(state.points[0], flows.parabola, 0)
    np.testing.assert_allclose(state.velocity, expected, rtol=0.0, atol=1e-12)
    assert flows.pressure_error(solver, state, f"{level} + 0.8*(3 - x)") < 1e-11


def test_do_nothing_and_no_traction_are_different_conditions(flows):
    mesh, walls = flows.grid(3, 4, 3, size=(3.0, 1.0)), case.NoSlip(("top", "bottom"))
    inlet = flows.velocity("left", flows.parabola, 0)
    free, spreading = (
        flows.steady(flows.solver(mesh, [inlet, walls, outlet], viscosity=0.1, model="stokes"))
        for outlet in (case.DoNothing(("right",)), flows.traction("right", 0, 0))
    )
    outlet = mesh.edge_nodes("right")
    assert np.abs(free.velocity[outlet, 1]).max() < 1e-12
    assert np.abs(spreading.velocity[outlet, 1]).max() > 0.02  # the jet opens


def test_pressure_outlet_of_plug_flow_is_exact(flows):
    mesh = flows.grid(3, turn=0.7)
    n = flows.rotation(0.7)
    solver = flows.solver(
        mesh, [flows.velocity("left", *(2.0 * n[:, 0])), case.Slip(("top", "bottom")), flows.pressure("right", "4.25")]
    )
    state = flows.steady(solver)
    expected = np.broadcast_to(2.0 * n[:, 0], state.velocity.shape)
    np.testing.assert_allclose(state.velocity, expected, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(state.pressure, 4.25, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("mode", MODES)
def test_couette_flow_under_a_moving_wall_that_speeds_up(flows, mode):
    # u = t y needs the body force ρ y; linear in time and space: exact from a BDF1 start on.
    mesh = flows.grid(2, 3, 3, size=(2.0, 1.0))
    conditions = [case.NoSlip(("bottom",)), flows.velocity("top", "t", 0), flows.velocity(("left", "right"), "t*y", 0)]
    solver = flows.solver(mesh, conditions, density=1.7, viscosity=0.3, body_force=("1.7*y", "0"), convection=mode)
    state = flows.march(solver, solver.initial_state(), (0.2, 0.1, 0.3), linear=mode in LINEAR)
    np.testing.assert_allclose(state.velocity, flows.field(mesh.points, "t*y", 0, 0.6), rtol=0.0, atol=1e-12)
    assert np.abs(state.pressure).max() < 1e-11


def test_inclined_channel_with_slip_equals_the_straight_one_turned(flows):
    # The upper half of the profile is replaced by symmetry; an uneven inflow makes the flow two-dimensional.
    def solve(turn):
        Q = flows.rotation(turn)
        depth = f"({Q[1, 1]}*y + ({Q[0, 1]})*x)"
        profile = f"6*{depth}*(2 - {depth})*exp(-{depth})"
        mesh = flows.grid(3, 5, 3, size=(2.0, 1.0), turn=turn)
        conditions = [
            flows.velocity("left", *(f"({Q[a, 0]})*{profile}" for a in range(2))),
            case.NoSlip(("bottom",)),
            case.Slip(("top",)),
            case.DoNothing(("right",)),
        ]
        solver = flows.solver(mesh, conditions, viscosity=0.1)
        return solver, flows.steady(solver)

    turn = np.pi / 6.0
    (straight, first), (inclined, second) = solve(0.0), solve(turn)
    assert not straight.boundary.constraints(first.points[0]).rotated.size
    assert inclined.boundary.constraints(second.points[0]).rotated.size > 10
    assert np.abs(first.velocity[:, 1]).max() > 0.1
    Q = flows.rotation(turn)
    np.testing.assert_allclose(second.velocity, first.velocity @ Q.T, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(second.pressure, first.pressure, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(second.reaction, first.reaction @ Q.T, rtol=0.0, atol=1e-11)


def test_slip_on_a_curved_wall_lets_the_fluid_turn_as_a_rigid_body(flows):
    # Without shear at the outer wall only u = ω r e_θ remains of Taylor–Couette flow; p = ρ ω² r²/2 + c.
    errors = []
    for order in (2, 4, 6):
        mesh = flows.annulus(order, count=2)
        assert len(mesh.edge_nodes("outer")) == 8 * order
        solver = flows.solver(mesh, [flows.velocity("inner", "-1.5*y", "1.5*x"), case.Slip(("outer",))], density=2.0)
        state = flows.steady(solver)
        assert flows.pressure_error(solver, state, "1.5**2*(x**2 + y**2)", level=True) < 3.0 * 0.5 ** (2 * order)
        errors.append(np.abs(state.velocity - 1.5 * state.points[0] @ [[0.0, 1.0], [-1.0, 0.0]]).max())
    assert errors[0] < 0.1
    assert errors[1] < 1e-4
    assert errors[2] < 1e-7


def test_taylor_couette_flow_between_turning_walls(flows):
    # u_θ = A r + B/r with u_θ(1/2) = 1 and u_θ(1) = 0.
    A, B = -2.0 / 3.0, 2.0 / 3.0
    r2 = "(x**2 + y**2)"
    speed = f"({A} + {B}/{r2})"
    errors = []
    for rings in (2, 4):
        mesh = flows.annulus(4, rings=rings, count=rings)
        solver = flows.solver(mesh, [flows.velocity("inner", "-2*y", "2*x"), case.NoSlip(("outer",))])
        errors.append(flows.velocity_norm_of_error(solver, flows.steady(solver), f"-y*{speed}", f"x*{speed}"))
    assert errors[0] < 1e-3
    assert rate(errors) > 4.5


def test_hydrostatic_balance_is_exact(flows):
    mesh = flows.rectangle(3, 3, 3, bend=0.05)  # curved inside: p = -y is still in the space only on straight quads
    straight = flows.grid(3)
    for solver in (
        flows.solver(straight, [case.NoSlip(flows.around)], body_force=("0.5", "-2")),
        flows.solver(
            straight,
            [case.NoSlip(("left", "right", "bottom")), flows.pressure("top", "0.5*x")],
            body_force=("0.5", "-2"),
            model="stokes",
        ),
    ):
        state = flows.steady(solver)
        assert np.abs(state.velocity).max() < 1e-14
        level = bool(len(solver.enclosed(straight.points)))
        assert flows.pressure_error(solver, state, "0.5*x - 2*(y - 1)", level=level) < 1e-12
    bent = flows.solver(mesh, [case.NoSlip(flows.around)], body_force=("0.5", "-2"))
    assert np.abs(flows.steady(bent).velocity).max() < 1e-2


def test_enclosed_cavity_has_zero_mean_pressure_and_a_balanced_reaction(flows):
    mesh = flows.grid(4, 3, 3)
    conditions = [flows.velocity("top", "(4*x*(1 - x))**2", 0), case.NoSlip(("left", "right", "bottom"))]
    solver = flows.solver(mesh, conditions, viscosity=0.02, body_force=("0", "3"))
    state = flows.steady(solver)
    geometry = solver.geometry(mesh.points)
    p = state.pressure[solver.space.pressure_cells] @ solver.space.pressure.N.T
    assert abs(np.sum(geometry.weights * p)) < 1e-13
    assert 0.9 < np.abs(state.velocity).max() <= 1.0
    # The reaction belongs to that pressure. Without the body force the pressure is less by 3 (y - 1/2).
    plain = flows.steady(flows.solver(mesh, conditions, viscosity=0.02))
    difference = state.reaction - plain.reaction
    np.testing.assert_allclose(state.velocity, plain.velocity, rtol=0.0, atol=1e-10)
    assert abs(difference[mesh.edge_nodes("left"), 0].sum()) < 1e-11
    assert difference[mesh.edge_nodes("top"), 1].sum() == pytest.approx(-1.5, abs=1e-11)
    assert difference[mesh.edge_nodes("bottom"), 1].sum() == pytest.approx(-1.5, abs=1e-11)


def test_momentum_of_a_channel_is_balanced(flows):
    # A parabolic inflow meets a slip wall: the flow develops. What enters, leaves and acts from outside balances.
    mesh = flows.grid(5, 6, 3, size=(3.0, 1.0))
    conditions = [
        flows.velocity("left", flows.parabola, 0),
        case.NoSlip(("bottom",)),
        case.Slip(("top",)),
        flows.traction("right", -2.0, 0),
    ]
    solver = flows.solver(mesh, conditions, density=3.0, viscosity=0.1, body_force=("0.3", "-1.1"))
    state = flows.steady(solver)
    geometry = solver.geometry(mesh.points)
    u = state.velocity[solver.space.velocity_cells]
    gradient = np.stack([dN @ u for dN in physical_gradients(geometry, solver.space.velocity)], axis=-1)
    at = solver.space.velocity.N @ u
    inertia = 3.0 * np.einsum("eq,eqab,eqb->a", geometry.weights, gradient, at)
    outer = np.array([-2.0, 0.0]) + np.array([0.3, -1.1]) * 3.0
    np.testing.assert_allclose(state.reaction.sum(axis=0) + outer, inertia, rtol=0.0, atol=1e-11)
    # ∫ ρ u·∇u is the flux of momentum through inlet and outlet, as far as ∇·u = 0 holds.
    y, w = np.polynomial.legendre.leggauss(12)
    y, w = (y + 1.0) / 2.0, w / 2.0
    flux_in = 3.0 * np.sum(w * (4.0 * y * (1.0 - y)) ** 2)
    right = mesh.edge_nodes("right")
    profile = [np.polyfit(mesh.points[right, 1], state.velocity[right, a], 12) for a in range(2)]
    values = np.array([np.polyval(c, y) for c in profile])
    flux_out = 3.0 * (values * values[0]) @ w
    np.testing.assert_allclose(inertia, flux_out - [flux_in, 0.0], rtol=0.0, atol=5e-3)
