"""Element matrices and residuals of one step."""

import numpy as np
import pytest

from hofsi import case
from hofsi.fem.element_matrices import batches
from hofsi.solvers.fluid_operator import FluidOperator


def operator(flows, order, rate, *, moving=True, **fluid):
    """Every term: curved elements, inertia, moving mesh, body force, open boundaries with back-flow, a traction."""
    mesh = flows.annulus(order, sectors=4, rings=2)
    conditions = (case.DoNothing(("outer",), backflow=0.6), flows.traction("inner", "x", "1 + t"))
    solver = flows.solver(mesh, conditions, density=1.3, viscosity=0.4, body_force=("x*y", "2 - t"), **fluid)
    rng = np.random.default_rng(11)
    w = rng.standard_normal(mesh.points.shape) if moving else np.zeros(mesh.points.shape)
    return solver, FluidOperator(solver, mesh.points, w, rate, rng.standard_normal(mesh.points.shape), 0.7), rng


def product(solver, make, unknowns):
    local = unknowns[solver.space.dofs]
    parts = [(make(batch) @ local[batch, :, None])[:, :, 0] for batch in batches(*local.shape)]
    return np.concatenate(parts)


@pytest.mark.parametrize("order", [2, 3, 5])
@pytest.mark.parametrize("rate", [0.0, 7.0])
@pytest.mark.parametrize("fluid", [{}, {"grad_div": 0.9}, {"convection_form": "skew-symmetric"}], ids=str)
def test_residual_is_load_minus_matrix_times_unknowns(flows, order, rate, fluid):
    solver, equations, rng = operator(flows, order, rate, **fluid)
    x = rng.standard_normal(solver.space.size)
    velocity = x[: 2 * solver.space.velocity_count].reshape(-1, 2)
    make = equations.matrices(velocity, newton=False)
    expected = equations.load - product(solver, make, x)
    found = equations.residual(x)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    whole = np.concatenate([make(batch) for batch in batches(len(found), found.shape[1])])
    np.testing.assert_allclose(make(slice(0, len(found))), whole, rtol=0.0, atol=1e-13 * np.abs(whole).max())


FORMS = pytest.mark.parametrize("form", ["convective", "skew-symmetric"])


@pytest.mark.parametrize("newton", [False, True])
@FORMS
def test_linearised_residual_belongs_to_the_matrix_about_the_expected_velocity(flows, newton, form):
    """With Newton's term it is the nonlinear residual where the velocity is the expected one, and linear."""
    solver, equations, rng = operator(flows, 3, 2.0, convection_form=form)
    n = 2 * solver.space.velocity_count
    x, y = rng.standard_normal((2, solver.space.size))
    expected = y[:n].reshape(-1, 2)
    make = equations.matrices(expected, newton=newton)
    change = equations.residual_about(x + y, expected, newton=newton) - equations.residual_about(
        y, expected, newton=newton
    )
    np.testing.assert_allclose(change, -product(solver, make, x), rtol=0.0, atol=1e-11)
    here = equations.residual_about(y, expected, newton=newton)
    np.testing.assert_allclose(here, equations.residual(y), rtol=0.0, atol=1e-11)


@FORMS
def test_with_newtons_term_the_matrix_is_the_derivative_of_the_residual(flows, form):
    """But for back-flow, whose traction is linearised as Picard does: here everything flows out."""
    mesh = flows.annulus(3, sectors=4, rings=2)
    conditions = (case.DoNothing(("outer",), backflow=0.6), case.NoSlip(("inner",)))
    solver = flows.solver(mesh, conditions, density=1.3, viscosity=0.4, convection_form=form)
    rng = np.random.default_rng(14)
    w, history = 0.1 * rng.standard_normal(mesh.points.shape), np.zeros(mesh.points.shape)
    equations = FluidOperator(solver, mesh.points, w, 2.0, history, 0.0)
    outwards = np.concatenate([3.0 * mesh.points.ravel(), np.zeros(solver.space.pressure_count)])
    x, d = outwards + 0.1 * rng.standard_normal((2, solver.space.size)) * [[1.0], [1.0]]
    d -= outwards
    # The residual is quadratic: r(x + d) - r(x - d) = -2 A d without remainder.
    difference = equations.residual(x + d) - equations.residual(x - d)
    make = equations.matrices(x[: 2 * solver.space.velocity_count].reshape(-1, 2), newton=True)
    np.testing.assert_allclose(difference, -2.0 * product(solver, make, d), rtol=0.0, atol=1e-10)


@FORMS
@pytest.mark.parametrize("share", [1.0, 0.4])
def test_the_quick_bound_of_rounding_is_one(flows, form, share):
    solver, equations, rng = operator(flows, 3, 2.0, convection_form=form)
    equations.share = share
    x = rng.standard_normal(solver.space.size)
    make = equations.matrices(x[: 2 * solver.space.velocity_count].reshape(-1, 2), newton=False)
    A = np.abs(make(slice(0, len(solver.space.dofs))))
    rows = (A @ np.abs(x)[solver.space.dofs][:, :, None])[:, :, 0]
    exact = np.linalg.norm(np.bincount(solver.space.dofs.ravel(), weights=rows.ravel()))
    assert equations.is_rounding(0.999 * exact, x, 1.0)
    assert not equations.is_rounding(1.001 * exact, x, 1.0)


def test_without_convection_the_matrix_is_the_constant_one(flows):
    solver, equations, rng = operator(flows, 3, 2.0)
    x = rng.standard_normal(solver.space.size)
    terms = solver.constant_terms(solver.mesh.points, 2.0)
    expected = equations.load - product(solver, terms.matrices, x)
    np.testing.assert_allclose(equations.residual_without_convection(x), expected, rtol=0.0, atol=1e-11)


def test_constant_terms_are_kept_when_they_are_asked_for_again(flows):
    solver, _, _ = operator(flows, 3, 2.0)
    points = solver.mesh.points
    terms = solver.constant_terms(points, 2.0)
    first = terms.ask().matrices(slice(0, 8))
    assert not np.shares_memory(terms.blocks(slice(0, 8))[0], terms.blocks(slice(0, 8))[0])
    again = solver.constant_terms(points, 2.0).ask()
    assert again is terms
    assert np.shares_memory(terms.blocks(slice(0, 8))[0], terms.blocks(slice(0, 8))[0])
    np.testing.assert_array_equal(again.matrices(slice(0, 8)), first)
    assert solver.constant_terms(points, 3.0) is not terms
    assert solver.counts.constant_assemblies == 2


@pytest.mark.parametrize("rate", [0.0, 5.0])
def test_row_sums_bound_those_of_the_matrix(flows, rate):
    solver, _, _ = operator(flows, 3, rate)
    terms, space = solver.constant_terms(solver.mesh.points, rate), solver.space
    A = np.abs(terms.matrices(slice(0, len(space.dofs))))
    rows = np.bincount(space.dofs.ravel(), weights=A.sum(axis=2).ravel())
    bound = solver.row_sums(solver.mesh.points, rate)[0]
    assert np.linalg.norm(rows) <= bound <= 20.0 * np.linalg.norm(rows)
