"""From driven nodes to a certified mesh: what moves, what does not, what is reported, what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import InvalidMeshError, MoverError
from hoblock.generate import generate, regenerate
from hoblock.grading import BoundaryLayer, Exponential
from hoblock.motion import MeshMotion, boundary_crossing, driven_edges
from hoblock.motion import mesh_motion as module
from hoblock.movers import AngleOptimisation, BarrierEnergy, PseudoSolid
from hoblock.quality import certify, det_jacobian_bounds


def up(distance):
    return np.array([0.0, distance])


MOVERS = {
    "barrier": lambda plate: BarrierEnergy(plate.structure, plate.driven, edges=plate.edges),
    "pseudo-solid": lambda plate: PseudoSolid(plate.structure, plate.driven),
    "angles": lambda plate: AngleOptimisation(plate.structure, plate.driven),
}


@pytest.mark.parametrize("name", MOVERS)
@pytest.mark.parametrize("order", [1, 2, 4, 6])
def test_the_mesh_is_that_of_the_moved_structure(plate, bend, name, order):
    motion = MeshMotion(plate.structure, order, plate.edges, MOVERS[name](plate))
    state = motion.move(motion.reference, bend(motion.reference.positions, 40.0))
    again = generate(state.structure, order)
    np.testing.assert_allclose(state.mesh.points, again.points, atol=1e-14)
    np.testing.assert_array_equal(state.mesh.points[motion.driven.nodes], state.positions)
    bound = float(det_jacobian_bounds(again)[0].min())
    assert state.min_det_J == pytest.approx(bound, rel=1e-9)
    assert state.mesh.cells is motion.reference.mesh.cells


def test_a_state_that_was_kept_without_its_structure_gets_it_again(plate, bend):
    motion = MeshMotion(plate.structure, 3, plate.edges, MOVERS["barrier"](plate))
    state = motion.move(motion.reference, bend(motion.reference.positions, 40.0))
    bare = replace(state, structure_of=None)
    with pytest.raises(ValueError, match="made without a block structure"):
        _ = bare.structure
    again = motion.with_structure(bare)
    np.testing.assert_array_equal(generate(again.structure, 3).points, generate(state.structure, 3).points)


@pytest.mark.parametrize("gradings", [False, True])
def test_both_ways_to_make_the_nodes_agree(make_plate, bend, gradings, monkeypatch):
    graded = {("2,3", "2,4"): Exponential(1.5), ("3,3", "3,4"): Exponential(0.5), ("2,4", "3,4"): Exponential(-1.0)}
    plate = make_plate(counts=3, gradings=graded if gradings else {})
    mover = MOVERS["barrier"](plate)
    blended = MeshMotion(plate.structure, 4, plate.edges, mover)
    monkeypatch.setattr(module, "_BLENDED_NODES", 0)
    generated = MeshMotion(plate.structure, 4, plate.edges, mover)
    assert blended._blending is not None
    assert generated._blending is None
    positions = bend(blended.reference.positions, 60.0)
    first, second = (motion.move(motion.reference, positions) for motion in (blended, generated))
    np.testing.assert_allclose(first.mesh.points, second.mesh.points, atol=1e-14)
    assert first.min_det_J == pytest.approx(second.min_det_J, rel=1e-9)


def test_nodes_that_cannot_move_are_not_touched(plate, bend):
    motion = MeshMotion(plate.structure, 2, plate.edges, MOVERS["pseudo-solid"](plate))
    state = motion.move(motion.reference, bend(motion.reference.positions, 20.0))
    still = np.setdiff1d(np.arange(len(state.mesh.points)), motion.moving_nodes)
    assert len(still) > 0
    np.testing.assert_array_equal(state.mesh.points[still], motion.reference.mesh.points[still])
    changed = (state.mesh.points != motion.reference.mesh.points).any(axis=1)
    assert changed[motion.moving_nodes].mean() > 0.95


def test_counts_of_two_bodies_of_which_one_moves():
    """Two separate boxes in one structure: the second is counted as still, and certified once."""
    x = np.arange(4.0)
    grid = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
    k = np.arange(16).reshape(4, 4)
    quads = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    vertices = np.concatenate([grid, grid + np.array([10.0, 0.0])])
    structure = BlockStructure.build(vertices, [*quads.tolist(), *(quads + 16).tolist()], counts=2)
    edge = structure.topology.find_edge(1, 2)
    mover = BarrierEnergy(structure, np.array([1, 2]))
    motion = MeshMotion(structure, 3, [edge], mover)
    assert motion.moving_blocks.tolist() == list(range(9))
    assert motion.moving_vertices.tolist() == [1, 2, 5, 6, 9, 10]
    assert motion.moving_nodes.max() < len(motion.reference.mesh.points)
    x = motion.reference.positions
    state = motion.move(motion.reference, x + np.stack([0 * x[:, 0], 0.3 * np.sin(np.pi * (x[:, 0] - 1.0))], axis=-1))
    assert state.regenerated == 9
    right = motion.reference.mesh.points[:, 0] > 5.0
    assert not np.isin(np.flatnonzero(right), motion.moving_nodes).any()
    np.testing.assert_array_equal(state.mesh.points[right], motion.reference.mesh.points[right])


def test_a_smoothing_mover_starts_elsewhere(make_plate):
    plate = make_plate(y=np.array([-1.0, -0.4, -0.01, 0.01, 0.2, 1.0]))
    shifted = plate.structure.vertices.copy()
    shifted[plate.structure.topology.vertex("3,4")] += [0.05, 0.1]
    plate = type(plate)(plate.structure.moved(shifted), plate.edges)
    mover = BarrierEnergy(plate.structure, plate.driven, energy="ang")
    motion = MeshMotion(plate.structure, 2, plate.edges, mover)
    start = motion.start()
    assert np.abs(start.vertices - motion.reference.vertices).max() > 0.01
    np.testing.assert_array_equal(start.positions, motion.reference.positions)
    np.testing.assert_allclose(motion.move(start, start.positions).mesh.points, start.mesh.points, atol=1e-12)
    bar = MeshMotion(plate.structure, 2, plate.edges, BarrierEnergy(plate.structure, plate.driven))
    np.testing.assert_allclose(bar.start().mesh.points, bar.reference.mesh.points, atol=1e-13)


def test_boundary_layers_keep_their_first_height(make_plate, bend):
    walls = [(f"{i},3", f"{i},4") for i in range(2, 7)] + [(f"{i},2", f"{i},1") for i in range(2, 7)]
    plate = make_plate(counts=4, gradings={pair: BoundaryLayer(0.01) for pair in walls})
    motion = MeshMotion(plate.structure, 4, plate.edges, MOVERS["barrier"](plate))
    assert motion._blending is None
    state = motion.move(motion.reference, bend(motion.reference.positions, 50.0))
    topology = plate.structure.topology
    for pair in walls:
        edge, forward = topology.edge(*map(topology.vertex, pair))
        nodes = state.mesh.points[motion._plan.nodes_of_edge(edge)]
        nodes = nodes if forward else nodes[::-1]
        assert np.hypot(*(nodes[4] - nodes[0])) == pytest.approx(0.01, rel=1e-12)


def test_an_inner_arc_between_moving_vertices_is_generated(make_plate, bend):
    arc = Arc.through((-0.5, 0.4), (-0.375, 0.43), (-0.25, 0.4))
    plate = make_plate(curves={("2,4", "3,4"): arc})
    motion = MeshMotion(plate.structure, 3, plate.edges, MOVERS["pseudo-solid"](plate))
    assert motion._blending is None  # it may be cut anew from its circle
    state = motion.move(motion.reference, bend(motion.reference.positions, 30.0))
    np.testing.assert_allclose(state.mesh.points, generate(state.structure, 3).points, atol=1e-14)


def test_a_motion_that_fails_is_made_in_parts(plate):
    mover = AngleOptimisation(plate.structure, plate.driven)
    whole = MeshMotion(plate.structure, 2, plate.edges, mover, halvings=0)
    parts = MeshMotion(plate.structure, 2, plate.edges, mover, halvings=5)
    c, s = np.cos(np.radians(55.0)), np.sin(np.radians(55.0))
    positions = whole.reference.positions @ np.array([[c, s], [-s, c]])
    with pytest.raises(InvalidMeshError):
        whole.move(whole.reference, positions)
    state = parts.move(parts.reference, positions)
    assert state.substeps in (2, 4, 8, 16, 32)
    assert state.regenerated == state.substeps * len(parts.moving_blocks)
    assert certify(state.mesh).valid
    np.testing.assert_array_equal(state.positions, positions)


def test_the_amplification_tells_smooth_motions_from_jumps(plate, bend):
    motion = MeshMotion(plate.structure, 2, plate.edges, MOVERS["barrier"](plate))
    x = motion.reference.positions
    state = motion.move(motion.reference, bend(x, 10.0))
    assert 0.2 < state.amplification < 3.0
    assert not state.snapped
    still = motion.move(state, state.positions)
    assert still.amplification == 0.0
    far = motion.move(motion.reference, x + up(0.6))
    jump = motion.move(far, far.positions + up(1e-3))
    assert not jump.snapped
    # From a state with another position of the free vertices the same small step looks like a jump, as it should.
    other = module.replace(far, vertices=motion.reference.vertices)
    assert motion.move(other, far.positions + up(1e-3)).snapped


def test_the_last_state_survives_and_the_error_names_what_crosses(plate):
    motion = MeshMotion(plate.structure, 3, plate.edges, MOVERS["barrier"](plate), halvings=1)
    before = motion.move(motion.reference, motion.reference.positions + up(0.3))
    points, bound = before.mesh.points.copy(), before.min_det_J
    through = motion.reference.positions + up(1.4)
    through[:, 1] += 0.2 * np.cos(3.0 * through[:, 0])
    tilted = (motion.reference.positions @ np.array([[0.3, 0.95], [-0.95, 0.3]])) + up(0.8)
    with pytest.raises(
        MoverError, match=r"The boundary edges .* and .* cross near \(.*\). No mesh fits such a boundary"
    ):
        motion.move(before, tilted)
    with pytest.raises(MoverError, match="found no valid place"):
        motion.move(before, through)
    np.testing.assert_array_equal(before.mesh.points, points)
    assert before.min_det_J == bound
    after = motion.move(before, motion.reference.positions + up(0.32))
    assert certify(after.mesh).valid


def test_an_edge_that_crosses_itself_is_named(plate):
    motion = MeshMotion(plate.structure, 6, plate.edges, MOVERS["pseudo-solid"](plate), halvings=0)
    positions = motion.reference.positions.copy()
    rows = motion.driven.rows[0]
    t = np.linspace(0.0, 1.0, len(rows))[:, None]
    first, last = positions[rows[[0, -1]]]
    angle = 2.0 * np.pi * t[:, 0]
    loop = 0.3 * np.stack([np.sin(2 * angle), 1.0 - np.cos(angle)], axis=-1)
    positions[rows] = (1 - t) * first + t * last + loop
    with pytest.raises(InvalidMeshError, match=r"cross"):
        motion.move(motion.reference, positions)


def test_a_node_that_is_not_finite_is_named(plate):
    motion = MeshMotion(plate.structure, 2, plate.edges, MOVERS["barrier"](plate))
    positions = motion.reference.positions.copy()
    positions[5, 1] = np.nan
    with pytest.raises(
        MoverError, match=r"positions\[5\], the node of the driven edge .* was at .*nan.*expected finite"
    ):
        motion.move(motion.reference, positions)
    with pytest.raises(MoverError, match=r"positions have shape \(3, 2\); expected"):
        motion.move(motion.reference, positions[:3])


@pytest.mark.parametrize("name", MOVERS)
def test_a_driven_edge_without_length_is_refused(plate, name):
    motion = MeshMotion(plate.structure, 2, plate.edges, MOVERS[name](plate), halvings=0)
    positions = motion.reference.positions.copy()
    positions[motion.driven.rows[0]] = positions[motion.driven.rows[0][0]]
    with pytest.raises(MoverError, match=r"the driven edge .* has no length: both ends are at"):
        motion.move(motion.reference, positions)


def test_misuse(plate):
    mover = MOVERS["pseudo-solid"](plate)
    with pytest.raises(MoverError, match=r"the mover drives the vertices .*; expected those of the driven edges"):
        MeshMotion(plate.structure, 2, plate.edges[:3], mover)
    with pytest.raises(MoverError, match="inherit is 'some'; expected 'auto', 'all' or 'none'"):
        MeshMotion(plate.structure, 2, plate.edges, mover, inherit="some")
    with pytest.raises(MoverError, match="halvings is -1; expected an integer >= 0"):
        MeshMotion(plate.structure, 2, plate.edges, mover, halvings=-1)
    with pytest.raises(MoverError, match=r"driven edges: \[0, 0\]; expected numbers of edges .*each once"):
        driven_edges(plate.structure, 2, [0, 0])
    still = np.setdiff1d(np.flatnonzero(plate.structure.topology.blocks_per_edge == 1), plate.edges)
    with pytest.raises(MoverError, match=r"takes the end tangents of edge .*, which is not driven"):
        driven_edges(plate.structure, 2, plate.edges).end_rows(still[:1])


def test_no_crossing_is_found_where_there_is_none(plate, bend):
    motion = MeshMotion(plate.structure, 4, plate.edges, MOVERS["barrier"](plate))
    state = motion.move(motion.reference, bend(motion.reference.positions, 90.0))
    assert boundary_crossing(state.structure, 4) is None


def test_regenerate_of_the_moved_structure_at_another_order(plate, bend):
    motion = MeshMotion(plate.structure, 4, plate.edges, MOVERS["barrier"](plate))
    state = motion.move(motion.reference, bend(motion.reference.positions, 60.0))
    fine = generate(state.structure, 7)
    assert certify(fine).valid
    other = regenerate(generate(plate.structure, 7), state.structure)
    np.testing.assert_array_equal(other.points, fine.points)
