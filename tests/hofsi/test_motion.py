"""Boundary layers on a moving interface: kept heights, and an error where they do not fit any more."""

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.layout import layout
from hofsi.build import build
from hofsi.errors import MeshMotionError
from hofsi.motion import MeshPosition

NEXT_TO_LAYERS = """
[[mesh.count]]
on = [["b1", "b2"], ["b0", "b1"]]
elements = 3

[[mesh.grading]]
on = [["b1", "b2"], ["c1", "c2"], ["b1", "b0"], ["c1", "c0"]]
kind = "boundary-layer"
first_height = 0.05

[fluid]
density = 2.0"""


@pytest.fixture
def motion(read_changed):
    return build(read_changed(("\n[fluid]\ndensity = 2.0", NEXT_TO_LAYERS))).march._motion


def test_first_heights_at_a_moving_interface_are_kept(motion):
    reference, driven = motion.reference, motion.driven
    x = reference.mesh.points[driven.nodes]
    displacement = np.stack([0.2 * x[:, 1] ** 2, 0.1 * x[:, 1]], axis=-1)
    state = motion.move(reference, displacement, 0.1)
    topology = state.structure.topology
    plan = layout(state.structure, 2)
    for names in (("b1", "b2"), ("c1", "c2")):
        edge, forward = topology.edge(*map(topology.vertex, names))
        points = state.mesh.points[plan.nodes_of_edge(edge)[:: 1 if forward else -1]]
        assert np.hypot(*(points[2] - points[0])) == pytest.approx(0.05, rel=1e-13)
    np.testing.assert_array_equal(state.mesh.points[driven.nodes], x + displacement)
    back = motion.move(state, np.zeros_like(x), 0.2)
    np.testing.assert_allclose(back.mesh.points, reference.mesh.points, atol=1e-14)


def test_a_layer_that_does_not_fit_any_more_is_an_error_of_the_motion(motion):
    x = motion.reference.mesh.points[motion.driven.nodes]
    displacement = np.stack([0 * x[:, 0], 0.96 * x[:, 1]], axis=-1)
    with pytest.raises(MeshMotionError, match=r"edge b1–b2: boundary layer: the first height 0.05 does not fit"):
        motion.move(motion.reference, displacement, 0.3)


def test_a_state_comes_back_from_its_numbers(motion):
    x = motion.reference.mesh.points[motion.driven.nodes]
    state = motion.move(motion.reference, np.stack([0.2 * x[:, 1] ** 2, 0.1 * x[:, 1]], axis=-1), 0.1)
    again = motion.state_at(MeshPosition.of(state))
    np.testing.assert_array_equal(again.mesh.points, state.mesh.points)
    np.testing.assert_array_equal(generate(again.structure, 2).points, generate(state.structure, 2).points)
    one, other = (MeshPosition.of(it).__dict__ for it in (state, again))
    for name in ("min_det_J", "regenerated", "substeps", "amplification"):
        assert one[name] == other[name]
    back = [motion.move(it, np.zeros_like(x), 0.2).mesh.points for it in (state, again)]
    np.testing.assert_array_equal(*back)
