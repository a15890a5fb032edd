"""The fluid: what is computed how often."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi import case
from hofsi.errors import MeshMotionError

NOBODY = np.zeros((0, 2))


def test_a_mesh_at_rest_is_prepared_once(flows):
    solver = flows.channel(initial_velocity=(flows.parabola, "0"))
    flows.march(solver, solver.initial_state(), (0.1,) * 5, linear=True)
    counts = solver.counts
    assert counts.geometries == 1
    assert counts.constant_assemblies == 2  # BDF1, then BDF2
    assert (counts.assemblies, counts.factorisations, counts.solves) == (5, 5, 5)
    assert counts.iterations == 0


def test_stokes_flow_on_a_mesh_at_rest_is_factorised_once_for_each_step_size(flows):
    solver = flows.channel(model="stokes")
    state = flows.march(solver, solver.initial_state(), (0.1,) * 5, linear=True)
    counts = solver.counts
    assert (counts.geometries, counts.constant_assemblies, counts.assemblies) == (1, 2, 0)
    assert (counts.factorisations, counts.solves) == (2, 5)
    flows.march(solver, state, (0.05,), linear=False, steps=(0.1,) * 5)
    assert counts.factorisations == 3
    assert counts.assemblies == 0


def test_a_moving_mesh_is_prepared_once_a_step(flows):
    solver = flows.channel(initial_velocity=(flows.parabola, "0"))
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


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_a_linear_step_responds_to_its_interface_without_a_solution(flows, model):
    mesh = flows.grid(3)
    top = mesh.edge_nodes("top")
    conditions = [case.NoSlip(("left", "bottom")), case.DoNothing(("right",))]
    solver = flows.solver(mesh, conditions, interface=top, model=model)
    state = solver.initial_state()

    def begin(responding):
        return solver.begin_step(state, mesh.points, (0.1,), 0.1, convection="extrapolated", responding=responding)

    rng = np.random.default_rng(31)
    first, second, third = (rng.standard_normal((len(top), 2)) for _ in range(3))
    step = begin(True)
    assert step.respond(first) is None  # not solved yet
    step.solve(first)
    np.testing.assert_allclose(step.respond(first), step.reaction()[top], rtol=0.0, atol=1e-13)
    answers = step.respond(second), step.respond(third)
    made = solver.counts.solves
    for velocity, answer in zip((second, third), answers, strict=True):
        u, p = step.solve(velocity)
        reference = begin(False)
        u_again, p_again = reference.solve(velocity)
        np.testing.assert_allclose(u, u_again, rtol=0.0, atol=1e-11 * np.abs(u).max())
        np.testing.assert_allclose(p, p_again, rtol=0.0, atol=1e-11 * np.abs(p).max())
        exact = reference.reaction()[top]
        np.testing.assert_allclose(answer, exact, rtol=0.0, atol=1e-11 * np.abs(exact).max())
        np.testing.assert_allclose(step.reaction()[top], exact, rtol=0.0, atol=1e-11 * np.abs(exact).max())
        assert reference.respond(velocity) is None
    assert solver.counts.solves == made + 2  # those of the reference


@pytest.mark.parametrize("convection", ["linearised", "extrapolated"])
@pytest.mark.parametrize("open_end", [True, False])
def test_the_reaction_that_factors_tell_is_that_of_the_fields(flows, convection, open_end):
    """A second solution starts from the first and finds nothing to correct: its reaction is the residual there."""
    mesh = flows.grid(3, turn=0.4)
    # Slip puts nodes into frames of their own; what leaves on the left comes in at the open end.
    ends = [flows.velocity("left", "-1 - y", "x*y"), case.DoNothing(("right",), backflow=0.7)]
    conditions = [
        case.Slip(("top",)),
        case.NoSlip(("bottom",)),
        *(ends if open_end else [case.NoSlip(("left", "right"))]),
    ]
    solver = flows.solver(mesh, conditions, body_force=("y", "-2"))
    state = flows.march(solver, solver.initial_state(), (0.1,) * 3)
    shift = 0.02 * np.random.default_rng(47).standard_normal(mesh.points.shape)
    shift[np.unique(np.concatenate([mesh.edge_nodes(name) for name in flows.around]))] = 0.0
    step = solver.begin_step(state, mesh.points + shift, (0.1, 0.1), 0.4, convection=convection)
    made = solver.counts.solves, solver.counts.iterations
    step.solve(NOBODY)
    first = step.reaction()
    step.solve(NOBODY)
    assert (solver.counts.solves, solver.counts.iterations) == (made[0] + 2, made[1])
    assert open_end == bool(solver.counts.backflows)
    np.testing.assert_allclose(first, step.reaction(), rtol=0.0, atol=1e-11 * np.abs(first).max())


def test_an_enclosed_fluid_does_not_respond_without_a_solution(flows):
    mesh = flows.grid(3)
    top = mesh.edge_nodes("top")
    solver = flows.solver(mesh, [case.NoSlip(("left", "bottom", "right"))], interface=top)
    step = solver.begin_step(
        solver.initial_state(), mesh.points, (0.1,), 0.1, convection="extrapolated", responding=True
    )
    step.solve(np.zeros((len(top), 2)))
    assert step.respond(np.zeros((len(top), 2))) is None


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


def test_elements_that_stand_still_keep_their_matrices(flows):
    """Those of a mesh that moves in part are, to the bit, the ones that are made anew of all elements."""
    mesh = flows.grid(3, columns=6, rows=4)
    conditions = [case.NoSlip(("left", "bottom", "top")), case.DoNothing(("right",))]
    solver = flows.solver(mesh, conditions)
    for time in (0.0, 0.1, 0.2, 0.3):
        points = mesh.points.copy()
        points[:, 0] += time * np.maximum(0.0, points[:, 0] - 0.55) ** 2
        here, afresh = solver.constant_terms(points, 2.0).ask(), flows.solver(mesh, conditions)
        matrices = afresh.constant_terms(points, 2.0).ask().matrices
        for elements in (slice(0, 5), slice(5, 13), slice(13, 24)):
            np.testing.assert_array_equal(here.matrices(elements), matrices(elements))
            np.testing.assert_array_equal(solver.geometry(points).x[elements], afresh.geometry(points).x[elements])
            np.testing.assert_array_equal(
                solver.geometry(points).J_inv[elements], afresh.geometry(points).J_inv[elements]
            )
    moved = (mesh.points[mesh.cells][:, :, 0] > 0.55).any(axis=1)
    assert 6 < moved.sum() < 18
    assert solver.counts.elements_kept == 3 * (~moved).sum()


def test_matrices_of_an_earlier_mesh_are_still_those_of_that_mesh(flows):
    """Whoever holds them may ask when the solver has gone on, and disturbs nothing."""
    mesh = flows.grid(3, columns=6, rows=4)
    conditions = [case.NoSlip(("left",))]
    solver, some = flows.solver(mesh, conditions), slice(0, len(mesh.cells))

    def at(time):
        points = mesh.points.copy()
        points[:, 0] += time * np.maximum(0.0, points[:, 0] - 0.55) ** 2
        return points

    places = [at(time) for time in (0.0, 0.1, 0.2)]
    afresh = [flows.solver(mesh, conditions).constant_terms(p, 2.0).ask().matrices(some) for p in places]
    first = solver.constant_terms(places[0], 2.0)
    np.testing.assert_array_equal(first.ask().ask().matrices(some), afresh[0])
    second = solver.constant_terms(places[1], 2.0).ask()
    np.testing.assert_array_equal(second.matrices(some), afresh[1])
    np.testing.assert_array_equal(first.matrices(some), afresh[0])
    np.testing.assert_array_equal(second.matrices(some), afresh[1])
    third = solver.constant_terms(places[2], 2.0).ask()
    np.testing.assert_array_equal(second.matrices(some), afresh[1])
    np.testing.assert_array_equal(third.matrices(some), afresh[2])


def test_another_step_size_makes_all_matrices_anew(flows):
    mesh = flows.grid(2)
    solver = flows.solver(mesh, [case.NoSlip(("left",))])
    points, all_elements = mesh.points.copy(), slice(0, len(mesh.cells))
    solver.constant_terms(mesh.points, 2.0).ask().matrices(all_elements)
    found = solver.constant_terms(points, 3.0).ask().matrices(all_elements)
    afresh = flows.solver(mesh, [case.NoSlip(("left",))]).constant_terms(points, 3.0).ask().matrices(all_elements)
    np.testing.assert_array_equal(found, afresh)
    assert solver.counts.elements_kept == 0


def test_an_element_that_turns_over_is_named_by_its_number(flows):
    mesh = flows.grid(2, jitter=0.0)
    solver = flows.solver(mesh, [case.NoSlip(("left",))])
    solver.geometry(mesh.points)
    points = mesh.points.copy()
    last = mesh.cells[-1]
    points[last] = points[last][:, ::-1]  # x and y exchanged
    with pytest.raises(MeshMotionError, match=rf"element {len(mesh.cells) - 1}: det J"):
        solver.geometry(points)
