import numpy as np

from hofsi import case
from hofsi.solvers.fluid_integrals import divergence


def test_the_divergence_falls(flows):
    mesh = flows.grid(2, 6, 6)
    conditions = (flows.velocity("top", "16*x**2*(1 - x)**2", 0), case.NoSlip(("left", "right", "bottom")))
    left = []
    for grad_div in (0.0, 0.1, 1.0):
        solver = flows.solver(mesh, conditions, viscosity=0.01, grad_div=grad_div)
        left.append(divergence(solver, flows.steady(solver)))
    assert left[1] < 0.8 * left[0]
    assert left[2] < 0.5 * left[0]


def test_flows_without_divergence_do_not_notice(flows):
    conditions = (flows.velocity("left", "4*y*(1 - y)", 0), case.NoSlip(("top", "bottom")), case.DoNothing(("right",)))
    solver = flows.solver(flows.grid(3, 4, 2, size=(2.0, 1.0)), conditions, viscosity=0.05, grad_div=1.0)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, flows.field(state.points[0], "4*y*(1 - y)", 0), atol=1e-11)
    assert flows.pressure_error(solver, state, "8*0.05*(2 - x)") < 1e-10
