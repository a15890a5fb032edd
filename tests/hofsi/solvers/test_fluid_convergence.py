"""The fluid: rates of convergence in space and time."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi import case
from hofsi.solvers.fluid import FluidState

LINEAR = ("linearised", "extrapolated")
MODES = ("newton", "picard", "linearised", "extrapolated")


def rate(errors, ratio=2.0):
    return np.log(errors[-2] / errors[-1]) / np.log(ratio)


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize("form", ["convective", "skew-symmetric"])
def test_kovasznay_flow_on_curved_meshes_converges_at_the_full_rate(flows, order, form):
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
        solver = flows.solver(mesh, conditions, viscosity=1.0 / Re, convection_form=form)
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
    def error(cls, flows, order, n, start, sizes, *, linear=True, **fluid):
        mesh = flows.rectangle(order, n, n, low=(-0.5, -0.5), high=(0.5, 0.5))
        solver = flows.solver(mesh, [flows.velocity(flows.around, cls.x, cls.y)], viscosity=cls.viscosity, **fluid)
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
@pytest.mark.parametrize("form", ["convective", "skew-symmetric"])
def test_vortex_on_a_moving_mesh_converges_in_time_at_second_order(flows, linear, form):
    errors = np.array(
        [Vortex.error(flows, 6, 3, 0.2, (0.4 / n,) * n, linear=linear, convection_form=form) for n in (8, 16)]
    )
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
            return X + (1.0 - X[:, :1]) * (flows.wobble(X, t) - X)

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
