"""The power of the surroundings against dissipation and convected energy."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi import case
from hofsi.solvers.fluid_integrals import dissipation
from hofsi.solvers.fluid_power import FluidPower

CONDITIONS = {
    "do-nothing": lambda flows: case.DoNothing(("right",)),
    "pressure": lambda flows: case.Pressure(("right",), flows.expression("0.3*y")),
    "traction": lambda flows: case.Traction(("right",), flows.expression("0.2"), flows.expression("y")),
}


def bent_channel(flows, outlet, **changes):
    mesh = flows.rectangle(4, 3, 2)
    x, y = mesh.points.T
    mesh = mesh.with_points(np.stack([x, y * (1.0 - 0.2 * np.sin(x)) + 0.1 * x**2], axis=-1))
    conditions = [
        flows.velocity("left", "y*(1 - y)", 0),
        case.NoSlip(("bottom",)),
        flows.velocity("top", "0.3", "0.1*x"),
        CONDITIONS[outlet](flows),
    ]
    return flows.solver(mesh, conditions, viscosity=0.2, body_force=("x*y", "1 - y"), **changes)


@pytest.mark.parametrize("outlet", CONDITIONS)
def test_steady_stokes_flow_dissipates_what_it_is_given(flows, outlet):
    solver = bent_channel(flows, outlet, model="stokes")
    state = flows.steady(solver)
    power = FluidPower(solver)
    assert power.external(state) == pytest.approx(dissipation(solver, state), rel=1e-10)
    assert power.interface(state) == 0.0


@pytest.mark.parametrize("outlet", CONDITIONS)
def test_steady_flow_dissipates_what_it_is_given_less_what_it_takes_along(flows, outlet):
    solver = bent_channel(flows, outlet)
    state = flows.steady(solver)
    power = FluidPower(solver)
    carried = power.convected(state)
    assert abs(carried) > 1e-3 * dissipation(solver, state)
    # But for ∫ |u|² ∇·u, which the discretisation leaves.
    assert power.external(state) - carried == pytest.approx(dissipation(solver, state), rel=2e-4)


@pytest.mark.parametrize("outlet", CONDITIONS)
def test_skew_symmetric_convection_leaves_nothing(flows, outlet):
    solver = bent_channel(flows, outlet, convection_form="skew-symmetric")
    state = flows.steady(solver)
    power = FluidPower(solver)
    assert power.external(state) - power.convected(state) == pytest.approx(dissipation(solver, state), rel=1e-9)


def test_the_interface_counts_apart(flows):
    mesh = flows.grid(3)
    top = mesh.edge_nodes("top")
    conditions = [case.NoSlip(("left", "bottom")), case.DoNothing(("right",))]
    solver = flows.solver(mesh, conditions, interface=top, model="stokes")
    step = solver.begin_steady(solver.initial_state(), mesh.points)
    step.solve(np.tile([1.0, 0.0], (len(top), 1)))
    state, power = step.accept(), FluidPower(solver)
    assert power.interface(state) > 0.0
    assert power.interface(state) + power.external(state) == pytest.approx(dissipation(solver, state), rel=1e-10)
