"""Supports that leave a rigid motion free."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hoblock.expressions import compile_expression
from hofsi import case
from hofsi.errors import CaseError
from hofsi.solvers.solid import SolidSolver
from hofsi.solvers.solid_rest import free_motion

ZERO = compile_expression("0", ("x", "y", "t"))
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
SIDES = {"bottom": (0, 1), "right": (1, 2), "top": (2, 3), "left": (3, 0)}


def solver(conditions, turn=0.0, squares=1):
    c, s = np.cos(turn), np.sin(turn)
    corners = np.concatenate([SQUARE + np.array([3.0 * k, 0.0]) for k in range(squares)]) @ np.array([[c, s], [-s, c]])
    quads = [tuple(4 * k + i for i in range(4)) for k in range(squares)]
    edges = {f"{name}{k}": [(4 * k + i, 4 * k + j)] for k in range(squares) for name, (i, j) in SIDES.items()}
    mesh = generate(BlockStructure.build(corners, {"solid": quads}, edges=edges), 2)
    body = case.Solid("body", 1.0, 1.0, 0.3, ("solid",), tuple(conditions), model="linear")
    return SolidSolver(mesh, [body], case.NonlinearSettings())


@pytest.mark.parametrize(
    ("conditions", "turn", "motion"),
    [
        ([case.Roller(("left0",))], 0.0, r"move along \(-?0, -?1\)"),
        ([case.Roller(("left0", "right0"))], 0.0, r"move along \(-?0, -?1\)"),
        ([case.Roller(("bottom0",))], np.pi / 6, r"move along \(0.866, 0.5\)|move along \(-0.866, -0.5\)"),
        ([case.Displacement(("bottom0",), None, ZERO)], 0.0, r"move along \(-?1, -?0\)"),
        (
            [case.Displacement(("bottom0",), ZERO, None), case.Displacement(("left0",), None, ZERO)],
            0.0,
            r"turn about \(.*, .*\)",
        ),
    ],
)
def test_rigid_motion_that_is_left_free_is_named(conditions, turn, motion):
    with pytest.raises(CaseError, match=rf"solid\[0\].boundary: solid 'body' is not held: it can {motion}") as error:
        solver(conditions, turn).begin_static()
    assert error.value.place == "solid[0].boundary"


@pytest.mark.parametrize(
    "conditions",
    [
        [case.Displacement(("left0",), ZERO, ZERO)],
        [case.Roller(("left0", "bottom0"))],
        [case.Roller(("left0",)), case.Displacement(("right0",), None, ZERO)],
    ],
)
def test_sufficient_supports(conditions):
    solver(conditions, turn=0.3).begin_static()


def test_every_separate_part_needs_its_own():
    with pytest.raises(CaseError, match="it can move anywhere"):
        solver([case.Displacement(("left0",), ZERO, ZERO)], squares=2).begin_static()
    held = solver([case.Displacement(("left0", "top1"), ZERO, ZERO)], squares=2)
    held.begin_static()


def test_a_body_in_motion_may_be_free():
    free = solver([case.Roller(("left0",))])
    state = free.initial_state()
    free.begin_step(state, [0.1], 0.1)


def test_rollers_around_a_circle_let_it_turn():
    angle = np.linspace(0.0, 2.0, 9)
    n = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    turn = free_motion(np.array([2.0, -1.0]) + 0.01 * n, n)
    assert turn == "turn about (2, -1)"
    assert free_motion(np.array([2.0, -1.0]) + 0.01 * n, np.roll(n, 1, axis=1)) is None


def test_small_supports_of_large_bodies_hold():
    points = np.array([1e3, 1e3]) + np.array([[0.0, 0.0], [0.0, 0.0], [0.0, 1e-3], [0.0, 1e-3]])
    assert free_motion(points, np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [0.0, 1.0]])) is None
