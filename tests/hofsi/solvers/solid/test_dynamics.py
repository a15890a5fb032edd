"""Solids in motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hofsi.solvers.solid import SolidState


def test_free_fall_has_exact_velocity_and_second_order_position(solids):
    errors = []
    for dt in (0.1, 0.05):
        mesh = solids.rectangle(2)
        s = solids.solver(mesh, [], body_force=solids.pair(0, -2.0 * solids.RHO), initial_velocity=solids.initial(1, 0))
        state = solids.march(s, s.initial_state(), dt, round(1.0 / dt))
        np.testing.assert_allclose(state.velocity, np.tile([1.0, -2.0], (len(mesh.points), 1)), atol=1e-10)
        np.testing.assert_allclose(state.displacement[:, 0], 1.0, atol=1e-10)
        np.testing.assert_allclose(state.displacement[:, 1], state.displacement[0, 1], atol=1e-10)
        errors.append(abs(state.displacement[0, 1] + 1.0))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)


def bar(solids, dt, count, model="linear"):
    """First longitudinal mode of a bar, clamped at the left; ω = π/2 for solids.E/ρ = 1 and length 1."""
    mesh = solids.rectangle(4, 2, 1, (1.0, 0.1))
    boundaries = [solids.displacement("left", 0, None), solids.displacement(("bottom", "top"), None, 0)]
    s = solids.solver(
        mesh,
        boundaries,
        youngs_modulus=3.0,
        density=3.0,
        poissons_ratio=0.0,
        model=model,
        initial_displacement=solids.initial("1e-3*sin(pi*x/2)", 0),
    )
    return s, solids.march(s, s.initial_state(), dt, count)


def test_vibrating_bar_follows_its_mode_with_second_order(solids):
    errors = []
    for dt in (0.02, 0.01):
        s, state = bar(solids, dt, round(2.0 / dt))  # half a period
        exact = -1e-3 * np.sin(np.pi * s.mesh.points[:, 0] / 2.0)
        errors.append(np.abs(state.displacement[:, 0] - exact).max() / 1e-3)
    assert errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)


def test_vibrating_bar_keeps_its_energy_but_for_the_damping_of_the_scheme(solids):
    s, state = bar(solids, 0.01, 0)
    K = s.equations.tangent(
        s.equations.gradient(state.displacement), s.equations.stress(s.equations.gradient(state.displacement)), 0.0, []
    )

    def energy(state):
        d, v = state.displacement, state.velocity
        return 0.5 * np.sum(v * (s.equations.mass @ v)) + 0.5 * np.sum(d * s.equations.applied(K, d))

    energies = [energy(state)]
    exact = 0.1 * 3.0 * 1e-6 * (np.pi / 2.0) ** 2 / 4.0
    assert energies[0] == pytest.approx(exact, rel=1e-9)
    for _ in range(4):
        state = solids.march(s, state, 0.01, 50)
        energies.append(energy(state))
    assert (np.diff(energies) < 0.0).all()
    assert energies[-1] > 0.995 * energies[0]


def test_linear_solid_is_factorised_once_for_all_steps(solids):
    s, _ = bar(solids, 0.01, 20)
    assert s.counts.assemblies == s.counts.factorisations == 2  # one for the first step of first order
    assert s.counts.solves <= 40


def test_changed_step_size_keeps_the_velocity_consistent(solids):
    mesh = solids.rectangle(1, 1, 1)
    s = solids.solver(mesh, [solids.displacement(solids.around, "t*t", "3*t")])
    state = SolidState(
        (np.tile([1.0, 3.0], (len(mesh.points), 1)), np.tile([0.81, 2.7], (len(mesh.points), 1))),
        (np.tile([2.0, 3.0], (len(mesh.points), 1)), np.tile([1.8, 3.0], (len(mesh.points), 1))),
        1.0,
    )
    step = s.begin_step(state, [0.3, 0.1], 1.3)
    after = step.accept(step.solve())
    np.testing.assert_allclose(after.displacement, np.tile([1.69, 3.9], (len(mesh.points), 1)), atol=1e-9)
    np.testing.assert_allclose(after.velocity, np.tile([2.6, 3.0], (len(mesh.points), 1)), atol=1e-9)
    assert len(after.displacements) == 2
    assert after.time == 1.3


@pytest.mark.parametrize("guess", ["state", "velocity"])
def test_thin_plate_swings_through_large_deflections_without_failure(solids, guess):
    s, tip = solids.plate(body_force=solids.pair(0, -10))
    deflection = []
    state, dt = s.initial_state(), 0.02
    for k in range(25):
        step = s.begin_step(state, [dt, dt], (k + 1) * dt)
        start = None if guess == "state" else state.displacement + dt * state.velocity
        state = step.accept(step.solve(guess=start))
        deflection.append(state.displacement[tip, 1])
    assert min(deflection) < -0.65
    assert s.counts.factorisations <= 4 * 25
    assert s.counts.iterations <= 10 * 25


def test_thrown_plate_deflects_more_than_a_quarter_of_its_length(solids):
    s, tip = solids.plate(body_force=solids.pair(0, -100))
    state = solids.march(s, s.initial_state(), 0.02, 15, guess=lambda state: state.displacement + 0.02 * state.velocity)
    assert state.displacement[tip, 1] < -1.0
    assert s.equations.lowest_volume_ratio(state.displacement) > 0.9


def test_later_solutions_of_a_step_reuse_the_tangent(solids):
    s, tip = solids.plate(body_force=solids.pair(0, -10))
    state = solids.march(s, s.initial_state(), 0.005, 5)
    step = s.begin_step(state, [0.005, 0.005], state.time + 0.005)
    load = np.zeros(s.mesh.points.shape)
    d = step.solve(load)
    before = replace(s.counts)
    for k in range(1, 4):
        load[tip, 1] = 0.002 * 0.1**k
        d = step.solve(load, d)
    assert s.counts.factorisations == before.factorisations
    assert s.counts.iterations - before.iterations <= 12
    fresh = s.begin_step(state, [0.005, 0.005], state.time + 0.005).solve(load)
    np.testing.assert_allclose(d, fresh, atol=1e-9)


def test_loose_tolerance_saves_iterations(solids):
    s, _ = solids.plate(body_force=solids.pair(0, -10))
    state = solids.march(s, s.initial_state(), 0.01, 3)
    counts = []
    for tolerance in (1e-3, None):
        before = s.counts.iterations
        s.begin_step(state, [0.01, 0.01], state.time + 0.01).solve(tolerance=tolerance)
        counts.append(s.counts.iterations - before)
    assert counts[0] < counts[1]


def test_reaction_of_a_moving_solid_contains_its_inertia(solids):
    mesh = solids.rectangle(2)
    s = solids.solver(mesh, [solids.displacement(solids.around, "t*t", 0)])
    state = SolidState((np.zeros(mesh.points.shape),) * 2, (np.zeros(mesh.points.shape),) * 2, 0.0)
    state = solids.march(s, state, 0.1, 12)
    step = s.begin_step(state, [0.1, 0.1], state.time + 0.1)
    reaction = step.reaction(step.solve())
    # The inner nodes accelerate with the frame: all in all ρ · area · 2.
    np.testing.assert_allclose(reaction.sum(axis=0), [2.0 * solids.RHO, 0.0], rtol=5e-2, atol=1e-9)


def test_initial_fields_are_expressions_and_states_cannot_be_written(solids):
    mesh = solids.rectangle(2)
    s = solids.solver(mesh, [], initial_displacement=solids.initial("x*y", 2), initial_velocity=solids.initial(0, "x"))
    state = s.initial_state(3.0)
    np.testing.assert_allclose(state.displacement[:, 0], mesh.points.prod(axis=1))
    np.testing.assert_array_equal(state.displacement[:, 1], 2.0)
    np.testing.assert_allclose(state.velocity[:, 1], mesh.points[:, 0])
    assert state.time == 3.0
    with pytest.raises(ValueError, match="read-only"):
        state.displacement[0] = 1.0


def test_starting_value_does_not_change_the_result(solids):
    s, tip = solids.plate(body_force=solids.pair(0, -10))
    state = solids.march(s, s.initial_state(), 0.01, 3)
    results = [
        s.begin_step(state, [0.01, 0.01], state.time + 0.01).solve(guess=guess)
        for guess in (None, state.displacement + 0.01 * state.velocity, 0.5 * state.displacement)
    ]
    for d in results[1:]:
        np.testing.assert_allclose(d[tip], results[0][tip], rtol=1e-7)
