"""Open boundaries through which fluid comes in."""

import numpy as np
import pytest

from hofsi import case
from hofsi.solvers.backflow import Backflow


def pipe(flows, backflow, convection="linearised", order=3, p=0.5, density=1.0):
    """Slip walls, a pressure on the left, nothing on the right: the flow is a plug."""
    mesh = flows.grid(order, 3, 2, size=(3.0, 1.0))
    conditions = (
        case.Pressure(("left",), flows.expression(str(p)), backflow=backflow),
        case.Slip(("top", "bottom")),
        case.DoNothing(("right",)),
    )
    return flows.solver(mesh, conditions, viscosity=0.01, density=density, convection=convection)


@pytest.mark.parametrize("convection", ["linearised", "extrapolated", "newton", "picard"])
def test_the_loss_of_inflow_is_bernoullis(flows, convection):
    """ρ L u' = p - ρ u²/2 from rest: u = U tanh(U t/(2 L)), U = √(2 p/ρ)."""
    ends = []
    for count in (10, 20):
        solver = pipe(flows, 1.0, convection, p=2.0, density=4.0)
        linear = convection in ("linearised", "extrapolated")
        state = flows.march(solver, solver.initial_state(), (3.0 / count,) * count, linear=linear)
        assert np.ptp(state.velocity[:, 0]) < 1e-9
        assert np.abs(state.velocity[:, 1]).max() < 1e-9
        assert solver.counts.backflows > 0
        ends.append(abs(state.velocity[0, 0] - np.tanh(0.5)))
    assert ends[1] < 2e-3
    assert ends[0] / ends[1] > 3.0


def test_without_it_nothing_limits_the_inflow(flows):
    solver = pipe(flows, 0.0, p=2.0, density=4.0)
    state = flows.march(solver, solver.initial_state(), (0.3,) * 10, linear=True)
    np.testing.assert_allclose(state.velocity[:, 0], 0.5, atol=1e-9)  # p t/(ρ L)
    assert solver.counts.backflows == 0


def test_outflow_does_not_notice(flows):
    ends = []
    for backflow in (0.0, 1.0):
        conditions = (
            flows.velocity("left", "4*y*(1 - y)", 0),
            case.NoSlip(("top", "bottom")),
            case.DoNothing(("right",), backflow=backflow),
        )
        solver = flows.solver(flows.grid(3, 3, 2, size=(3.0, 1.0)), conditions, viscosity=0.02)
        ends.append(flows.steady(solver))
        assert solver.counts.backflows == 0
    np.testing.assert_array_equal(ends[0].velocity, ends[1].velocity)


def test_its_power_is_the_energy_that_comes_in(flows):
    mesh = flows.grid(4, 2, 2)
    solver = flows.solver(mesh, (case.DoNothing(("left", "right", "top", "bottom"), backflow=0.7),), density=3.0)
    stabilisation = Backflow(mesh, solver.space, solver.fluid.boundaries, 3.0)
    a = np.tile([2.0, 0.0], (len(mesh.points), 1))  # in on the left only
    u = flows.field(mesh.points, "1 + y", "y**2")
    product = np.zeros((*solver.space.velocity_cells.shape, 2))
    local = u[solver.space.velocity_cells]
    for term in stabilisation.terms(mesh.points, a):
        part = (term.block @ local[term.elements][:, :, [term.column]])[:, :, 0]
        np.add.at(product[..., term.row], term.elements, part)
    power = float((local * product).sum())
    exact = 0.7 * 1.5 * 2.0 * (7.0 / 3.0 + 1.0 / 5.0)  # β ρ/2 |a| ∫ (1 + y)² + y⁴ dy
    assert power == pytest.approx(exact, rel=1e-12)
    f = np.zeros(solver.space.dofs.shape)
    stabilisation.subtract(f, mesh.points, a, u)
    np.testing.assert_allclose(f, -solver.space.local_vector(product), atol=1e-12)
    assert stabilisation.terms(mesh.points, np.zeros_like(a)) == []
