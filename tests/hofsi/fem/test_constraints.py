from __future__ import annotations

import numpy as np
import pytest

from hofsi.fem.constraints import DirectedNodes, NodeConstraints

SLANTED = np.array([0.6, 0.8])


def along(nodes, direction):
    return DirectedNodes(np.array(nodes), np.tile(direction, (len(nodes), 1)))


def free_change(constraints, rng):
    """A change of a field in its free directions only."""
    own = rng.standard_normal(constraints.fixed.shape)
    own[constraints.fixed] = 0.0
    return (constraints.frames @ own[:, :, None])[:, :, 0]


def test_component_fixes_one_component():
    constraints = NodeConstraints(4, [DirectedNodes.component(np.array([1, 2]), 1)])
    np.testing.assert_array_equal(constraints.fixed, [[0, 0], [0, 1], [0, 1], [0, 0]])
    assert constraints.rotated.size == 0
    field = np.arange(8.0).reshape(4, 2)
    imposed = constraints.impose(field, [np.array([-1.0, -2.0])])
    np.testing.assert_array_equal(imposed, [[0, 1], [2, -1], [4, -2], [6, 7]])
    np.testing.assert_array_equal(field, np.arange(8.0).reshape(4, 2))


def test_negative_axis_needs_no_frame_and_keeps_its_sign():
    constraints = NodeConstraints(1, [along([0], [-1.0, 0.0])])
    assert constraints.rotated.size == 0
    np.testing.assert_array_equal(constraints.impose(np.zeros((1, 2)), [np.array([3.0])]), [[-3.0, 0.0]])


def test_slanted_constraint_holds_for_every_free_change():
    rng = np.random.default_rng(31)
    constraints = NodeConstraints(3, [along([0, 2], SLANTED)])
    np.testing.assert_array_equal(constraints.rotated, [0, 2])
    frames = constraints.frames
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(2), (3, 1, 1)), atol=1e-15)
    field = constraints.impose(rng.standard_normal((3, 2)), [np.array([0.25, -4.0])])
    np.testing.assert_allclose((field + free_change(constraints, rng))[[0, 2]] @ SLANTED, [0.25, -4.0], rtol=1e-14)


def test_tangential_part_is_kept():
    constraints = NodeConstraints(1, [along([0], SLANTED)])
    field = np.array([[2.0, 5.0]])
    imposed = constraints.impose(field, [0.0])
    tangent = np.array([-0.8, 0.6])
    assert (imposed[0] @ tangent) == pytest.approx(field[0] @ tangent)


def test_two_directions_fix_a_node_and_both_hold():
    other = np.array([1.0, 0.0])
    constraints = NodeConstraints(2, [along([0, 1], SLANTED), along([1], other)])
    np.testing.assert_array_equal(constraints.fixed, [[True, False], [True, True]])
    np.testing.assert_array_equal(constraints.rotated, [0])
    field = constraints.impose(np.array([[1.0, 1.0], [7.0, -3.0]]), [np.array([0.5, 0.5]), np.array([2.0])])
    assert field[1] @ SLANTED == pytest.approx(0.5)
    assert field[1] @ other == pytest.approx(2.0)


def test_earlier_entries_win():
    entries = [DirectedNodes.component(np.array([0]), axis) for axis in (0, 1, 0)] + [along([0], SLANTED)]
    constraints = NodeConstraints(1, entries)
    values = [np.array([value]) for value in (1.0, 2.0, 3.0, 4.0)]
    np.testing.assert_array_equal(constraints.impose(np.zeros((1, 2)), values), [[1.0, 2.0]])


def test_parallel_directions_count_once():
    constraints = NodeConstraints(1, [along([0], SLANTED), along([0], -SLANTED)])
    np.testing.assert_array_equal(constraints.fixed, [[True, False]])
    field = constraints.impose(np.zeros((1, 2)), [np.array([1.0]), np.array([5.0])])
    assert field[0] @ SLANTED == pytest.approx(1.0)


def test_no_constraints_change_nothing():
    constraints = NodeConstraints(3, [])
    assert not constraints.fixed.any()
    field = np.arange(6.0).reshape(3, 2)
    np.testing.assert_array_equal(constraints.impose(field, []), field)


def test_values_of_another_number_of_entries_are_refused():
    constraints = NodeConstraints(1, [along([0], SLANTED)])
    with pytest.raises(ValueError, match="zip"):
        constraints.impose(np.zeros((1, 2)), [])
