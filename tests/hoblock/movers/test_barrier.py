"""The barrier mover: what it minimises, where it starts, what it does not depend on, what it refuses."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, Parametric
from hoblock.errors import MoverError
from hoblock.movers import BarrierEnergy, inverted_blocks
from hoblock.movers.end_tangents import nodal_end_tangents

TIP_13 = 0.16688  # amplitude of the cantilever's slope for a tip deflection of 1.3


def square_grid(n, shift=None):
    x = np.arange(n + 1.0)
    vertices = np.stack(np.meshgrid(x, x), axis=-1)
    if shift is not None:
        vertices[1:-1, 1:-1] += shift
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    return BlockStructure.build(vertices.reshape(-1, 2), quads.tolist())


def energy_of(mover, vertices, driven, tangents=None):
    bound = mover._block.bound(driven, tangents)
    return bound, mover._block.unknowns(vertices)


def rotated(points, angle, center=(0.0, 0.0)):
    c, s = np.cos(angle), np.sin(angle)
    return (points - center) @ np.array([[c, s], [-s, c]]) + center


@pytest.fixture(params=["bar", "ang"])
def energy(request):
    return request.param


def test_the_reference_is_where_the_distortion_is_smallest(plate_in_box, wall_ramm):
    for case in (plate_in_box, wall_ramm):
        mover = BarrierEnergy(case.structure, case.driven)
        start = case.structure.vertices
        np.testing.assert_allclose(mover.move(start, start[case.driven]), start, atol=1e-13)
        bound, y = energy_of(mover, start, start[case.driven])
        value, gradient, hessian = bound.derivatives(y, 0.0, False)
        assert abs(value) < 1e-15
        assert np.abs(gradient).max() < 1e-13
        assert np.linalg.eigvalsh(hessian)[0] > 0.0


def test_the_gradient_and_hessian_are_those_of_the_energy(plate_in_box, energy):
    case = plate_in_box
    sliding = np.setdiff1d(case.structure.topology.boundary_vertices, case.driven)
    corners = np.abs(case.structure.vertices[sliding]).min(axis=1) > 1.0 - 1e-9
    mover = BarrierEnergy(case.structure, case.driven, energy=energy, sliding=sliding[~corners])
    vertices = case.structure.vertices + 0.002 * np.random.default_rng(3).standard_normal(case.structure.vertices.shape)
    bound, y = energy_of(mover, vertices, vertices[case.driven])
    assert len(y) == 2 * 18 + 22
    value, gradient, hessian = bound.derivatives(y, 0.0, False)
    assert value == pytest.approx(bound.value(y, 0.0)[0], rel=1e-13)
    h = 1e-6
    for k in range(len(y)):
        step = h * (np.arange(len(y)) == k)
        up, down = bound.derivatives(y + step, 0.0, False), bound.derivatives(y - step, 0.0, False)
        assert (up[0] - down[0]) / (2 * h) == pytest.approx(gradient[k], abs=1e-6 * np.abs(gradient).max())
        np.testing.assert_allclose((up[1] - down[1]) / (2 * h), hessian[k], atol=1e-5 * np.abs(hessian).max())


@pytest.mark.parametrize("emphasis", [0.0, 1.0])
def test_a_body_and_its_box_that_turn_together_stay_as_they_are(plate_in_box, emphasis):
    structure = plate_in_box.structure
    driven = structure.topology.boundary_vertices
    mover = BarrierEnergy(structure, driven, emphasis=emphasis)
    for angle in (0.3, 2.0, np.pi):
        turned = rotated(structure.vertices, angle) + np.array([3.0, -1.0])
        np.testing.assert_allclose(mover.move(structure.vertices, turned[driven]), turned, atol=1e-11)


def test_a_scattered_start_of_a_grid_ends_in_the_grid(energy):
    grid = square_grid(5)
    nothing = np.zeros(0, dtype=np.int64)
    mover = BarrierEnergy(grid, nothing, energy=energy)
    scattered = grid.vertices.copy()
    scattered[mover.free] += np.random.default_rng(11).uniform(-1.5, 1.5, (len(mover.free), 2))
    assert len(inverted_blocks(grid.topology, scattered)) > 10
    placed = mover.place(scattered, np.zeros((0, 2)))
    np.testing.assert_allclose(placed.vertices, grid.vertices, atol=1e-9)
    assert placed.strict
    assert placed.smallest_corner == pytest.approx(1.0)
    assert placed.iterations > 5


def test_a_position_has_one_mesh_whatever_the_way_to_it(rig, wall_ramm):
    mover = BarrierEnergy(wall_ramm.structure, wall_ramm.driven)
    cold = BarrierEnergy(wall_ramm.structure, wall_ramm.driven, warm=False)
    run = rig(wall_ramm, mover, "cantilever")
    for s in 2.0 * TIP_13 * np.sin(np.linspace(0.0, 2.0 * np.pi, 13)[1:]):
        warm = run.to(s)
        direct = cold.move(warm, run.driven_at(s))
        np.testing.assert_allclose(warm, direct, atol=1e-11)
    np.testing.assert_allclose(run.vertices, wall_ramm.structure.vertices, atol=1e-12)


@pytest.mark.parametrize(("motion", "end", "at_least"), [("translation", 0.99, 0.95), ("rotation", 180.0, 150.0)])
def test_reach_around_the_plate(rig, plate_in_box, motion, end, at_least):
    mover = BarrierEnergy(plate_in_box.structure, plate_in_box.driven)
    assert rig(plate_in_box, mover, motion).reach(end) >= at_least


def test_the_end_tangents_of_a_bent_plate_matter(rig, plate_in_box):
    mover = BarrierEnergy(plate_in_box.structure, plate_in_box.driven, edges=plate_in_box.edges)
    run = rig(plate_in_box, mover, "bending")
    nodes = np.stack([run.motion(run.curves[int(e)], 200.0) for e in plate_in_box.edges])
    tangents = nodal_end_tangents(nodes, 4)
    exact = mover.move(plate_in_box.structure.vertices, run.driven_at(200.0), tangents)
    chords = mover.move(plate_in_box.structure.vertices, run.driven_at(200.0))
    assert np.abs(exact - chords).max() > 0.01


@pytest.mark.parametrize("motion", ["rotation", "bending"])
def test_velocity_is_the_derivative_of_the_position(rig, plate_in_box, energy, motion):
    case = plate_in_box
    sliding = np.setdiff1d(case.structure.topology.boundary_vertices, case.driven)
    sliding = sliding[np.abs(case.structure.vertices[sliding]).min(axis=1) < 1.0 - 1e-9]
    mover = BarrierEnergy(case.structure, case.driven, edges=case.edges, energy=energy, sliding=sliding)
    run = rig(case, mover, motion)

    def at(s):
        nodes = np.stack([run.motion(run.curves[int(e)], s) for e in case.edges])
        return run.driven_at(s), nodal_end_tangents(nodes, 4)

    s, h = 50.0, 0.01
    state = case.structure.vertices
    for part in np.linspace(0.0, s, 6):
        state = mover.move(state, *at(part))
    # Differences of order four of everything that is given, and of the result.
    positions = [at(s + k * h) for k in (-2, -1, 1, 2)]
    weights = np.array([1.0, -8.0, 8.0, -1.0]) / (12.0 * h)
    driven = sum(w * x for w, (x, _) in zip(weights, positions, strict=True))
    turning = sum(w * t for w, (_, t) in zip(weights, positions, strict=True))
    difference = sum(w * mover.move(state, *p) for w, p in zip(weights, positions, strict=True))
    velocity = mover.velocity(state, driven, at(s)[1], turning)
    size = np.abs(difference).max()
    np.testing.assert_allclose(velocity, difference, atol=1e-6 * size)
    without = mover.velocity(state, driven)
    if motion == "bending":
        assert np.abs(without - difference).max() > 1e-3 * size  # the chords do not turn as the tangents do


def test_what_nothing_reaches_is_not_touched():
    # Two squares of 3 × 3 blocks that share one corner: what moves in one cannot move the other.
    grid = square_grid(3)
    quads = grid.topology.quads
    other = np.where(quads == 0, 15, quads + 16)
    vertices = np.concatenate([grid.vertices, grid.vertices + 3.0])
    keep = np.unique(np.concatenate([quads, other]))
    number = np.full(32, -1)
    number[keep] = np.arange(len(keep))
    structure = BlockStructure.build(vertices[keep], [*number[quads].tolist(), *number[other].tolist()])
    driven = np.array([int(number[1]), int(number[2])])
    mover = BarrierEnergy(structure, driven)
    assert len(mover.free) == 4
    moved = mover.move(structure.vertices, structure.vertices[driven] + [0.0, 0.4])
    still = structure.vertices[:, 1] > 3.0
    np.testing.assert_array_equal(moved[still], structure.vertices[still])
    assert (moved[mover.free] != structure.vertices[mover.free]).any(axis=1).all()


def test_many_blocks_are_solved_sparsely_and_end_in_the_same_place():
    grid = square_grid(18)
    boundary = grid.topology.boundary_vertices
    bottom = boundary[grid.vertices[boundary, 1] == 0.0]
    sparse = BarrierEnergy(grid, bottom)
    assert sparse._block.size > 400
    wave = grid.vertices[bottom] + np.stack([0 * bottom, 0.4 * np.sin(grid.vertices[bottom, 0] / 3.0)], axis=-1)
    vertices = sparse.move(grid.vertices, wave)
    bound, y = energy_of(sparse, vertices, wave)
    assert np.abs(bound.derivatives(y, 0.0, False)[1]).max() < 1e-12
    assert not len(inverted_blocks(grid.topology, vertices))


def test_curved_edges_count_with_their_tangents():
    vertices = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (0, 1), "e": (1, 1), "f": (2, 1), "g": (0, 2), "h": (1, 2),
                "i": (2, 2)}  # fmt: skip
    blocks = [("a", "b", "e", "d"), ("b", "c", "f", "e"), ("d", "e", "h", "g"), ("e", "f", "i", "h")]
    bulge = Parametric(lambda t: np.stack([np.asarray(t), 1.0 - 0.3 * np.sin(np.pi * np.asarray(t))], axis=-1))
    structure = BlockStructure.build(vertices, blocks, curves={("d", "e"): bulge})
    mover = BarrierEnergy(structure, np.array([0]))
    start = structure.vertices
    np.testing.assert_allclose(mover.move(start, start[[0]]), start, atol=1e-12)


def test_no_free_vertices_copies_what_is_driven():
    grid = square_grid(1)
    mover = BarrierEnergy(grid, np.array([0]))
    assert not mover.has_free_vertices
    moved = mover.move(grid.vertices, np.array([[0.1, 0.2]]))
    np.testing.assert_array_equal(moved[0], [0.1, 0.2])
    np.testing.assert_array_equal(moved[1:], grid.vertices[1:])
    np.testing.assert_array_equal(mover.velocity(grid.vertices, np.array([[1.0, 2.0]]))[1:], 0.0)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"energy": "angle"}, "energy is 'angle'; expected 'bar' or 'ang'"),
        ({"size_weight": -1.0}, "size_weight is -1.0; expected a number >= 0"),
        ({"emphasis": np.nan}, "emphasis is nan; expected a number >= 0"),
        ({"length_weight": 0.0}, "length_weight is 0.0; expected a positive number"),
        ({"edges": np.array([500])}, r"edges are \[500\]; expected numbers of edges between driven vertices"),
        (
            {"edges": np.array([0]), "tangents": np.zeros((2, 2, 2))},
            r"tangents have shape \(2, 2, 2\); expected \(1, 2",
        ),
    ],
)
def test_bad_parameters(options, match):
    grid = square_grid(3)
    edge = options.get("edges")
    driven = grid.topology.boundary_vertices if edge is not None else np.array([0])
    if edge is not None and edge[0] == 0:
        driven = np.unique(grid.topology.edges[0])
    with pytest.raises(MoverError, match=match):
        BarrierEnergy(grid, driven, **options)


def test_arguments_that_are_not_finite():
    grid = square_grid(3)
    driven = np.unique(grid.topology.edges[0])
    mover = BarrierEnergy(grid, driven, edges=np.array([0]))
    with pytest.raises(MoverError, match=r"move: positions\[1\], vertex '1', is \[nan, 0.0\]; expected finite"):
        mover.move(grid.vertices, np.array([[0.0, 0.0], [np.nan, 0.0]]))
    with pytest.raises(MoverError, match=r"the tangents of edge 0–1 are .*nan.*Nodes at its ends coincide"):
        mover.move(grid.vertices, grid.vertices[driven], np.full((1, 2, 2), np.nan))


def test_a_boundary_that_leaves_no_place_is_refused_by_name(plate_in_box):
    mover = BarrierEnergy(plate_in_box.structure, plate_in_box.driven)
    start = plate_in_box.structure.vertices
    outside = start[plate_in_box.driven] + [0.0, 2.5]
    with pytest.raises(MoverError, match=r"found no valid place for the 18 vertices: \d+ corners of blocks are turned"):
        mover.move(start, outside)


def test_a_reference_with_a_flat_corner_is_refused_by_name():
    vertices = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (0, 1), "e": (1, 1), "f": (2, 1), "g": (0, 2), "h": (1, 2),
                "i": (2, 2)}  # fmt: skip
    blocks = [("a", "b", "e", "d"), ("b", "c", "f", "e"), ("d", "e", "h", "g"), ("e", "f", "i", "h")]
    bulge = Arc.through((0.0, 1.0), (0.2, 0.3), (1.0, 1.0))
    structure = BlockStructure.build(vertices, blocks, curves={("d", "e"): bulge})
    with pytest.raises(MoverError, match=r"corner at vertex '[de]' of .* is not between 0° and 180° in the reference"):
        BarrierEnergy(structure, np.array([0]))
