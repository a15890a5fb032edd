from __future__ import annotations

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers import PseudoSolid, inverted_blocks
from hoblock.quality import scaled_jacobian


def perturbed_grid(n: int, seed: int = 7) -> BlockStructure:
    """n × n blocks in the unit square, vertices inside displaced at random."""
    x = np.linspace(0.0, 1.0, n + 1)
    vertices = np.stack(np.meshgrid(x, x), axis=-1)
    inside = np.random.default_rng(seed).uniform(-0.2, 0.2, (n - 1, n - 1, 2)) / n
    vertices[1:-1, 1:-1] += inside
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    return BlockStructure.build(vertices.reshape(-1, 2), quads.tolist())


def test_the_patch_test_a_linear_displacement_of_the_boundary_is_linear_inside():
    structure = perturbed_grid(4)
    solid = PseudoSolid(structure, structure.topology.boundary_vertices, exponent=0.0)
    x = structure.vertices
    wanted = x + x @ np.array([[0.1, -0.2], [0.3, 0.05]]) + [0.4, -0.7]
    np.testing.assert_allclose(solid.move(x, wanted[solid.driven]), wanted, atol=1e-13)


@pytest.mark.parametrize("exponent", [-2.0, -1.0, 0.0, 1.5, 3.0])
def test_a_rigid_translation_of_the_whole_boundary_translates_everything(exponent):
    structure = perturbed_grid(5)
    solid = PseudoSolid(structure, structure.topology.boundary_vertices, exponent=exponent)
    shift = np.array([0.3, -1.1])
    moved = solid.move(structure.vertices, structure.vertices[solid.driven] + shift)
    np.testing.assert_allclose(moved, structure.vertices + shift, atol=1e-13)


def element_stiffness(corners: np.ndarray, E: float, nu: float) -> np.ndarray:
    """Stiffness (8, 8) of a bilinear quad in plane strain, Voigt form, 3 × 3 Gauss points: the textbook's way."""
    D = E / ((1 + nu) * (1 - 2 * nu)) * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, 0.5 - nu]])
    K = np.zeros((8, 8))
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    points, weights = np.polynomial.legendre.leggauss(3)
    for r, w in zip(points, weights, strict=True):
        for s, z in zip(points, weights, strict=True):
            dN = 0.25 * np.stack([signs[:, 0] * (1 + signs[:, 1] * s), signs[:, 1] * (1 + signs[:, 0] * r)])
            J = dN @ corners
            G = np.linalg.solve(J, dN)
            B = np.zeros((3, 8))
            B[0, 0::2], B[1, 1::2], B[2, 0::2], B[2, 1::2] = G[0], G[1], G[1], G[0]
            K += w * z * np.linalg.det(J) * B.T @ D @ B
    return K


@pytest.mark.parametrize("exponent", [-1.0, 2.0])
def test_the_response_is_that_of_a_stiffness_matrix_assembled_by_hand(exponent):
    structure = perturbed_grid(4, seed=11)
    boundary = structure.topology.boundary_vertices
    solid = PseudoSolid(structure, boundary[::2], exponent=exponent, poissons_ratio=0.2)
    quads = structure.topology.quads
    corners = structure.vertices[quads]
    d, e = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    area = 0.5 * (d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0])
    K = np.zeros((2 * len(structure.vertices),) * 2)
    for quad, corner, stiffness in zip(quads, corners, (area / area.min()) ** exponent, strict=True):
        dofs = (2 * quad[:, None] + [0, 1]).ravel()
        K[np.ix_(dofs, dofs)] += element_stiffness(corner, float(stiffness), 0.2)
    free, driven = ((2 * v[:, None] + [0, 1]).ravel() for v in (solid.free, solid.driven))
    expected = -np.linalg.solve(K[np.ix_(free, free)], K[np.ix_(free, driven)])
    assert solid.matrix.shape == expected.shape
    np.testing.assert_allclose(solid.matrix, expected, atol=1e-12)


def test_vertices_neither_driven_nor_free_are_the_reference_s_and_arguments_are_untouched(wall_ramm):
    structure = wall_ramm.structure
    solid = PseudoSolid(structure, wall_ramm.driven)
    current = structure.vertices + 0.25
    copy = current.copy()
    positions = structure.vertices[solid.driven] + [0.0, 0.01]
    moved = solid.move(current, positions)
    fixed = np.setdiff1d(np.arange(len(moved)), np.union1d(solid.driven, solid.free))
    assert len(solid.free) == 28
    assert np.array_equal(moved[fixed], structure.vertices[fixed])
    assert np.array_equal(moved[solid.driven], positions)
    assert np.array_equal(current, copy)
    assert moved.flags.writeable
    assert not np.may_share_memory(moved, current)


def test_moves_are_linear_and_do_not_depend_on_the_path(plate_in_box, rig):
    run = rig(plate_in_box, PseudoSolid(plate_in_box.structure, plate_in_box.driven), "rotation")
    for degrees in (10.0, -25.0, 40.0):
        run.to(degrees)
    assert np.array_equal(run.to(20.0), run.mover.move(plate_in_box.structure.vertices, run.driven_at(20.0)))
    np.testing.assert_allclose(run.to(0.0), plate_in_box.structure.vertices, rtol=0.0, atol=1e-13)
    start = plate_in_box.structure.vertices
    first, second = (run.mover.move(start, run.driven_at(s)) - start for s in (8.0, -30.0))
    both = (
        start[run.mover.driven]
        + 2.0 * (run.driven_at(8.0) - start[run.mover.driven])
        + (run.driven_at(-30.0) - start[run.mover.driven])
    )
    np.testing.assert_allclose(run.mover.move(start, both) - start, 2.0 * first + second, atol=1e-13)


def test_a_negative_exponent_keeps_small_blocks_stiffer(plate_in_box):
    # A strip beyond the plate's tip is one of the smallest blocks: the stiffer it is, the more it turns with the tip.
    structure = plate_in_box.structure
    near, far = (
        [int(np.argmin(np.hypot(*(structure.vertices - (x, y)).T))) for y in (-0.01, 0.01)] for x in (0.5, 0.75)
    )
    turn = []
    for exponent in (-1.0, 0.0, 1.0):
        solid = PseudoSolid(structure, plate_in_box.driven, exponent=exponent)
        positions = structure.vertices[solid.driven] @ np.array([[1.0, 0.2], [-0.2, 1.0]])
        moved = solid.move(structure.vertices, positions)
        slope = (moved[far].mean(axis=0) - moved[near].mean(axis=0))[1] / 0.25
        turn.append(slope)
    assert turn[0] > turn[1] > turn[2]


@pytest.mark.parametrize(
    ("motion", "end", "least", "most"),
    [
        ("translation", 0.99, 0.80, 0.88),
        ("rotation", 180.0, 45.0, 57.0),
        ("bending", 270.0, 126.0, 144.0),
    ],
)
def test_reach_of_a_plate_in_a_box(plate_in_box, rig, motion, end, least, most):
    run = rig(plate_in_box, PseudoSolid(plate_in_box.structure, plate_in_box.driven), motion)
    assert least <= run.reach(end) <= most


def test_the_paper_s_exponent_does_not_reach_as_far(plate_in_box, rig):
    structure, driven = plate_in_box.structure, plate_in_box.driven
    assert rig(plate_in_box, PseudoSolid(structure, driven, exponent=2.0), "translation").reach(0.99) < 0.5


def test_the_wall_ramm_flap_at_its_largest_deflection(wall_ramm, rig):
    run = rig(wall_ramm, PseudoSolid(wall_ramm.structure, wall_ramm.driven), "cantilever")
    tip = run.driven_at(0.16688)[:, 1].max() - 6.03
    assert tip == pytest.approx(1.3, abs=0.01)
    for s in (0.16688, -0.16688):
        vertices = run.to(s)
        assert run.valid_at(s)
        assert not inverted_blocks(wall_ramm.structure.topology, vertices).size
        assert scaled_jacobian(run.mesh_at(s)).min() > 0.15
    assert run.reach(1.2) > 0.24


def test_a_driven_vertex_may_lie_inside():
    structure = perturbed_grid(3)
    inner = np.setdiff1d(np.arange(16), structure.topology.boundary_vertices)
    solid = PseudoSolid(structure, inner[:1])
    assert np.array_equal(solid.free, inner[1:])
    moved = solid.move(structure.vertices, structure.vertices[inner[:1]] + [0.05, 0.0])
    assert (moved[inner[1:], 0] > structure.vertices[inner[1:], 0]).any()


def test_without_free_vertices_the_driven_ones_are_copied():
    structure = BlockStructure.build(np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), [[0, 1, 2, 3]])
    solid = PseudoSolid(structure, np.array([2]))
    assert not solid.has_free_vertices
    assert PseudoSolid(perturbed_grid(2), np.array([0])).has_free_vertices
    moved = solid.move(structure.vertices, np.array([[1.5, 1.5]]))
    assert moved.tolist() == [[0, 0], [1, 0], [1.5, 1.5], [0, 1]]


def test_without_driven_vertices_nothing_moves():
    structure = perturbed_grid(2)
    solid = PseudoSolid(structure, np.array([], dtype=np.int64))
    assert np.array_equal(solid.move(structure.vertices, np.zeros((0, 2))), structure.vertices)


@pytest.mark.parametrize("driven", [[3, 1], [1, 1], [-1, 2], [0, 9]])
def test_driven_vertices_must_be_ascending_and_exist(driven):
    with pytest.raises(MoverError, match=r"driven: \[.*\]; expected ascending vertex numbers from 0 to 8"):
        PseudoSolid(perturbed_grid(2), np.array(driven))


def test_driven_vertices_must_be_integers():
    with pytest.raises(MoverError, match=r"driven: array of shape \(2,\) and type float64"):
        PseudoSolid(perturbed_grid(2), np.array([0.0, 1.0]))


@pytest.mark.parametrize("ratio", [0.5, -1.0, float("nan")])
def test_poissons_ratio_must_be_below_a_half(ratio):
    with pytest.raises(MoverError, match="poissons_ratio is"):
        PseudoSolid(perturbed_grid(2), np.array([0]), poissons_ratio=ratio)


def test_the_exponent_must_be_finite():
    with pytest.raises(MoverError, match="exponent is inf"):
        PseudoSolid(perturbed_grid(2), np.array([0]), exponent=float("inf"))


def test_blocks_without_area_are_refused():
    structure = perturbed_grid(2)
    flat = structure.moved(structure.vertices * [1.0, 0.0])
    with pytest.raises(MoverError, match=r"\(0, 1, 4, 3\) has area 0 .* expected a positive area"):
        PseudoSolid(flat, np.array([0]))


def test_positions_that_do_not_fit_are_named():
    structure = perturbed_grid(2)
    solid = PseudoSolid(structure, np.array([0, 5]))
    with pytest.raises(MoverError, match=r"positions has shape \(3, 2\); expected \(2, 2\)"):
        solid.move(structure.vertices, np.zeros((3, 2)))
    with pytest.raises(MoverError, match=r"positions\[1\], vertex '5', is \[nan, 0.0\]; expected finite"):
        solid.move(structure.vertices, np.array([[0.0, 0.0], [np.nan, 0.0]]))


def test_an_incremental_solid_turns_further(rig, plate_in_box):
    reach = [
        rig(plate_in_box, PseudoSolid(plate_in_box.structure, plate_in_box.driven, incremental=flag), "rotation").reach(
            180.0
        )
        for flag in (False, True)
    ]
    assert reach[1] > reach[0] >= 48.0


def test_an_incremental_solid_drifts(rig, wall_ramm):
    once = PseudoSolid(wall_ramm.structure, wall_ramm.driven)
    steps = PseudoSolid(wall_ramm.structure, wall_ramm.driven, incremental=True)
    assert steps.depends_on_state
    assert not once.depends_on_state
    gaps = []
    for mover in (once, steps):
        run = rig(wall_ramm, mover, "cantilever")
        for s in 0.16 * np.sin(np.linspace(0.0, 2.0 * np.pi, 25)[1:]):
            run.to(s)
        gaps.append(np.abs(run.vertices - wall_ramm.structure.vertices).max())
    assert gaps[0] < 1e-14
    assert gaps[1] > 1e-6


def test_a_small_increment_is_that_of_the_reference(wall_ramm):
    start, driven = wall_ramm.structure.vertices, wall_ramm.driven
    shift = 1e-5 * np.random.default_rng(5).standard_normal((len(driven), 2))
    once, steps = (
        PseudoSolid(wall_ramm.structure, driven, incremental=flag).move(start, start[driven] + shift)
        for flag in (False, True)
    )
    np.testing.assert_allclose(once, steps, atol=1e-15)
