"""Loads that answer to displacements: the linear systems, and solids under such loads."""

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.errors import LinearSolverError
from hofsi.solvers.load_response import LoadResponse, RespondingSystem, unknowns_of
from hofsi.solvers.solid import SolidSolver, SolidState


def expression(text):
    return compile_expression(text, ("x", "y", "t"))


def bar(scheme=None, linear=None, rollers=(), model="st-venant-kirchhoff", lift="0"):
    """Clamped on the left, loaded on top."""
    corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 0.4), (0.0, 0.5)]
    edges = {"left": [(3, 0)], "top": [(2, 3)], "right": [(1, 2)]}
    counts = {(0, 1): 3, (1, 2): 1}
    mesh = generate(BlockStructure.build(corners, {"solid": [(0, 1, 2, 3)]}, counts=counts, edges=edges), 3)
    held = [
        case.Displacement(("left",), expression("0"), expression(lift)),
        *(case.Roller((name,)) for name in rollers),
    ]
    body = case.Solid("bar", 2.0, 100.0, 0.3, ("solid",), tuple(held), model=model)
    nonlinear = case.NonlinearSettings(1e-12, 25)
    return SolidSolver(mesh, [body], nonlinear, linear, scheme), mesh.edge_nodes("top")


def answering(nodes, rng, size=5.0):
    """A response that resists, not symmetrically."""
    k = 2 * len(nodes)
    matrix = rng.standard_normal((k, k))
    return LoadResponse(
        nodes, -size * (matrix @ matrix.T / k + 0.2 * matrix), 0.01 * rng.standard_normal((len(nodes), 2))
    )


def test_the_system_is_solved_as_by_the_full_matrix():
    rng = np.random.default_rng(3)
    K, nodes = rng.standard_normal((14, 14)) + 8.0 * np.eye(14), np.array([1, 4, 6])
    response = answering(nodes, rng)
    F = np.zeros_like(K)
    unknowns = unknowns_of(nodes)
    F[np.ix_(unknowns, unknowns)] = response.matrix
    C = np.linalg.inv(K)[np.ix_(unknowns, unknowns)]
    system = RespondingSystem(lambda r: np.linalg.solve(K, r.ravel()).reshape(-1, 2), C, response)
    r = rng.standard_normal((7, 2))
    np.testing.assert_allclose(system.solve(r), np.linalg.solve(K - F, r.ravel()).reshape(-1, 2), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("entry", "words"), [(1.0, "singular together"), (np.nan, "not finite")])
def test_a_response_that_takes_all_stiffness_is_reported(entry, words):
    response = LoadResponse(np.array([0]), entry * np.eye(2), np.zeros((1, 2)))
    with pytest.raises(LinearSolverError, match=words):
        RespondingSystem(lambda r: r, np.eye(2), response)


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff", "neo-hooke"])
@pytest.mark.parametrize("name", ["bdf2", "generalised-alpha", "energy-momentum"])
def test_the_load_found_is_the_one_that_the_displacement_answers(name, model):
    """A plain solution under the load at the displacement found gives it again."""
    s, top = bar(case.SolidScheme(name), model=model)
    rng = np.random.default_rng(8)
    start = s.initial_state()
    state = SolidState(
        start.displacements,
        start.velocities,
        0.0,
        accelerations=start.accelerations,
        loads=(np.zeros_like(start.velocity),),
    )
    load = np.zeros_like(start.displacement)
    load[top] = 0.3 * rng.standard_normal((len(top), 2))
    response = answering(top, rng)
    found = s.begin_step(state, [0.3], 0.3).solve(load, response=response)
    assert np.abs(found).max() > 0.003
    total = load.copy()
    response.add_force(total, found)
    assert np.abs(total - load).max() > 0.03
    again = s.begin_step(state, [0.3], 0.3).solve(total)
    np.testing.assert_allclose(found, again, rtol=0.0, atol=1e-10 * np.abs(again).max())


def test_equilibrium_under_an_answering_load_with_a_support_that_moves():
    s, top = bar(lift="0.1*y")
    rng = np.random.default_rng(9)
    response = answering(top, rng, 0.5)
    load = np.zeros_like(s.mesh.points)
    found = s.begin_static().solve(load, response=response)
    total = np.zeros_like(load)
    response.add_force(total, found)
    np.testing.assert_allclose(found, s.begin_static().solve(total), rtol=0.0, atol=1e-10 * np.abs(found).max())


def test_one_tangent_serves_a_load_that_answers_and_one_that_does_not():
    s, top = bar()
    step = s.begin_static()
    load = np.zeros_like(s.mesh.points)
    load[top] = [0.0, -1e-3]
    alone = step.solve(load)
    factorisations = s.counts.factorisations
    step.solve(load, alone, response=answering(top, np.random.default_rng(2), 1e-3))
    np.testing.assert_allclose(step.solve(load, alone), alone, rtol=0.0, atol=1e-11 * np.abs(alone).max())
    assert s.counts.factorisations == factorisations


def test_inclined_rollers_and_iterative_solvers_do_not_take_responses():
    s, top = bar()
    assert s.takes_response(top)
    rolled, top = bar(rollers=["top"])  # the top is inclined
    assert not rolled.takes_response(top)
    iterative, top = bar(linear=case.LinearSettings("amg"))
    assert not iterative.takes_response(top)
