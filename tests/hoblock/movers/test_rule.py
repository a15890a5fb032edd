"""Vertices that follow a user's rule."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.errors import MoverError
from hoblock.movers import PseudoSolid, Rule


def shares(structure, free):
    """1 at the plate's height, falling to 0 at the top and the bottom of the box."""
    return 1.0 - np.abs(structure.vertices[free, 1:])


def test_a_rule_places_the_free_vertices(plate_in_box):
    structure, driven = plate_in_box.structure, plate_in_box.driven
    free = PseudoSolid(structure, driven).free
    mover = Rule(structure, driven, lambda d: shares(structure, free) * d.mean(axis=0))
    np.testing.assert_array_equal(mover.free, free)
    start = structure.vertices
    moved = mover.move(np.full_like(start, np.nan), start[driven] + [0.0, 0.3])
    np.testing.assert_allclose(moved[free], start[free] + shares(structure, free) * [0.0, 0.3], atol=1e-15)
    np.testing.assert_allclose(moved[driven], start[driven] + [0.0, 0.3])
    outer = np.setdiff1d(structure.topology.boundary_vertices, driven)
    np.testing.assert_array_equal(moved[outer], start[outer])
    assert not mover.depends_on_state


def test_a_rule_carries_a_plate_to_the_wall(rig, plate_in_box):
    structure, driven = plate_in_box.structure, plate_in_box.driven
    free = PseudoSolid(structure, driven).free
    mover = Rule(structure, driven, lambda d: shares(structure, free) * d.mean(axis=0))
    assert rig(plate_in_box, mover, "translation").reach(0.99) > 0.9


@pytest.mark.parametrize(
    ("function", "match"),
    [
        (
            lambda d: d,
            r"rule: the function returned shape \(10, 2\); expected \(18, 2\), one displacement for each free",
        ),
        (lambda d: np.full((18, 2), np.inf), r"rule: the function moves vertex '.*' by \[inf, inf\]; expected finite"),
    ],
)
def test_rules_that_return_something_else(plate_in_box, function, match):
    structure, driven = plate_in_box.structure, plate_in_box.driven
    with pytest.raises(MoverError, match=match):
        Rule(structure, driven, function).move(structure.vertices, structure.vertices[driven])
