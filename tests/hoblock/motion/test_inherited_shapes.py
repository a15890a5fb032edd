"""Edges that take on the shape of the driven edge they face."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.errors import InvalidMeshError, MoverError
from hoblock.generate import generate
from hoblock.motion import MeshMotion, driven_edges
from hoblock.motion.inherited_shapes import inherited_shapes
from hoblock.movers import BarrierEnergy

ONE_BLOCK = np.array([-1.0, -0.5, 0.5, 1.0])


def test_the_strip_of_a_side_inherits_less_the_further_it_is(make_plate):
    plate = make_plate(x=ONE_BLOCK)
    driven = driven_edges(plate.structure, 4, plate.edges)
    positions = generate(plate.structure, 4).points[driven.nodes]
    shapes = inherited_shapes(plate.structure, driven, positions, "auto")
    at = plate.structure.vertices[plate.structure.topology.edges[list(shapes.edges)]].mean(axis=1)
    share = dict(zip(map(tuple, np.round(at, 6).tolist()), shapes.shares.tolist(), strict=True))
    # Above and below the plate one line of blocks ends before the box, at 0.39 of 0.99.
    assert share[0.0, 0.4] == pytest.approx(1.0 - 0.39 / 0.99)
    assert share[0.0, -0.4] == pytest.approx(1.0 - 0.39 / 0.99)
    assert (0.0, 1.0) not in share  # the box does not move


def test_sides_of_many_blocks_inherit_nothing_by_themselves(plate):
    driven = driven_edges(plate.structure, 4, plate.edges)
    positions = generate(plate.structure, 4).points[driven.nodes]
    sides = {
        which: inherited_shapes(plate.structure, driven, positions, which).edges for which in ("auto", "all", "none")
    }
    assert sides["none"] == ()
    assert len(sides["all"]) > len(sides["auto"])
    middles = plate.structure.vertices[plate.structure.topology.edges[list(sides["auto"])]].mean(axis=1)
    assert (np.abs(middles[:, 1]) < 0.02).all()  # beside the short ends of the plate only


def reach(plate, bend, inherit):
    motion = MeshMotion(
        plate.structure, 4, plate.edges, BarrierEnergy(plate.structure, plate.driven), inherit=inherit, halvings=0
    )
    state, last = motion.reference, 0.0
    for degrees in np.arange(4.0, 271.0, 4.0):
        try:
            state = motion.move(state, bend(motion.reference.positions, degrees))
        except (InvalidMeshError, MoverError):
            break
        last = degrees
    return last


def test_a_plate_of_one_block_bends_further_with_inherited_shapes(make_plate, bend):
    # The line of blocks beside the plate is thinner than the plate's deflection.
    plate = make_plate(counts=4, x=ONE_BLOCK, y=np.array([-1.0, -0.08, -0.01, 0.01, 0.08, 1.0]))
    assert reach(plate, bend, "auto") > 1.5 * reach(plate, bend, "none")


def test_meshes_with_inherited_shapes_are_those_of_their_structure(make_plate, bend):
    plate = make_plate(counts=3, x=ONE_BLOCK)
    motion = MeshMotion(plate.structure, 5, plate.edges, BarrierEnergy(plate.structure, plate.driven))
    state = motion.move(motion.reference, bend(motion.reference.positions, 40.0))
    np.testing.assert_allclose(state.mesh.points, generate(state.structure, 5).points, atol=1e-14)
    back = motion.move(state, motion.reference.positions)
    np.testing.assert_allclose(back.mesh.points, motion.reference.mesh.points, atol=1e-13)
