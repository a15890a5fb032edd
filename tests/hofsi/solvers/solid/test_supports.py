from __future__ import annotations

import numpy as np
import pytest

from hoblock import Arc, BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.solvers.solid_supports import SolidSupports

ANGLE = 0.4
TURN = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])


def turned_square(order=2):
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]) @ TURN.T
    edges = {"bottom": [(0, 1)], "right": [(1, 2)], "top": [(2, 3)], "left": [(3, 0)]}
    return generate(BlockStructure.build(corners, {"solid": [(0, 1, 2, 3)]}, counts=2, edges=edges), order)


def quarter_ring(order=3, count=2):
    vertices = {"a": (1.0, 0.0), "b": (2.0, 0.0), "c": (0.0, 2.0), "d": (0.0, 1.0)}
    curves = {
        ("b", "c"): Arc.from_center((0.0, 0.0), (2.0, 0.0), (0.0, 2.0)),
        ("a", "d"): Arc.from_center((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)),
    }
    edges = {"bottom": [("a", "b")], "outer": [("b", "c")], "left": [("c", "d")], "inner": [("d", "a")]}
    blocks = {"solid": [("a", "b", "c", "d")]}
    return generate(BlockStructure.build(vertices, blocks, counts=count, curves=curves, edges=edges), order)


def expression(text):
    return compile_expression(text, ("x", "y", "t"))


def supports(mesh, *conditions):
    solid = case.Solid("block", 1.0, 1.0, 0.3, ("solid",), tuple(conditions))
    return SolidSupports(mesh, [solid], [np.arange(len(mesh.cells))])


def test_given_displacements_are_expressions_of_reference_position_and_time():
    mesh = turned_square()
    held = supports(
        mesh,
        case.Displacement(("left",), expression("x + 10*t"), None),
        case.Displacement(("top",), None, expression("y - t")),
    )
    d = held.impose(np.full(mesh.points.shape, 7.0), 2.0)
    left, top = mesh.edge_nodes("left"), mesh.edge_nodes("top")
    np.testing.assert_allclose(d[left, 0], mesh.points[left, 0] + 20.0)
    np.testing.assert_allclose(d[top, 1], mesh.points[top, 1] - 2.0)
    assert (d[np.setdiff1d(np.arange(len(d)), left), 0] == 7.0).all()


def test_roller_holds_the_normal_component_only():
    mesh = turned_square()
    held = supports(mesh, case.Roller(("bottom",)))
    d = held.impose(np.tile([1.0, 2.0], (len(mesh.points), 1)), 0.0)
    bottom = mesh.edge_nodes("bottom")
    own = d @ TURN
    np.testing.assert_allclose(own[bottom, 1], 0.0, atol=1e-14)
    np.testing.assert_allclose(own[bottom, 0], (np.array([1.0, 2.0]) @ TURN)[0])


@pytest.mark.parametrize("together", [True, False])
def test_rollers_that_meet_hold_their_corner(together):
    mesh = turned_square()
    conditions = [case.Roller(("bottom", "left"))] if together else [case.Roller(("bottom",)), case.Roller(("left",))]
    held = supports(mesh, *conditions)
    corner = np.argmin(np.hypot(*mesh.points.T))
    assert held.constraints.fixed[corner].all()
    assert held.constraints.fixed.sum() == len(mesh.edge_nodes("bottom")) + len(mesh.edge_nodes("left"))
    np.testing.assert_allclose(held.impose(np.ones(mesh.points.shape), 0.0)[corner], 0.0, atol=1e-15)


def test_roller_on_an_arc_follows_it():
    mesh = quarter_ring(order=6)
    held = supports(mesh, case.Roller(("outer",)))
    outer = mesh.edge_nodes("outer")
    assert held.constraints.fixed[outer].sum() == len(outer)
    d = held.impose(np.tile([3.0, -1.0], (len(mesh.points), 1)), 0.0)[outer]
    np.testing.assert_allclose(np.sum(d * mesh.points[outer], axis=1) / 2.0, 0.0, atol=1e-5)
    assert (np.hypot(*d.T) > 0.1).all()


def test_displacement_comes_before_roller_wherever_it_stands():
    mesh = turned_square()
    zero = expression("0")
    held = supports(mesh, case.Roller(("bottom",)), case.Displacement(("left",), expression("5"), zero))
    corner = np.argmin(np.hypot(*mesh.points.T))
    np.testing.assert_array_equal(held.impose(np.zeros(mesh.points.shape), 0.0)[corner], [5.0, 0.0])


def test_force_is_split_into_what_supports_take_and_what_is_free():
    mesh = turned_square()
    held = supports(mesh, case.Roller(("bottom",)), case.Displacement(("right",), expression("0"), None))
    force = np.random.default_rng(61).standard_normal(mesh.points.shape)
    reaction = held.held_part(force)
    free = held.free_part(force)
    np.testing.assert_allclose(np.sum(reaction**2) + np.sum(free**2), np.sum(force**2), rtol=1e-13)
    bottom = np.setdiff1d(mesh.edge_nodes("bottom"), mesh.edge_nodes("right"))
    np.testing.assert_allclose((reaction @ TURN)[bottom, 0], 0.0, atol=1e-14)  # no friction
    np.testing.assert_allclose((reaction @ TURN)[bottom, 1], (force @ TURN)[bottom, 1])
    np.testing.assert_allclose(held.free_part(reaction), 0.0, atol=1e-14)
    inside = np.setdiff1d(np.arange(len(force)), np.union1d(mesh.edge_nodes("bottom"), mesh.edge_nodes("right")))
    assert np.abs(reaction[inside]).max() == 0.0
