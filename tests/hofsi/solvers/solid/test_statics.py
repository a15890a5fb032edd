"""Solids at rest: reactions, large loads, failure."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hoblock import generate
from hoblock.building import build_structure
from hofsi import case
from hofsi.errors import CaseError, NewtonError
from hofsi.io.scene import load_case
from hofsi.solvers.solid import SolidSolver

EXAMPLES = Path(__file__).parents[4] / "examples"


def test_supports_carry_the_loads(solids):
    mesh = solids.rectangle(3, 4, 2, (2.0, 1.0))
    boundaries = [solids.displacement("left", 0, 0), solids.pressure("top", 1.5), solids.traction("right", 0.5, 1)]
    s = solids.solver(mesh, boundaries, body_force=solids.pair(0, -0.5))
    step = s.begin_static()
    load = np.zeros(mesh.points.shape)
    load[mesh.edge_nodes("bottom")] = [0.05, 0.01]
    d = step.solve(load)
    reaction = step.reaction(d, load)
    x = mesh.points + d
    top = mesh.points[:, 1] > 1.0 - 1e-9
    ends = x[top][np.argsort(mesh.points[top, 0])][[0, -1]]
    pushed = 1.5 * np.array([ends[1, 1] - ends[0, 1], -(ends[1, 0] - ends[0, 0])])  # -p ∫ n ds depends on the ends only
    applied = pushed + np.array([0.5, 1.0]) + np.array([0.0, -1.0]) + load.sum(axis=0)
    np.testing.assert_allclose(reaction.sum(axis=0), -applied, rtol=1e-9)
    free = np.setdiff1d(np.arange(len(d)), mesh.edge_nodes("left"))
    assert np.abs(reaction[free]).max() == 0.0


def test_no_load_no_displacement(solids):
    s = solids.solver(solids.rectangle(2), [solids.displacement("left", 0, 0)])
    assert np.abs(solids.equilibrium(s)).max() == 0.0
    assert s.counts.factorisations == 0


def test_csm1_of_turek_and_hron():
    given = load_case(EXAMPLES / "csm1.toml")
    mesh = generate(build_structure(given.mesh), given.mesh.order)
    s = SolidSolver(mesh, given.solids, given.nonlinear)
    step = s.begin_static()
    state = step.accept(step.solve())
    tip = int(np.argmin(np.hypot(*(mesh.points - [0.6, 0.2]).T)))
    np.testing.assert_allclose(state.displacement[tip], [-7.18777e-3, -6.61029e-2], rtol=5e-4)


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff", "neo-hooke"])
def test_multigrid_bends_the_flag_as_factors_do(solids, model):
    pytest.importorskip("pyamg")
    given = load_case(EXAMPLES / "csm1.toml")
    mesh = generate(build_structure(given.mesh), given.mesh.order)
    bodies = [replace(given.solids[0], model=model)]
    direct, amg = (SolidSolver(mesh, bodies, given.nonlinear, case.LinearSettings(kind)) for kind in ("direct", "amg"))
    expected = solids.equilibrium(direct)
    step = amg.begin_static()
    np.testing.assert_allclose(step.solve(), expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    assert step._newton.tangent.factor.factor.iterations > 1  # of FGMRES


def test_slender_cantilever_is_bent_far_from_zero_in_one_go(solids):
    s, tip = solids.plate(body_force=solids.pair(0, -600))
    step = s.begin_static()
    d = step.accept(step.solve()).displacement
    assert d[tip, 1] < -3.0
    x = s.mesh.points + d
    bottom = s.mesh.edge_nodes("bottom")
    order = bottom[np.argsort(s.mesh.points[bottom, 0])]
    length = np.sum(np.hypot(*np.diff(x[order], axis=0).T))
    assert length == pytest.approx(4.0, rel=2e-2)  # bends, does not stretch
    assert s.counts.iterations <= 25


def test_load_is_applied_in_parts_where_newton_does_not_converge_at_once(solids):
    loads = {"body_force": solids.pair(0, -600)}
    patient, tip = solids.plate(**loads)
    expected = patient.begin_static().solve()
    hasty, _ = solids.plate(**loads)
    hasty.nonlinear = case.NonlinearSettings(1e-10, 8)
    step = hasty.begin_static()
    with pytest.raises(NewtonError, match="after 8 iterations"):
        step._newton.solve(step.state.displacement, hasty.equations.loads.dead(0.0), 1e-10)
    d = hasty.begin_static().solve()
    np.testing.assert_allclose(d[tip], expected[tip], rtol=1e-7)


def test_follower_pressure_rolls_a_strip_up(solids):
    """A cantilever under p = 24 EI/L³: its end turns by more than 180°, where dead loads would lead elsewhere."""
    mesh = solids.rectangle(4, 10, 1, (1.0, 0.01))
    s = solids.solver(
        mesh,
        [solids.displacement("left", 0, 0), solids.pressure("top", 2)],
        1e-10,
        youngs_modulus=1e6,
        poissons_ratio=0.0,
    )
    step = s.begin_static()
    d = step.solve()
    end = mesh.edge_nodes("right")
    elastica = [-1.38903, -0.51141]  # of the inextensible middle line, by collocation
    np.testing.assert_allclose(d[end].mean(axis=0), elastica, atol=0.01)  # the thickness
    x, top = mesh.points + d, mesh.edge_nodes("top")
    first, last = x[top[np.argmin(mesh.points[top, 0])]], x[top[np.argmax(mesh.points[top, 0])]]
    pushed = 2.0 * np.array([last[1] - first[1], first[0] - last[0]])
    np.testing.assert_allclose(step.reaction(d).sum(axis=0), -pushed, rtol=1e-7)


def test_parts_of_a_prescribed_movement_add_up(solids):
    mesh = solids.rectangle(2, 4, 2, (2.0, 1.0))
    s = solids.solver(mesh, [solids.displacement("left", 0, 0), solids.displacement("right", "0.6", "-0.8")])
    step = s.begin_static()
    at_once = step.solve()
    in_parts = step._newton.solve_by_parts(step.state.displacement, s.equations.loads.dead(0.0), 1e-11)
    np.testing.assert_allclose(in_parts, at_once, atol=1e-9)
    np.testing.assert_allclose(in_parts[mesh.edge_nodes("right")], np.tile([0.6, -0.8], (5, 1)), atol=1e-14)


def test_hopeless_load_is_reported_with_numbers(solids):
    s = solids.solver(
        solids.rectangle(1, 2, 1),
        [solids.displacement("left", 0, 0), solids.traction("right", 20, 20)],
        max_iterations=1,
    )
    with pytest.raises(NewtonError, match=r"solid, t = 0: .*of the load was reached") as caught:
        solids.equilibrium(s)
    assert caught.value.reason == "max_iterations"


def test_load_that_is_not_finite_is_reported(solids):
    s = solids.solver(solids.rectangle(1, 2, 1), [solids.displacement("left", 0, 0)])
    load = np.zeros(s.mesh.points.shape)
    load[1, 0] = np.nan
    with pytest.raises(NewtonError, match="residual is not finite") as caught:
        solids.equilibrium(s, load)
    assert caught.value.reason == "diverged"


@pytest.mark.parametrize("model", ["linear", "st-venant-kirchhoff", "neo-hooke"])
def test_solid_without_support_is_reported(solids, model):
    s = solids.solver(solids.rectangle(1, 2, 1), [], body_force=solids.pair(1, 0), model=model)
    with pytest.raises(CaseError, match=r"solid\[0\].boundary: solid 'block' is not held: it can move anywhere"):
        solids.equilibrium(s)


def test_solid_turned_inside_out_is_not_accepted(solids):
    mesh = solids.rectangle(1, 1, 1)
    step = solids.solver(mesh, [solids.displacement("left", 0, 0)]).begin_static()
    with pytest.raises(NewtonError, match=r"turned inside out: det F is -0\.5") as caught:
        step.accept(mesh.points * [-1.5, 0.0])
    assert caught.value.reason == "inverted"
