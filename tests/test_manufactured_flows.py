"""The exact flows of `benchmarks/manufactured_flows` solve the equations, and some are exact on moving blocks."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("skfem")
pytest.importorskip("hofsi")

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
ORDERS = (2, 3, 4, 5, 6)
FLOWS = ("IMPOSED", "KOVASZNAY", "LINEAR", "UNIFORM", "VORTEX")
SCENES = ("imposed", "waving_square")
TIMES = (0.1, 0.15, 0.25, 0.3, 0.4)


@pytest.fixture
def part(monkeypatch):
    """A module of the package by its name."""
    monkeypatch.syspath_prepend(str(FOLDER))
    return lambda name: importlib.import_module(f"manufactured_flows.{name}")


def derivative(f, at, along, h=1e-3):
    """Central difference of fourth order of f(x, y, t)."""
    e = h * np.eye(3)[along]
    return sum(w * f(at + k * e) for k, w in ((-2, 1.0), (-1, -8.0), (1, 8.0), (2, -1.0))) / (12.0 * h)


@pytest.mark.parametrize("name", FLOWS)
def test_flows_solve_the_equations(part, name):
    flow = getattr(part("flows"), name)
    at = np.random.default_rng(3127).uniform(0.1, 0.6, (20, 3))

    def u(z):
        return flow.velocity_at(z[:, :2], z[0, 2])

    def p(z):
        return flow.pressure_at(z[:, :2], z[0, 2])

    for time in (0.2, 0.7):
        at[:, 2] = time
        gradient = np.stack([derivative(u, at, k) for k in range(2)], axis=-1)  # (n, a, d)
        laplacian = sum(derivative(lambda z, k=k: derivative(u, z, k), at, k) for k in range(2))
        dp = np.stack([derivative(p, at, k) for k in range(2)], axis=-1)
        inertia = flow.density * (derivative(u, at, 2) + np.einsum("nad,nd->na", gradient, u(at)))
        scale = np.abs(inertia).max() + np.abs(dp).max() + 1.0
        residual = inertia - flow.viscosity * laplacian + dp - flow.force_at(at[:, :2], time)
        assert np.abs(residual).max() < 1e-7 * scale
        assert np.abs(np.trace(gradient, axis1=1, axis2=2)).max() < 1e-8 * scale
        stress = flow.viscosity * (gradient + gradient.transpose(0, 2, 1)) - p(at)[:, None, None] * np.eye(2)
        np.testing.assert_allclose(flow.traction_at(at[:, :2], time), stress[:, :, 0], rtol=0.0, atol=1e-7 * scale)
    start = flow.velocity_at(at[:, :2], 0.0)
    if name != "KOVASZNAY":  # steady, found from rest
        np.testing.assert_allclose(flow.initial_velocity_at(at[:, :2]), start, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("name", SCENES)
def test_all_blocks_move_and_are_curved(part, name, order):
    problem = part("journey").built(getattr(part("scenes"), name)(part("flows").UNIFORM, order, 2))
    motion, displacement = problem.fluid.motion, part("journey").displacement_of(problem)
    state = motion.move(motion.reference, displacement(0.4), 0.4)
    first, now = problem.fluid.mesh, state.mesh
    assert state.min_det_J > 0.0
    assert (np.abs(now.points - first.points).max(axis=1)[now.cells].max(axis=1) > 1e-3).all()
    x = now.points[now.cells.reshape(-1, order + 1, order + 1)]
    for mesh_lines in (x, x.swapaxes(1, 2)):
        a, b, c = mesh_lines[:, :, 0], mesh_lines[:, :, order // 2], mesh_lines[:, :, order]
        assert np.hypot(*(b - 0.5 * (a + c)).reshape(-1, 2).T).max() > 1e-2 / order**2


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("name", "convection"), [("imposed", "linearised"), ("waving_square", "newton")])
def test_a_uniform_flow_stays_uniform_on_moving_blocks(part, name, convection, order):
    flow = part("flows").UNIFORM
    problem = part("journey").built(getattr(part("scenes"), name)(flow, order, 1, convection=convection))
    state = part("journey").journey(flow, problem, TIMES)
    assert np.abs(state.points[0] - problem.fluid.mesh.points).max() > 0.04
    np.testing.assert_allclose(state.velocity, 1.0, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(state.pressure, 3.0 if name == "imposed" else 0.0, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", SCENES)
def test_a_linear_flow_that_is_quadratic_in_time_is_exact_on_moving_blocks(part, name, order):
    # u = g(t) + G x at nodes anywhere: the backward differences of g and of the positions are exact and cancel.
    flow = part("flows").linear("(1 + 2*t - 3*t**2)", "(2 - 6*t)")
    problem = part("journey").built(getattr(part("scenes"), name)(flow, order, 1, convection="newton"))
    state = part("journey").journey(flow, problem, TIMES)
    exact = flow.velocity_at(state.points[0], TIMES[-1])
    np.testing.assert_allclose(state.velocity, exact, rtol=0.0, atol=1e-11)
    # At single nodes rounding leaves 8e-11 of the pressure, which is of the size of density times speed over step.
    assert max(part("errors").l2_errors(flow, problem.fluid.solver, state)) < 1e-11
