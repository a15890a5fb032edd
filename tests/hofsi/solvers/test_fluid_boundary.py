"""Conditions resolved on a mesh: precedence, loads, and constraints that are kept while normals stay."""

from __future__ import annotations

import numpy as np
import pytest

from hofsi import case
from hofsi.fem.geometry import side_geometry


def imposed(solver, time=0.0, mesh_velocity=None, interface=None):
    points = solver.mesh.points
    nothing = np.full(points.shape, 7.0)
    mesh_velocity = np.zeros(points.shape) if mesh_velocity is None else mesh_velocity
    interface = np.zeros((0, 2)) if interface is None else interface
    return solver.boundary.impose(nothing, points, mesh_velocity, interface, time)


def test_the_interface_comes_before_walls_walls_before_velocities_velocities_before_slip(flows):
    mesh = flows.grid(2)
    at = mesh.edge_nodes
    left = at("left")
    conditions = [flows.velocity("right", "3 + t", 4), case.NoSlip(("bottom",)), case.Slip(("top",))]
    solver = flows.solver(mesh, conditions, interface=left)
    moving = np.broadcast_to([-1.0, -2.0], mesh.points.shape)
    u = imposed(solver, 0.5, moving, np.broadcast_to([5.0, 6.0], (len(left), 2)))
    np.testing.assert_array_equal(u[left], np.broadcast_to([5.0, 6.0], (len(left), 2)))
    bottom = np.setdiff1d(at("bottom"), left)
    np.testing.assert_array_equal(u[bottom], np.broadcast_to([-1.0, -2.0], (len(bottom), 2)))
    right = np.setdiff1d(at("right"), bottom)
    np.testing.assert_array_equal(u[right], np.broadcast_to([3.5, 4.0], (len(right), 2)))
    top = np.setdiff1d(at("top"), np.union1d(left, right))
    np.testing.assert_allclose(u[top], np.broadcast_to([7.0, -2.0], (len(top), 2)), rtol=0.0, atol=1e-14)
    inside = np.setdiff1d(np.arange(len(mesh.points)), np.concatenate([left, bottom, right, top]))
    np.testing.assert_array_equal(u[inside], 7.0)
    relative = np.full(mesh.points.shape, 9.0)
    solver.boundary.stick(relative, mesh.points, moving)
    np.testing.assert_array_equal(relative[np.union1d(left, bottom)], 0.0)
    np.testing.assert_array_equal(relative[np.setdiff1d(np.arange(len(relative)), np.union1d(left, bottom))], 9.0)


def test_a_wall_that_is_not_driven_does_not_follow_nodes_that_slide_along_it(flows):
    # A wall at an angle, a piston on its right side; an outlet that is driven too lets go of the wall's end.
    turn = 0.4
    mesh = flows.grid(3, turn=turn)
    along, across = flows.rotation(turn).T
    at = mesh.edge_nodes
    conditions = [case.NoSlip(("bottom", "right")), case.DoNothing(("left",)), case.Slip(("top",))]
    driven = np.union1d(at("left"), at("right"))
    solver = flows.solver(mesh, conditions, driven=driven)
    moving = np.broadcast_to(2.0 * along + 0.5 * across, mesh.points.shape)
    u = imposed(solver, 0.0, moving)
    bottom = np.setdiff1d(at("bottom"), at("right"))
    np.testing.assert_allclose(u[bottom], np.broadcast_to(0.5 * across, (len(bottom), 2)), rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(u[at("right")], moving[at("right")], rtol=0.0, atol=1e-14)
    relative = np.zeros(mesh.points.shape)
    solver.boundary.stick(relative, mesh.points, moving)
    np.testing.assert_allclose(relative[bottom], np.broadcast_to(-2.0 * along, (len(bottom), 2)), rtol=0.0, atol=1e-14)
    np.testing.assert_array_equal(relative[at("right")], 0.0)


def test_a_corner_between_walls_that_are_not_driven_moves_as_both_walls_do(flows):
    mesh = flows.grid(2)
    at = mesh.edge_nodes
    conditions = [case.NoSlip(("bottom", "right")), case.DoNothing(("left", "top"))]
    solver = flows.solver(mesh, conditions, driven=at("top"))
    moving = np.broadcast_to([2.0, 0.5], mesh.points.shape)
    u = imposed(solver, 0.0, moving)
    corner = np.intersect1d(at("bottom"), at("right"))
    np.testing.assert_array_equal(u[corner], [[2.0, 0.5]])
    right = np.setdiff1d(at("right"), corner)
    np.testing.assert_allclose(u[right], np.broadcast_to([2.0, 0.0], (len(right), 2)), rtol=0.0, atol=1e-14)


def test_velocities_are_evaluated_where_the_nodes_are_now(flows):
    mesh = flows.grid(2)
    solver = flows.solver(mesh, [flows.velocity("left", "x + 10*y", "t"), case.NoSlip(("right", "top", "bottom"))])
    moved = mesh.points + np.array([0.3, 0.0])
    zero = np.zeros(moved.shape)
    u = solver.boundary.impose(zero, moved, zero, np.zeros((0, 2)), 2.0)
    inner = np.setdiff1d(mesh.edge_nodes("left"), solver.boundary.walls)
    np.testing.assert_allclose(u[inner, 0], 0.3 + 10.0 * moved[inner, 1], rtol=0.0, atol=1e-14)
    np.testing.assert_array_equal(u[inner, 1], 2.0)


def test_a_component_left_out_stays_free(flows):
    mesh = flows.grid(2)
    conditions = [flows.velocity("right", None, 1), case.NoSlip(("left",)), case.DoNothing(("top", "bottom"))]
    solver = flows.solver(mesh, conditions)
    right = mesh.edge_nodes("right")
    np.testing.assert_array_equal(imposed(solver)[right], np.broadcast_to([7.0, 1.0], (len(right), 2)))
    fixed = solver.boundary.constraints(mesh.points).fixed
    np.testing.assert_array_equal(fixed[right], np.broadcast_to([False, True], (len(right), 2)))


def test_slip_meets_a_component_that_is_given(flows):
    # Top: u·n = 0; right: u_x = 1, u_y free. Their common corner has both.
    mesh = flows.grid(2)
    conditions = [flows.velocity("right", 1, None), case.Slip(("top",)), case.NoSlip(("left", "bottom"))]
    solver = flows.solver(mesh, conditions)
    corner = np.intersect1d(mesh.edge_nodes("right"), mesh.edge_nodes("top"))
    np.testing.assert_allclose(imposed(solver)[corner], [[1.0, 0.0]], rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_constraints_are_kept_while_the_normals_of_slip_edges_stay(flows, turn):
    mesh = flows.grid(3, turn=turn)
    solver = flows.solver(mesh, [case.Slip(("top", "bottom")), case.NoSlip(("left",)), case.DoNothing(("right",))])
    boundary = solver.boundary
    first = boundary.constraints(mesh.points)
    inside = np.setdiff1d(np.arange(len(mesh.points)), np.concatenate([mesh.edge_nodes(name) for name in flows.around]))
    moved = mesh.points.copy()
    moved[inside] += [0.01, 0.02]
    assert boundary.constraints(moved) is first
    along = flows.rotation(turn)[:, 0]
    assert boundary.constraints(mesh.points + 0.2 * along) is first
    top = mesh.edge_nodes("top")
    bent = mesh.points.copy()
    bent[top] += 0.02 * np.sin(3.0 * mesh.points[top, :1]) * flows.rotation(turn)[:, 1]
    second = boundary.constraints(bent)
    assert second is not first
    assert boundary.constraints(bent.copy()) is second
    assert boundary.constraints(mesh.points) is not second


def test_constraints_without_slip_never_change(flows):
    mesh = flows.grid(2)
    boundary = flows.solver(mesh, [case.NoSlip(flows.around)]).boundary
    assert boundary.constraints(mesh.points) is boundary.constraints(2.0 * mesh.points)


def test_loads_add_up_to_the_traction_on_curved_edges(flows):
    mesh = flows.annulus(4, count=2)
    conditions = [flows.traction("outer", "x", "2 + t"), flows.pressure("inner", "3*x")]
    solver = flows.solver(mesh, conditions)
    f = np.zeros(solver.space.dofs.shape)
    solver.boundary.add_loads(f, mesh.points, 0.5)
    total = np.zeros(solver.space.size)
    np.add.at(total, solver.space.dofs, f)
    load = total[: 2 * len(mesh.points)].reshape(-1, 2)
    outer, inner = mesh.edge_nodes("outer"), mesh.edge_nodes("inner")
    np.testing.assert_allclose(load[outer].sum(axis=0), [0.0, 2.5 * 2.0 * np.pi], rtol=0.0, atol=1e-5)
    # ∮ -p n over the inner circle, n into the hole: by Gauss ∫ ∇p over the disc.
    np.testing.assert_allclose(load[inner].sum(axis=0), [3.0 * np.pi * 0.25, 0.0], rtol=0.0, atol=1e-5)
    others = np.setdiff1d(np.arange(len(mesh.points)), np.union1d(outer, inner))
    assert np.abs(load[others]).max() < 1e-14
    assert not total[2 * len(mesh.points) :].any()


def test_only_given_tractions_are_loads(flows):
    mesh = flows.grid(2)
    conditions = [flows.velocity("right", 1, None, traction_y=4), case.NoSlip(("left", "top", "bottom"))]
    solver = flows.solver(mesh, conditions)
    space = solver.space
    (side,) = side_geometry(mesh.points[space.velocity_cells], mesh.edge_groups["right"], space.velocity_sides)
    given = solver.boundary.traction(solver.fluid.boundaries[0], side, 0.0)
    np.testing.assert_allclose(given.sum(axis=(0, 1)), [0.0, 4.0], rtol=0.0, atol=1e-13)
    assert not solver.boundary.traction(solver.fluid.boundaries[1], side, 0.0).any()


def test_do_nothing_term_is_the_transposed_gradient(flows):
    # For u = G x the term is -μ ∫ v·Gᵀn over the open edges.
    mesh = flows.annulus(3)
    G = np.array([[0.3, -0.8], [1.1, 0.7]])
    solver = flows.solver(mesh, [case.DoNothing(("outer", "inner"))], viscosity=0.4)
    space = solver.space
    u = mesh.points @ G.T
    result = np.zeros(u.shape)
    for term in solver.boundary.do_nothing(mesh.points):
        cells = space.velocity_cells[term.elements]
        np.add.at(result[:, term.row], cells, (term.block @ u[cells][:, :, [term.column]])[:, :, 0])
    expected = np.zeros(mesh.points.shape)
    sides = np.concatenate([mesh.edge_groups["outer"], mesh.edge_groups["inner"]])
    for side in side_geometry(mesh.points[space.velocity_cells], sides, space.velocity_sides):
        np.add.at(expected, space.velocity_cells[side.elements], -0.4 * (side.table.N.T @ (side.normals @ G)))
    np.testing.assert_allclose(result, expected, rtol=0.0, atol=1e-13)
    assert np.abs(expected).max() > 1e-3
    r = np.zeros(space.dofs.shape)
    solver.boundary.subtract_do_nothing(r, mesh.points, u)
    subtracted = np.zeros(space.size)
    np.add.at(subtracted, space.dofs, r)
    np.testing.assert_allclose(subtracted[: u.size].reshape(-1, 2), -expected, rtol=0.0, atol=1e-13)
