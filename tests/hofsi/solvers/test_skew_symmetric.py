"""Convection that keeps energy."""

import numpy as np
import pytest

from hofsi import case
from hofsi.solvers.fluid_integrals import kinetic_energy

SKEW = {"convection_form": "skew-symmetric"}


def box(flows, **fluid):
    """A closed box, hardly viscous, whose velocity is far from free of divergence between the nodes."""
    mesh = flows.grid(2, 4, 4)
    walls = (case.NoSlip(("left", "right", "bottom", "top")),)
    swirl = ("sin(3*pi*x)**2*sin(6*pi*y)", "-sin(6*pi*x)*sin(3*pi*y)**2")
    return flows.solver(mesh, walls, viscosity=1e-5, initial_velocity=swirl, **fluid)


def energies(flows, solver, steps=60, size=0.05):
    state, made, found = solver.initial_state(), [], []
    for _ in range(steps):
        state = flows.march(solver, state, [size], linear=True, steps=made)
        made = [size, *made]
        found.append(kinetic_energy(solver, state))
    return np.array(found)


def test_energy_only_falls_where_the_plain_form_makes_it(flows):
    """Advected by an extrapolated velocity, backward differences lose energy in their own norm, at any step."""
    plain = energies(flows, box(flows, convection="extrapolated"))
    skew = energies(flows, box(flows, convection="extrapolated", **SKEW))
    assert plain.max() > 1.2 * plain[0]
    assert skew.max() <= skew[0]


def test_flows_that_the_space_holds_do_not_notice(flows):
    conditions = (flows.velocity("left", "4*y*(1 - y)", 0), case.NoSlip(("top", "bottom")), case.DoNothing(("right",)))
    solver = flows.solver(flows.grid(3, 4, 2, size=(2.0, 1.0)), conditions, viscosity=0.05, **SKEW)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, flows.field(state.points[0], "4*y*(1 - y)", 0), atol=1e-10)


@pytest.mark.parametrize("way", ["newton", "picard", "linearised", "extrapolated"])
def test_all_ways_of_treating_convection_find_one_steady_flow(flows, way):
    """A cavity at Re = 50, marched for the linear steps."""
    conditions = (flows.velocity("top", "16*x**2*(1 - x)**2", 0), case.NoSlip(("left", "right", "bottom")))
    expected = flows.steady(flows.solver(flows.grid(3, 4, 4), conditions, viscosity=0.02, **SKEW)).velocity
    solver = flows.solver(flows.grid(3, 4, 4), conditions, viscosity=0.02, convection=way, **SKEW)
    if way in ("newton", "picard"):
        found = flows.steady(solver)
    else:
        found = flows.march(solver, solver.initial_state(), [0.2] * 150, linear=True)
    np.testing.assert_allclose(found.velocity, expected, rtol=0.0, atol=1e-8)
    plain = flows.steady(flows.solver(flows.grid(3, 4, 4), conditions, viscosity=0.02)).velocity
    assert 1e-5 < np.abs(plain - expected).max() < 1e-2


def test_newtons_method_converges_quadratically(flows):
    conditions = (flows.velocity("top", "16*x**2*(1 - x)**2", 0), case.NoSlip(("left", "right", "bottom")))
    counts = []
    for fluid in ({}, SKEW):
        solver = flows.solver(flows.grid(3, 4, 4), conditions, viscosity=0.01, convection="newton", **fluid)
        flows.steady(solver)
        counts.append(solver.counts.iterations)
    assert counts[1] <= counts[0] + 1


@pytest.mark.parametrize(("order", "difference"), [(2, 1e-11), (4, 1e-11), (6, 1e-5)])
def test_a_uniform_flow_stays_on_a_moving_mesh(flows, order, difference):
    """To rounding as long as integrals are exact: those of the form hold polynomials of the degree 3 p - 1."""
    mesh = flows.grid(order)
    at = ("0.7", "-0.4")
    solver = flows.solver(
        mesh,
        [flows.velocity(("left", "top"), *at), flows.traction("right", 0, 0), flows.traction("bottom", 0, 0)],
        initial_velocity=at,
        viscosity=0.01,
        **SKEW,
    )
    state = flows.march(solver, solver.initial_state(), (0.05,) * 6, lambda t: flows.wobble(mesh.points, t))
    away = np.abs(state.velocity - [0.7, -0.4]).max()
    assert away < difference
