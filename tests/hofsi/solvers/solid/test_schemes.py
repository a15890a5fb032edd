"""Time schemes of solids: order, damping, and what is conserved."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.solvers.solid import SolidSolver

SCHEMES = ("bdf2", "generalised-alpha", "energy-momentum")
RHO, E, NU = 2.0, 40.0, 0.3


def expression(text, variables=("x", "y", "t")):
    return compile_expression(str(text), variables)


def block(scheme, boundaries=(), *, radius=0.8, order=2, elements=(2, 1), **changes):
    """A block 2 × 1 with the given conditions, free elsewhere."""
    edges = {"bottom": [(0, 1)], "right": [(1, 2)], "top": [(2, 3)], "left": [(3, 0)]}
    counts = dict(zip(((0, 1), (1, 2)), elements, strict=True))
    vertices = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]
    mesh = generate(BlockStructure.build(vertices, {"solid": [(0, 1, 2, 3)]}, counts=counts, edges=edges), order)
    taken = [name for condition in boundaries for name in condition.on]
    free = case.Free(tuple(name for name in edges if name not in taken))
    body = case.Solid("block", RHO, E, NU, ("solid",), (*boundaries, free), **changes)
    return SolidSolver(mesh, [body], case.NonlinearSettings(1e-11, 40), None, case.SolidScheme(scheme, radius))


def march(solver, steps, state=None, load=lambda time: None):
    state = solver.initial_state() if state is None else state
    made, states = [], []
    for h in steps:
        made.insert(0, h)
        time = state.time + h
        step = solver.begin_step(state, made, time)
        state = step.accept(step.solve(load(time)))
        states.append(state)
    return states


def energy_density(solver, state):
    """W at quadrature points."""
    equations, body = solver.equations, solver.solids[0]
    H = equations.gradient(state.displacement)
    G = H + H.swapaxes(-1, -2) + H.swapaxes(-1, -2) @ H
    if body.model == "st-venant-kirchhoff":
        strain = 0.5 * np.stack([G[..., 0, 0], G[..., 1, 1], 2.0 * G[..., 0, 1]], axis=-1)
        return 0.5 * np.sum(equations.stress(H) * strain, axis=-1)
    lame, mu = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))
    log_J, c = np.log(np.linalg.det(H + np.eye(2))), np.ones(H.shape[:2])
    if body.plane == "stress":
        for _ in range(30):
            c -= (mu * (c - 1.0) + lame * (log_J + 0.5 * np.log(c))) / (mu + 0.5 * lame / c)
        log_J += 0.5 * np.log(c)
    trace = G[..., 0, 0] + G[..., 1, 1] + c - 1.0
    return 0.5 * mu * trace - mu * log_J + 0.5 * lame * log_J**2


def invariants(solver, state):
    """Energy, momentum and angular momentum."""
    equations = solver.equations
    elastic = float((equations._weights * energy_density(solver, state)).sum())
    v, x = state.velocity, solver.mesh.points + state.displacement
    p = equations.mass @ v
    return np.array(
        [elastic + 0.5 * float((v * p).sum()), *p.sum(axis=0), float(np.sum(x[:, 0] * p[:, 1] - x[:, 1] * p[:, 0]))]
    )


THROWN = {
    "initial_velocity": (expression("1 - 3*y + x*y", ("x", "y")), expression("0.5 + 3*x - y**2", ("x", "y"))),
    "initial_displacement": (expression("0.1*x*y", ("x", "y")), expression("0.05*x", ("x", "y"))),
}


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("model", ["st-venant-kirchhoff", "neo-hooke"])
def test_free_flight_keeps_energy_and_momenta_with_the_midpoint_rule(model, plane):
    solver = block("energy-momentum", **THROWN, model=model, plane=plane)
    before = invariants(solver, solver.initial_state())
    states = march(solver, (0.05, 0.02, 0.08) * 20)
    assert np.ptp([state.displacement[0, 0] for state in states]) > 0.5  # it moves far and turns over
    for state in states:
        np.testing.assert_allclose(invariants(solver, state), before, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("scheme", ["bdf2", "generalised-alpha"])
def test_the_others_do_not_keep_the_energy(scheme):
    solver = block(scheme, **THROWN)
    before = invariants(solver, solver.initial_state())[0]
    after = invariants(solver, march(solver, (0.05,) * 60)[-1])[0]
    assert abs(after / before - 1.0) > 1e-3


def test_the_mean_of_the_strains_is_what_keeps_it():
    solver = block("energy-momentum", **THROWN)
    equations = solver.equations
    rng = np.random.default_rng(2)
    a, b = 0.3 * rng.standard_normal((2, *solver.mesh.points.shape))
    first, last = equations.gradient(a), equations.gradient(b)
    middle = 0.5 * (first + last)
    mean = equations.mean_stress(middle, first)
    np.testing.assert_allclose(mean, 0.5 * (equations.stress(first) + equations.stress(last)), atol=1e-12)


MOVING = case.Displacement(("left",), expression("0.1*t**3"), expression("0.2*sin(2*t)**3"))
FIXED = case.Displacement(("left",), expression("0"), expression("0"))
LOADS = (
    case.Traction(("top",), expression("0"), expression("-3*sin(2*t)**4")),
    case.Pressure(("right",), expression("2*sin(t)**4")),
)


@pytest.mark.parametrize("steps", [(1.0, 1.0), (1.2, 0.8)])
@pytest.mark.parametrize("support", [MOVING, FIXED])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_order_two_also_with_varying_steps(scheme, support, steps):
    """Large deflections; of displacement and velocity, and of the force of supports that stand still."""
    ends = []
    for count in (60, 120, 240):
        solver = block(scheme, (support, *LOADS))
        force = np.zeros(solver.mesh.points.shape)
        force[solver.mesh.edge_nodes("bottom"), 1] = 0.3
        sizes = np.tile(steps, count // 2) / count
        state = march(solver, sizes, load=lambda time, force=force: force * np.sin(time) ** 4)[-1]
        ends.append((state.displacement, state.velocity, state.reaction.sum(axis=0)))
    quantities = list(zip(*ends, strict=True))[: 2 if support is MOVING else 3]
    for coarse, middle, fine in quantities:
        assert np.log2(np.abs(coarse - middle).max() / np.abs(middle - fine).max()) > 1.7


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_order_two_of_neo_hookean_solids_that_keep_their_energy(plane):
    ends = []
    for count in (60, 120, 240):
        solver = block("energy-momentum", (FIXED, *LOADS), model="neo-hooke", plane=plane)
        state = march(solver, (1.0 / count,) * count)[-1]
        ends.append((state.displacement, state.velocity, state.reaction.sum(axis=0)))
    for coarse, middle, fine in zip(*ends, strict=True):
        assert np.log2(np.abs(coarse - middle).max() / np.abs(middle - fine).max()) > 1.7


@pytest.mark.parametrize("radius", [0.0, 0.5, 0.9, 1.0])
def test_fast_oscillations_are_damped_as_asked_for(radius):
    """Linear solid, huge steps: the amplitude falls by the spectral radius in each; the roots may be double."""
    clamp = case.Displacement(("left",), expression("0"), expression("0"))
    shape = (expression("0", ("x", "y")), expression("1e-3*x**2", ("x", "y")))
    solver = block("generalised-alpha", (clamp,), radius=radius, model="linear", initial_displacement=shape)
    states = march(solver, (1e4,) * 40)
    size = [np.abs(state.displacement).max() for state in states]
    if radius == 0.0:
        assert size[4] < 1e-6 * 4e-3
    else:
        assert (size[39] / size[29]) ** 0.1 == pytest.approx(radius, rel=0.12)


def test_without_damping_a_linear_solid_keeps_its_energy():
    clamp = case.Displacement(("left",), expression("0"), expression("0"))
    shape = (expression("0", ("x", "y")), expression("1e-3*x**2", ("x", "y")))
    energies = {}
    for radius in (1.0, 0.5):
        solver = block("generalised-alpha", (clamp,), radius=radius, model="linear", initial_displacement=shape)
        K = solver.equations.tangent(solver.equations.gradient(0.0 * solver.mesh.points), np.zeros((2, 16, 3)), 0.0, [])

        def energy(state, solver=solver, K=K):
            d, v = state.displacement, state.velocity
            return 0.5 * float((d * solver.equations.applied(K, d)).sum() + (v * (solver.equations.mass @ v)).sum())

        energies[radius] = [energy(state) for state in march(solver, (0.02,) * 300)]
    assert np.ptp(energies[1.0][10:]) < 0.02 * energies[1.0][0]
    assert energies[1.0][-1] == pytest.approx(energies[1.0][0], rel=2e-2)
    assert energies[0.5][-1] < 0.95 * energies[0.5][0]


def test_initial_acceleration_is_that_of_the_loads():
    gravity = (expression("0"), expression("-2"))
    solver = block("generalised-alpha", body_force=gravity)
    np.testing.assert_allclose(solver.initial_state().accelerations[0], np.tile([0.0, -1.0], (15, 1)), atol=1e-12)
    state = march(solver, (0.1, 0.3))[-1]
    np.testing.assert_allclose(state.displacement[:, 1], -0.5 * 0.4**2, rtol=1e-10)


@pytest.mark.parametrize("scheme", SCHEMES[1:])
def test_a_load_of_the_fluid_acts_at_the_point_of_equilibrium(scheme):
    """A rigid body under a force that grows linearly: v = t²/2 m, to which averaging at the point is exact."""
    solver = block(scheme)
    load = np.zeros(solver.mesh.points.shape)
    ones = np.ones(len(load))
    mass = solver.equations.mass @ ones  # nodal shares of a uniform force
    states = march(solver, (0.1,) * 10, load=lambda time: np.stack([0.0 * mass, time * mass], axis=-1))
    exact = states[-1].time ** 2 / 2.0
    late = states[-1].velocity[:, 1] - states[0].velocity[:, 1]
    assert late == pytest.approx(exact - 0.1**2 / 2.0, rel=2e-2)


def test_a_constant_pressure_acts_once():
    """The initial acceleration takes it too, and leaves the loads that are kept as they are."""
    pressed = case.Pressure(("bottom",), expression("2"))
    solver = block("generalised-alpha", (pressed,), body_force=(expression("0"), expression("0")))
    acceleration = solver.initial_state().accelerations[0]
    np.testing.assert_allclose((solver.equations.mass @ acceleration).sum(axis=0), [0.0, 4.0], atol=1e-10)
    assert not solver.equations.loads.dead(0.0).any()
    state = march(solver, (1e-3,))[-1]
    momentum = (solver.equations.mass @ state.velocity).sum(axis=0)
    np.testing.assert_allclose(momentum, [0.0, 4e-3], atol=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_starting_step_is_one_of_backward_differences(scheme):
    solver = block(scheme, **THROWN)
    reference = block("bdf2", **THROWN)
    load = np.random.default_rng(11).normal(size=solver.mesh.points.shape)
    got, expected = ([s.initial_state()] for s in (solver, reference))
    for k, steps in enumerate(([0.01], [0.01, 0.01])):
        for states, own in ((got, solver), (expected, reference)):
            step = own.begin_step(states[-1], steps, 0.01 * (k + 1), starting=True)
            states.append(step.accept(step.solve(load)))
    np.testing.assert_allclose(got[-1].displacement, expected[-1].displacement, atol=1e-10)
    np.testing.assert_allclose(got[-1].velocity, expected[-1].velocity, atol=1e-8)
    assert [len(state.loads) for state in got] == [0, 1, 2]
    assert len(got[-1].accelerations) == (scheme != "bdf2")
