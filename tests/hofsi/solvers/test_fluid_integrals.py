"""Integrals over the fluid against exact ones, and how they fit together."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi import case
from hofsi.solvers import fluid_integrals as integrals
from hofsi.solvers.fluid import FluidState
from hofsi.solvers.fluid_forces import BoundaryForce


def state_of(solver, x, y):
    points = solver.mesh.points
    velocity = np.stack([x(*points.T), y(*points.T)], axis=-1)
    return FluidState((velocity,), np.zeros(solver.space.pressure_count), (points,), np.zeros(points.shape), 0.0)


@pytest.mark.parametrize("order", [2, 3, 6])
def test_integrals_of_polynomials_are_exact(flows, order):
    solver = flows.solver(flows.grid(order, size=(2.0, 1.0)), [case.NoSlip(flows.around)], density=3.0, viscosity=0.5)
    state = state_of(solver, lambda x, y: x * y, lambda x, y: x**2 + y)
    # ∇u = (y, x; 2x, 1): ω = x, ∇·u = y + 1, ε = (y, 3x/2; 3x/2, 1)
    assert integrals.area(solver, state) == pytest.approx(2.0, rel=1e-13)
    squares = 8.0 / 9.0 + 32.0 / 5.0 + 8.0 / 3.0 + 2.0 / 3.0  # ∫ x²y² + x⁴ + 2x²y + y²
    assert integrals.kinetic_energy(solver, state) == pytest.approx(1.5 * squares, rel=1e-12)
    assert integrals.enstrophy(solver, state) == pytest.approx(0.5 * 8.0 / 3.0, rel=1e-12)
    strain = 2.0 / 3.0 + 2.0 * 2.25 * 8.0 / 3.0 + 2.0
    assert integrals.dissipation(solver, state) == pytest.approx(2.0 * 0.5 * strain, rel=1e-12)
    assert integrals.divergence(solver, state) == pytest.approx(np.sqrt(2.0 * 7.0 / 3.0), rel=1e-12)
    assert integrals.continuity_residual(solver, state) > 1e-3


def test_a_rigid_rotation_dissipates_nothing(flows):
    solver = flows.solver(flows.annulus(4), [case.NoSlip(("inner", "outer"))], density=2.0)
    state = state_of(solver, lambda x, y: -3.0 * y, lambda x, y: 3.0 * x)
    area = integrals.area(solver, state)
    assert integrals.dissipation(solver, state) < 1e-24
    assert integrals.divergence(solver, state) < 1e-13
    assert integrals.enstrophy(solver, state) == pytest.approx(0.5 * 36.0 * area, rel=1e-12)
    assert area == pytest.approx(0.75 * np.pi, rel=2e-4)


@pytest.mark.parametrize("order", [2, 3])
def test_a_solution_satisfies_continuity_weakly_and_nearly_pointwise(flows, order):
    def solve(columns):
        mesh = flows.rectangle(order, columns, columns, bend=0.03)
        lid = flows.velocity("top", "16*x**2*(1 - x)**2", 0)
        solver = flows.solver(mesh, [lid, case.NoSlip(("left", "right", "bottom"))], viscosity=0.1)
        return solver, flows.steady(solver)

    coarse, fine = solve(4), solve(8)
    for solver, state in (coarse, fine):
        assert integrals.continuity_residual(solver, state) < 1e-14
    first, second = (integrals.divergence(*one) for one in (coarse, fine))
    assert 1e-8 < second < first / 2.0 ** (order - 1)


def test_what_the_lid_does_is_dissipated(flows):
    """In a steady Stokes flow the power of the boundary, ∫ u·σ·n, becomes heat."""
    mesh = flows.rectangle(4, 3, 3, bend=0.02)
    conditions = [flows.velocity("top", "0.7", 0), case.Slip(("bottom",)), flows.velocity(("left", "right"), None, 0)]
    solver = flows.solver(mesh, conditions, viscosity=0.3, model="stokes", body_force=("-0.4*y", "0"))
    state = flows.steady(solver)
    push = -0.7 * BoundaryForce(solver, ["top"]).evaluate(state)[0]
    geometry = solver.geometry(mesh.points)
    u = solver.space.velocity.N @ state.velocity[solver.space.velocity_cells]
    work = float((geometry.weights * -0.4 * geometry.x[..., 1] * u[..., 0]).sum())
    assert abs(push) > 1e-3
    assert integrals.dissipation(solver, state) == pytest.approx(push + work, rel=1e-11)
