"""Péclet numbers of elements, and what their highest polynomials hold."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.legendre import legval

from hofsi import case
from hofsi.solvers.fluid import FluidState
from hofsi.solvers.fluid_resolution import flow_resolution


def state_of(solver, velocity, mesh_velocity=None):
    points = solver.mesh.points
    pressure = np.zeros(solver.space.pressure_count)
    return FluidState((velocity,), pressure, (points,), np.zeros(points.shape), 0.0, mesh_velocity)


@pytest.mark.parametrize("order", [2, 5])
def test_the_length_of_an_element_is_that_along_the_flow(flows, order):
    mesh = flows.rectangle(order, 4, 10, high=(2.0, 1.0))
    solver = flows.solver(mesh, [case.NoSlip(flows.around)], density=3.0, viscosity=0.2)
    ones = np.ones(len(mesh.points))
    for velocity, length in (((4.0, 0.0), 0.5), ((0.0, -4.0), 0.1)):
        found = flow_resolution(solver, state_of(solver, np.outer(ones, velocity)))
        np.testing.assert_allclose(found.peclet, 3.0 * 4.0 * length / (2.0 * 0.2 * order), rtol=1e-12)
        np.testing.assert_allclose(found.roughness, 0.0, atol=1e-14)
    moving = state_of(solver, np.outer(ones, (4.0, 0.0)), np.outer(ones, (4.0, 0.0)))
    np.testing.assert_array_equal(flow_resolution(solver, moving).peclet, 0.0)


@pytest.mark.parametrize("order", [2, 3, 6])
def test_roughness_is_the_share_of_the_highest_polynomials(flows, order):
    mesh = flows.rectangle(order, 1, 1, low=(-1.0, -1.0))
    solver = flows.solver(mesh, [case.NoSlip(flows.around)])
    x, y = mesh.points.T
    highest = [0.0] * order + [1.0]
    for along in (x, y):
        smooth = 1.0 + 0.3 * along
        velocity = np.stack([smooth + 0.1 * legval(along, highest), np.zeros_like(x)], axis=-1)
        expected = 0.1 / np.sqrt(2.0 * order + 1.0) / np.abs(velocity).max()
        assert flow_resolution(solver, state_of(solver, velocity)).roughness == pytest.approx([expected], rel=1e-12)


def test_a_fluid_at_rest_is_resolved(flows):
    solver = flows.solver(flows.grid(2), [case.NoSlip(flows.around)])
    found = flow_resolution(solver, state_of(solver, np.zeros(solver.mesh.points.shape)))
    assert not found.peclet.any()
    assert not found.roughness.any()
