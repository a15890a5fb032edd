"""The fluid: exact solutions, rates of convergence, what moves with the mesh, what is computed how often, failure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hofsi import case
from hofsi.errors import LinearSolverError, NewtonError
from hofsi.fem.geometry import physical_gradients
from hofsi.solvers.fluid import FluidState

NOBODY = np.zeros((0, 2))
LINEAR = ("linearised", "extrapolated")
MODES = ("newton", "picard", "linearised", "extrapolated")


def rate(errors, ratio=2.0):
    return np.log(errors[-2] / errors[-1]) / np.log(ratio)


def wobble(X, t):
    """Smooth motion of all nodes, boundary included; large enough to bend every element."""
    x, y = X.T
    return X + 0.06 * np.stack(
        [
            np.sin(3.0 * t) * np.sin(2.0 * np.pi * y + 0.4) + 0.3 * np.cos(2.0 * x + t),
            np.sin(2.0 * t + 1.0) * np.sin(2.0 * np.pi * x + 0.2),
        ],
        axis=-1,
    )


# Moving meshes --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("sizes", [(0.1,) * 4, (0.1, 0.07, 0.15, 0.05)])
def test_constant_flow_stays_constant_on_a_moving_mesh(flows, mode, sizes):
    mesh = flows.rectangle(3, 3, 2, bend=0.03)
    conditions = [flows.velocity(("left", "top", "bottom"), 1.3, -0.7), flows.traction("right", 0, 0)]
    solver = flows.solver(
        mesh, conditions, density=2.0, viscosity=0.05, convection=mode, initial_velocity=("1.3", "-0.7")
    )
    state = solver.initial_state(0.0, wobble(mesh.points, 0.0))
    # A wrong pressure to start from, so that the solver has something to do.
    state = replace(state, pressure=np.random.default_rng(5).standard_normal(state.pressure.shape))
    state = flows.march(solver, state, sizes, lambda t: wobble(mesh.points, t), linear=mode in LINEAR)
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
        (wobble(mesh.points, 0.25), wobble(mesh.points, 0.0)),
        np.zeros(mesh.points.shape),
        0.25,
    )
    step = solver.begin_step(old, wobble(mesh.points, 0.35), sizes, 0.35, convection="newton")
    a, b, c = (wobble(mesh.points, t) for t in (0.35, 0.25, 0.0))
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
    profile = "4*y*(1 - y)"

    @classmethod
    def conditions(cls, flows, outlet):
        inlet = flows.velocity("left", cls.profile, 0)
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
    expected = flows.field(state.points[0], Poiseuille.profile, 0)
    np.testing.assert_allclose(state.velocity, expected, rtol=0.0, atol=1e-12)
    assert flows.pressure_error(solver, state, f"{level} + 0.8*(3 - x)") < 1e-11


def test_do_nothing_and_no_traction_are_different_conditions(flows):
    mesh, walls = flows.grid(3, 4, 3, size=(3.0, 1.0)), case.NoSlip(("top", "bottom"))
    inlet = flows.velocity("left", Poiseuille.profile, 0)
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


# Rates ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [2, 3, 4])
def test_kovasznay_flow_on_curved_meshes_converges_at_the_full_rate(flows, order):
    Re = 20.0
    k = Re / 2.0 - np.sqrt(Re**2 / 4.0 + 4.0 * np.pi**2)
    x, y = f"1 - exp({k}*x)*cos(2*pi*y)", f"{k}/(2*pi)*exp({k}*x)*sin(2*pi*y)"
    pressure = f"(1 - exp(2*{k}*x))/2"
    errors = []
    for n in (4, 8):
        mesh = flows.rectangle(order, n, n, low=(-0.5, -0.5), high=(0.7, 0.7), bend=0.04)
        shear = f"(2*pi*exp({k}*x)*sin(2*pi*y) + {k * k}/(2*pi)*exp({k}*x)*sin(2*pi*y))/{Re}"
        normal = f"-({pressure}) - 2*{k}*exp({k}*x)*cos(2*pi*y)/{Re}"
        conditions = [flows.velocity(("left", "bottom", "top"), x, y), flows.traction("right", normal, shear)]
        solver = flows.solver(mesh, conditions, viscosity=1.0 / Re)
        state = flows.steady(solver)
        errors.append(
            (flows.velocity_norm_of_error(solver, state, x, y), flows.pressure_norm_of_error(solver, state, pressure))
        )
    velocity, p = np.array(errors).T
    assert rate(velocity) > order + 1 - 0.35
    assert rate(p) > order - 0.35
    assert velocity[0] < 0.1


class Vortex:
    """Taylor–Green vortex on a mesh whose nodes all move.

    Fehn, Heinz, Wall, Kronbichler, J. Comput. Phys. 430 (2021) 110040, Section 5.1.
    """

    viscosity = 0.025
    decay = 4.0 * np.pi**2 * 0.025
    x, y = f"-sin(2*pi*y)*exp(-{decay}*t)", f"sin(2*pi*x)*exp(-{decay}*t)"
    pressure = f"-cos(2*pi*x)*cos(2*pi*y)*exp(-2*{decay}*t)"

    @staticmethod
    def position(X, t):
        s = 0.08 * np.sin(2.0 * np.pi * t / 4.0)
        return X + s * np.stack([np.sin(2.0 * np.pi * (X[:, 1] + 0.5)), np.sin(2.0 * np.pi * (X[:, 0] + 0.5))], axis=-1)

    @classmethod
    def error(cls, flows, order, n, start, sizes, *, linear=True):
        mesh = flows.rectangle(order, n, n, low=(-0.5, -0.5), high=(0.5, 0.5))
        solver = flows.solver(mesh, [flows.velocity(flows.around, cls.x, cls.y)], viscosity=cls.viscosity)
        first = start - sizes[0]
        points = [cls.position(mesh.points, t) for t in (start, first)]
        velocities = tuple(flows.field(X, cls.x, cls.y, t) for X, t in zip(points, (start, first), strict=True))
        state = FluidState(
            velocities, np.zeros(solver.space.pressure_count), tuple(points), np.zeros(mesh.points.shape), start
        )
        state = flows.march(
            solver, state, sizes, lambda t: cls.position(mesh.points, t), linear=linear, steps=(sizes[0],)
        )
        return (
            flows.velocity_norm_of_error(solver, state, cls.x, cls.y),
            flows.pressure_norm_of_error(solver, state, cls.pressure),
        )


@pytest.mark.parametrize(("order", "meshes"), [(2, (8, 16)), (3, (12, 24)), (4, (8, 16))])
def test_vortex_on_a_moving_mesh_converges_in_space_at_the_full_rate(flows, order, meshes):
    errors = np.array([Vortex.error(flows, order, n, 0.4, (2e-3,) * 6) for n in meshes])
    assert rate(errors[:, 0]) > order + 1 - 0.4
    assert rate(errors[:, 1]) > order - 0.4


@pytest.mark.parametrize("linear", [True, False])
def test_vortex_on_a_moving_mesh_converges_in_time_at_second_order(flows, linear):
    errors = np.array([Vortex.error(flows, 6, 3, 0.2, (0.4 / n,) * n, linear=linear) for n in (8, 16)])
    assert rate(errors[:, 0]) == pytest.approx(2.0, abs=0.35)
    assert errors[1, 0] < 5e-3


class Linear:
    """u = (g + x + y, g - x - y), g = exp(t) + t + t³ + sin t, p = g: only the time scheme errs."""

    g, rate_of_g = "(exp(t) + t + t**3 + sin(t))", "(exp(t) + 1 + 3*t**2 + cos(t))"
    x, y = f"{g} + x + y", f"{g} - x - y"
    force = (f"{rate_of_g} + 2*{g}", f"{rate_of_g} - 2*{g}")

    @classmethod
    def error(cls, flows, pattern, repeats, mode):
        mesh = flows.rectangle(2, 2, 2, bend=0.05)
        conditions = [
            flows.velocity(("left", "bottom", "top"), cls.x, cls.y),
            flows.traction("right", f"-{cls.g} + 2*0.5", 0),
        ]
        solver = flows.solver(
            mesh,
            conditions,
            viscosity=0.5,
            body_force=cls.force,
            convection=mode,
            initial_velocity=("1 + x + y", "1 - x - y"),
        )
        sizes = np.tile(pattern, repeats)
        X = mesh.points

        def position(t):  # the outlet stays where it is
            return X + (1.0 - X[:, :1]) * (wobble(X, t) - X)

        state = flows.march(
            solver,
            solver.initial_state(0.0, position(0.0)),
            sizes / sizes.sum(),
            position,
            linear=mode in LINEAR,
        )
        return np.abs(state.velocity - flows.field(state.points[0], cls.x, cls.y, 1.0)).max()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("pattern", [(1.0, 1.0), (1.0, 1.6)])
def test_second_order_in_time_also_with_varying_steps_on_a_moving_mesh(flows, pattern, mode):
    errors = [Linear.error(flows, pattern, n, mode) for n in (8, 16)]
    assert rate(errors) == pytest.approx(2.0, abs=0.25)
    assert errors[1] < 2e-2


def test_linear_steps_are_those_of_newtons_method_but_for_a_higher_order(flows):
    # From rest under a force that grows slowly: what the linearisation leaves out is of fourth order in every step.
    def march(count, mode):
        mesh = flows.rectangle(3, 3, 2, bend=0.05)
        conditions = [case.NoSlip(("left", "bottom", "top")), flows.traction("right", 0, 0)]
        force = ("8*t**2*y", "-6*t**2*sin(2*x)")
        solver = flows.solver(mesh, conditions, viscosity=0.02, body_force=force, convection=mode)
        state = flows.march(solver, solver.initial_state(), (1.0 / count,) * count, linear=mode in LINEAR)
        return state.velocity

    differences = [np.abs(march(n, "linearised") - march(n, "newton")).max() for n in (16, 32, 64)]
    assert np.abs(march(8, "newton")).max() > 0.3
    assert rate(differences) > 3.0


# Conservation ---------------------------------------------------------------------------------------------------------


def test_momentum_of_a_channel_is_balanced(flows):
    # A parabolic inflow meets a slip wall: the flow develops. What enters, leaves and acts from outside balances.
    mesh = flows.grid(5, 6, 3, size=(3.0, 1.0))
    conditions = [
        flows.velocity("left", Poiseuille.profile, 0),
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


# What is computed how often -------------------------------------------------------------------------------------------


def channel(flows, order=2, columns=3, rows=2, profile=Poiseuille.profile, **fluid):
    conditions = [flows.velocity("left", profile, 0), case.NoSlip(("top", "bottom")), case.DoNothing(("right",))]
    return flows.solver(flows.grid(order, columns, rows, size=(3.0, 1.0)), conditions, **fluid)


def test_a_mesh_at_rest_is_prepared_once(flows):
    solver = channel(flows, initial_velocity=(Poiseuille.profile, "0"))
    flows.march(solver, solver.initial_state(), (0.1,) * 5, linear=True)
    counts = solver.counts
    assert counts.geometries == 1
    assert counts.constant_assemblies == 2  # BDF1, then BDF2
    assert (counts.assemblies, counts.factorisations, counts.solves) == (5, 5, 5)
    assert counts.iterations == 0


def test_stokes_flow_on_a_mesh_at_rest_is_factorised_once_for_each_step_size(flows):
    solver = channel(flows, model="stokes")
    state = flows.march(solver, solver.initial_state(), (0.1,) * 5, linear=True)
    counts = solver.counts
    assert (counts.geometries, counts.constant_assemblies, counts.assemblies) == (1, 2, 0)
    assert (counts.factorisations, counts.solves) == (2, 5)
    flows.march(solver, state, (0.05,), linear=False, steps=(0.1,) * 5)
    assert counts.factorisations == 3
    assert counts.assemblies == 0


def test_a_moving_mesh_is_prepared_once_a_step(flows):
    solver = channel(flows, initial_velocity=(Poiseuille.profile, "0"))
    X = solver.mesh.points
    flows.march(solver, solver.initial_state(), (0.1,) * 3, lambda t: X * [1.0 + 0.1 * t, 1.0], linear=True)
    assert (solver.counts.geometries, solver.counts.factorisations) == (3, 3)


def test_a_linear_step_is_factorised_once_however_often_it_is_solved(flows):
    mesh = flows.grid(3)
    top = mesh.edge_nodes("top")
    conditions = [case.NoSlip(("left", "bottom")), case.DoNothing(("right",))]
    solver = flows.solver(mesh, conditions, interface=top)
    step = solver.begin_step(solver.initial_state(), mesh.points, (0.1,), 0.1, convection="extrapolated")
    results = [step.solve(np.full((len(top), 2), value))[0] for value in (1.0, 3.0)]
    assert (solver.counts.factorisations, solver.counts.solves) == (1, 2)
    np.testing.assert_allclose(results[1], 3.0 * results[0], rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(results[0][top], 1.0)  # the interface comes before walls and openings
    assert np.abs(results[0]).max() >= 1.0


def test_a_linearised_step_far_from_what_was_expected_is_linearised_about_what_newtons_method_finds(flows):
    mesh = flows.grid(3)
    top = mesh.edge_nodes("top")
    conditions = [case.NoSlip(("left", "bottom")), case.DoNothing(("right",))]
    expected, found = (flows.solver(mesh, conditions, interface=top, viscosity=0.05) for _ in range(2))
    moved, further = np.full((len(top), 2), 1.0), np.full((len(top), 2), 1.01)
    step = expected.begin_step(expected.initial_state(), mesh.points, (0.1,), 0.1, convection="linearised")
    newton = found.begin_step(found.initial_state(), mesh.points, (0.1,), 0.1, convection="newton")
    gaps = [np.abs(step.solve(d)[0] - newton.solve(d)[0]).max() for d in (moved, further)]
    assert gaps[0] < 1e-9  # both are Newton's solution
    assert 1e-8 < gaps[1] < 2e-4  # of second order in the difference of 1 %
    made = expected.counts.factorisations
    step.solve(moved)
    assert expected.counts.factorisations == made  # once more after Newton's, then no more


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_nothing_is_kept_of_a_mesh_that_has_moved_on(flows, model):
    # Slip walls, so that frames, constraints, pattern, matrices and factors all belong to the old position.
    def made(turn):
        Q = flows.rotation(turn)
        conditions = [
            flows.velocity("left", "1 + 0.3*sin(4*y)", "0.2"),
            case.Slip(("top", "bottom")),
            flows.pressure("right", "y"),
        ]
        return flows.solver(flows.grid(3), conditions, viscosity=0.2, model=model), Q

    solver, Q = made(0.4)
    before = flows.steady(solver)
    here = solver.mesh.points @ Q.T
    fresh, _ = made(0.4)
    found, expected = (s.begin_steady(s.initial_state(), here).solve(NOBODY)[0] for s in (solver, fresh))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-11)
    again = solver.begin_steady(solver.initial_state(), solver.mesh.points).solve(NOBODY)[0]
    np.testing.assert_allclose(again, before.velocity, rtol=0.0, atol=1e-11)
    assert np.abs(found - before.velocity).max() > 0.05


# Failure --------------------------------------------------------------------------------------------------------------


UNEVEN = "6*y*(1 - y)*exp(-y)"


def driven(flows, **settings):
    conditions = [flows.velocity("top", 1, 0), case.NoSlip(("left", "right", "bottom"))]
    return flows.solver(flows.grid(2, 4, 4), conditions, viscosity=1e-3, **settings)


def test_newton_says_how_far_it_came(flows):
    solver = driven(flows, max_iterations=1)
    before = solver.initial_state()
    step = solver.begin_steady(before, solver.mesh.points)
    message = (
        r"fluid, t = 0: .*relative residual of .* after 1 iterations; expected below 1e-12.* "
        r"Approached little by little, 0(\.\d+)? of the convection was reached"
    )
    with pytest.raises(NewtonError, match=message) as caught:
        step.solve(NOBODY)
    assert caught.value.reason == "max_iterations"
    assert not step.converged
    assert not np.any(before.velocity)


def test_newton_that_leaves_the_finite_numbers_says_so(flows):
    solver = driven(flows, initial_velocity=("1e200*y*(1 - y)*x", "1e200*x*(1 - x)"))
    with pytest.raises(NewtonError, match="not finite") as caught:
        flows.steady(solver)
    assert caught.value.reason == "diverged"


def test_a_flow_that_newton_does_not_find_from_rest_is_approached_with_more_and_more_of_the_convection(flows):
    mesh = flows.rectangle(4, 6, 6)
    conditions = [flows.velocity("top", 1, 0), case.NoSlip(("left", "right", "bottom"))]
    solver = flows.solver(mesh, conditions, viscosity=1e-3, tolerance=1e-10)
    step = solver.begin_steady(solver.initial_state(), mesh.points)
    step.solve(NOBODY, max_iterations=25)
    assert not step.converged
    assert solver.counts.continuation_steps == 0
    state = flows.steady(solver)
    assert solver.counts.continuation_steps > 2
    # Botella, Peyret, Computers & Fluids 27 (1998) 421-433, doi:10.1016/S0045-7930(98)00002-4: u at the centre.
    middle = np.argmin(np.hypot(*(mesh.points - 0.5).T))
    assert state.velocity[middle, 0] == pytest.approx(-0.0620561, abs=0.015)
    # What was found is a solution of the whole problem.
    again = solver.begin_steady(state, solver.mesh.points)
    before = solver.counts.factorisations
    again.solve(NOBODY)
    assert solver.counts.factorisations <= before + 1


@pytest.mark.parametrize("mode", ["newton", "picard"])
def test_a_flow_without_stress_converges(flows, mode):
    # Every term of the equations vanishes: there is no force to compare the residual with.
    turn = 0.3
    x, y = flows.rotation(turn) @ [1.0, 0.0]
    conditions = [flows.velocity("left", x, y), case.Slip(("top", "bottom")), flows.traction("right", 0, 0)]
    solver = flows.solver(flows.grid(3, turn=turn), conditions, viscosity=0.1, max_iterations=60, convection=mode)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, np.broadcast_to([x, y], state.velocity.shape), rtol=0.0, atol=1e-12)


def test_a_tolerance_below_rounding_is_met_as_far_as_rounding_allows(flows):
    solver = channel(flows, 2, 4, 3, UNEVEN, viscosity=0.1, tolerance=1e-30)
    assert np.isfinite(flows.steady(solver).velocity).all()


def test_a_limited_solve_says_whether_it_converged(flows):
    solver = channel(flows, viscosity=0.05)
    step = solver.begin_steady(solver.initial_state(), solver.mesh.points)
    step.solve(NOBODY, max_iterations=1)
    assert not step.converged
    first = solver.counts.factorisations
    assert first == 1
    for _ in range(20):
        step.solve(NOBODY, max_iterations=1)
        if step.converged:
            break
    assert step.converged
    done = solver.counts.factorisations
    step.solve(NOBODY, max_iterations=1)  # nothing left to do
    assert solver.counts.factorisations == done
    expected = flows.field(solver.mesh.points, Poiseuille.profile, 0)
    np.testing.assert_allclose(step.accept().velocity, expected, rtol=0.0, atol=1e-11)


def test_picard_and_newton_meet_in_the_same_flow(flows):
    def solve(mode):
        solver = channel(flows, 2, 4, 3, UNEVEN, viscosity=0.1, tolerance=1e-11, max_iterations=60, convection=mode)
        return flows.steady(solver), solver.counts.iterations

    (newton, few), (picard, many) = solve("newton"), solve("picard")
    np.testing.assert_allclose(picard.velocity, newton.velocity, rtol=0.0, atol=1e-8)
    assert few < many


def test_newton_converges_quadratically(flows):
    solver = channel(flows, 3, 4, 3, UNEVEN, viscosity=0.1)
    reference = flows.steady(solver).velocity
    step = solver.begin_steady(solver.initial_state(), solver.mesh.points)
    errors = [np.abs(step.solve(NOBODY, max_iterations=1)[0] - reference).max() for _ in range(5)]
    small = [k for k, error in enumerate(errors[:-1]) if error < 1e-1 and errors[k + 1] > 1e-12]
    assert small
    assert all(errors[k + 1] < 30.0 * errors[k] ** 2 for k in small)


def test_a_step_that_was_not_solved_has_no_reaction(flows):
    solver = channel(flows)
    step = solver.begin_step(solver.initial_state(), solver.mesh.points, (0.1,), 0.1, convection="linearised")
    with pytest.raises(ValueError, match="has not been solved"):
        step.reaction()


def test_a_matrix_that_is_singular_is_not_passed_over(flows):
    # Between slip walls, with free ends, nothing resists a steady body force.
    conditions = [case.Slip(("top", "bottom")), flows.traction("left", 0, 0), flows.traction("right", 0, 0)]
    solver = flows.solver(flows.grid(2), conditions, model="stokes", body_force=("1", "0"))
    with pytest.raises(LinearSolverError, match="singular"):
        flows.steady(solver)
