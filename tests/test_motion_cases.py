"""The mesh-motion tests are the ones that docs/meshing/mesh_motion_tests.md defines."""

from __future__ import annotations

import importlib
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import FrozenInstanceError
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from hoblock import generate
from hoblock.errors import TopologyError
from hoblock.quality import certify

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
BETA, SIGMA = 1.875104, 0.7340955
CLAMP = 0.2 + math.sqrt(0.05**2 - 0.01**2)

# blocks, vertices, free vertices, driven edges, driven vertices, sliding vertices
SIZES = {
    ("T3a", "cross4x"): (36, 54, 18, 10, 10, 22),
    ("T3a", "O10r3"): (30, 40, 20, 10, 10, 6),
    ("T3b", "cross4x"): (36, 54, 18, 10, 10, 22),
    ("T3b", "O10r3"): (30, 40, 20, 10, 10, 6),
    ("T3c", "cross4x"): (36, 54, 18, 10, 10, 22),
    ("T3c", "O10r3"): (30, 40, 20, 10, 10, 6),
    ("T4a", "cross24"): (24, 36, 12, 4, 4, 16),
    ("T4a", "O4r3"): (12, 16, 8, 4, 4, 0),
    ("T4a", "O10r3"): (30, 40, 20, 10, 10, 6),
    ("T4b", "cross24"): (24, 36, 12, 4, 4, 16),
    ("T4b", "O4r3"): (12, 16, 8, 4, 4, 0),
    ("T4b", "O10r3"): (30, 40, 20, 10, 10, 6),
    ("WR", "f4"): (56, 80, 32, 9, 10, 28),
    ("WR", "f1"): (38, 56, 20, 3, 4, 22),
    ("TH", "b3"): (37, 56, 18, 9, 10, 20),
}
LAYOUTS = [("T3a", "cross4x"), ("T3a", "O10r3"), *[key for key in SIZES if key[0] in ("T4a", "WR", "TH")]]
# a layout, end, unit, box, and the body that moves as left, bottom, right, top
TESTS = {
    "T3a": ("O10r3", 0.99, "gap", (-1.0, -1.0, 1.0, 1.0), (-0.5, -0.01, 0.5, 0.01)),
    "T3b": ("O10r3", 180.0, "degrees", (-1.0, -1.0, 1.0, 1.0), (-0.5, -0.01, 0.5, 0.01)),
    "T3c": ("O10r3", 270.0, "degrees", (-1.0, -1.0, 1.0, 1.0), (-0.5, -0.01, 0.5, 0.01)),
    "T4a": ("O4r3", 1.0, "fraction", (-12.5, -12.5, 12.5, 12.5), (-2.5, -0.5, 2.5, 0.5)),
    "T4b": ("O4r3", 360.0, "degrees", (-12.5, -12.5, 12.5, 12.5), (-2.5, -0.5, 2.5, 0.5)),
    "WR": ("f4", 1.2, "slope amplitude A", (0.0, 0.0, 19.5, 12.0), (5.5, 5.97, 9.5, 6.03)),
    "TH": ("b3", 1.0, "slope amplitude A", (0.0, 0.0, 2.5, 0.41), (CLAMP, 0.19, 0.6, 0.21)),
}


@pytest.fixture(scope="module")
def cases() -> Iterator[ModuleType]:
    before = set(sys.modules)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(FOLDER))
        yield importlib.import_module("motion_cases")
    for name in set(sys.modules) - before:
        if name.partition(".")[0] == "motion_cases":
            del sys.modules[name]


@pytest.fixture
def case(cases: ModuleType) -> Callable:
    def of(test: str, layout: str | None = None, **settings):
        return cases.motion_case(test, layout or TESTS[test][0], **settings)

    return of


def body_points(test: str) -> np.ndarray:
    """Points in and around the body that moves, corners included."""
    left, bottom, right, top = TESTS[test][4]
    x, y = np.meshgrid(np.linspace(left, right, 9), np.linspace(bottom, top, 3))
    return np.stack([x.ravel(), y.ravel()], axis=-1)


def distances(points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points[:, None] - points, axis=-1)


def position(case, name: str) -> np.ndarray:
    return case.structure.vertices[case.structure.topology.vertex(name)]


def has_block(case, corners: list[tuple[float, float]]) -> bool:
    found = case.structure.vertices[case.structure.topology.quads]
    wanted = np.array(corners)
    return any(np.allclose(np.roll(block, -k, axis=0), wanted, atol=1e-12) for block in found for k in range(4))


def test_every_test_has_its_layouts(cases):
    assert list(SIZES) == list(cases.CASES)


@pytest.mark.parametrize(("test", "layout"), SIZES)
def test_numbers_of_blocks_and_vertices(test, layout, case):
    found = case(test, layout)
    topology = found.structure.topology
    fixed = np.union1d(topology.boundary_vertices, found.driven)
    free = len(found.structure.vertices) - len(fixed)
    sizes = len(topology.quads), len(found.structure.vertices), free
    assert (*sizes, len(found.edges), len(found.driven), len(found.sliding)) == SIZES[test, layout]
    assert (found.test, found.layout) == (test, layout)


@pytest.mark.parametrize("order", [1, 2, 4, 6])
@pytest.mark.parametrize(("test", "layout"), LAYOUTS)
def test_references_are_certified(test, layout, order, case):
    assert certify(generate(case(test, layout).structure, order)).verdict == "valid"


@pytest.mark.parametrize(("test", "layout"), LAYOUTS)
def test_blocks_fill_the_box_around_the_bodies(test, layout, case):
    structure = case(test, layout).structure
    t, area = np.linspace(0.0, 1.0, 2001), 0.0
    for quad_, edges in zip(structure.topology.quads, structure.topology.block_edges, strict=True):
        for k, edge in enumerate(edges):
            line = structure.edge_points(int(edge), t)
            if structure.topology.edges[edge][0] != quad_[k]:
                line = line[::-1]
            area += 0.5 * float(np.sum(line[:-1, 0] * line[1:, 1] - line[1:, 0] * line[:-1, 1]))
    left, bottom, right, top = TESTS[test][3]
    opening = 2.0 * math.asin(0.01 / 0.05)
    segment = 0.5 * 0.05**2 * (opening - math.sin(opening))  # of the cylinder that is in the flag's rectangle
    solid = {"T3a": 0.02, "T4a": 5.0, "WR": 1.0 + 4.0 * 0.06}.get(
        test, math.pi * 0.05**2 + 0.02 * (0.6 - CLAMP) - segment
    )
    assert area == pytest.approx((right - left) * (top - bottom) - solid, rel=1e-8)


@pytest.mark.parametrize(("test", "layout"), SIZES)
def test_driven_edges_are_the_outline_of_the_body(test, layout, case):
    found = case(test, layout)
    left, bottom, right, top = TESTS[test][4]
    ends = found.structure.vertices[found.structure.topology.edges[found.edges]]
    clamped = test in ("WR", "TH")
    outline = 2.0 * (right - left) + (1.0 if clamped else 2.0) * (top - bottom)
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(outline, rel=1e-12)
    middles = ends.mean(axis=1)
    sides = np.abs(middles[:, [0, 1, 0, 1]] - [left, bottom, right, top]).min(axis=1)
    assert sides.max() < 1e-12
    assert (np.abs(middles[:, 0] - left) > 1e-9).all() == clamped
    assert not set(found.edges) & set(found.structure.curves)
    assert (found.structure.topology.blocks_per_edge[found.edges] == 1).all()


@pytest.mark.parametrize(("test", "layout"), SIZES)
def test_sliding_vertices_are_all_on_the_box_without_its_corners(test, layout, case):
    found = case(test, layout)
    left, bottom, right, top = TESTS[test][3]
    x, y = found.structure.vertices.T
    walls, ends = (y == bottom) | (y == top), (x == left) | (x == right)
    assert np.flatnonzero(walls & ends).size == 4
    np.testing.assert_array_equal(found.sliding, np.flatnonzero(walls ^ ends))
    assert np.isin(found.sliding, found.structure.topology.boundary_vertices).all()


def test_lines_of_the_crosses(case):
    plate, block = case("T3b", "cross4x").structure.vertices, case("T4b", "cross24").structure.vertices
    assert np.unique(plate[:, 0]).tolist() == [-1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1]
    assert np.unique(plate[:, 1]).tolist() == [-1, -0.4, -0.01, 0.01, 0.4, 1]
    assert np.unique(block[:, 0]).tolist() == [-12.5, -6, -2.5, 2.5, 6, 12.5]
    assert np.unique(block[:, 1]).tolist() == [-12.5, -4, -0.5, 0.5, 4, 12.5]


def test_rings_cut_body_and_box_at_equal_fractions(case):
    ring = case("T3b", "O10r3")
    assert position(ring, "body1") == pytest.approx([-0.25, -0.01])
    assert position(ring, "box1") == pytest.approx([-0.5, -1.0])
    assert position(ring, "ring1_1") == pytest.approx([-0.3, -0.208])
    assert position(ring, "ring2_1") == pytest.approx([-0.375, -0.505])
    assert position(ring, "box5") == pytest.approx([1.0, 1.0])
    assert position(case("T4b", "O4r3"), "ring1_2") == pytest.approx([4.5, 2.9])


@pytest.mark.parametrize("layout", ["f4", "f1"])
def test_strips_of_the_flap_fan_out(layout, case):
    x, y = case("WR", layout).structure.vertices.T
    for place, heights in {
        0.0: [0, 3.5, 5.5, 5.7, 6.3, 6.5, 8.5, 12],
        3.0: [0, 3.5, 5.5, 5.7, 6.3, 6.5, 8.5, 12],
        4.5: [0, 3.5, 5.5, 5.97, 6.03, 6.5, 8.5, 12],
        5.5: [0, 3.5, 5.5, 5.97, 6.03, 6.5, 8.5, 12],
        9.5: [0, 3.5, 4.9, 5.97, 6.03, 7.1, 8.5, 12],
        11.5: [0, 3.5, 4.9, 5.6, 6.4, 7.1, 8.5, 12],
        19.5: [0, 3.5, 4.9, 5.6, 6.4, 7.1, 8.5, 12],
    }.items():
        assert np.sort(y[x == place]) == pytest.approx(heights)
    between = [6.5, 7.5, 8.5] if layout == "f4" else []
    assert np.unique(x).tolist() == sorted([0, 3, 4.5, 5.5, 9.5, 11.5, 19.5, *between])


def test_blocks_around_the_cylinder(case):
    flag = case("TH")
    r = 0.05 * math.sqrt(0.5)
    corner = {"S45": (r, r), "S135": (-r, r), "S225": (-r, -r), "S315": (r, -r)}
    for name, offset in corner.items():
        assert position(flag, name) - 0.2 == pytest.approx(offset, abs=1e-15)
    assert position(flag, "U") == pytest.approx([0.2489898, 0.21], abs=1e-7)
    assert position(flag, "D") == pytest.approx([0.2489898, 0.19], abs=1e-7)
    S45, S135, S225, S315, U, D = (position(flag, name) for name in ("S45", "S135", "S225", "S315", "U", "D"))
    for block in (
        [(0.1, 0.1), S225, S135, (0.1, 0.3)],
        [(0.1, 0.3), S135, S45, (0.3, 0.3)],
        [S225, (0.1, 0.1), (0.3, 0.1), S315],
        [S45, U, (0.3, 0.21), (0.3, 0.3)],
        [D, S315, (0.3, 0.1), (0.3, 0.19)],
        [(0.0, 0.1), (0.1, 0.1), (0.1, 0.3), (0.0, 0.3)],
        [(0.1, 0.3), (0.3, 0.3), (0.3, 0.41), (0.1, 0.41)],
        [(0.5, 0.21), (0.6, 0.21), (0.6, 0.3), (0.5, 0.3)],
        [(0.6, 0.19), (0.8, 0.16), (0.8, 0.25), (0.6, 0.21)],
        [(1.2, 0.16), (2.5, 0.16), (2.5, 0.25), (1.2, 0.25)],
    ):
        assert has_block(flag, block)
    assert not has_block(flag, [(0.5, 0.19), (0.6, 0.19), (0.6, 0.21), (0.5, 0.21)])


def test_only_the_cylinder_is_curved(case):
    structure = case("TH").structure
    assert len(structure.curves) == 5
    for edge in structure.curves:
        radii = np.linalg.norm(structure.edge_points(edge, np.linspace(0.0, 1.0, 11)) - 0.2, axis=1)
        assert radii == pytest.approx(np.full(11, 0.05), rel=1e-12)
    assert not any(case(*key).structure.curves for key in LAYOUTS if key[0] != "TH")


@pytest.mark.parametrize("test", TESTS)
def test_steps_end_and_unit(test, case):
    found = case(test)
    assert (found.end, found.unit) == TESTS[test][1:3]
    assert found.steps() == pytest.approx(np.arange(1, 61) * found.end / 60.0)
    assert found.steps(3) == pytest.approx([found.end / 3.0, found.end / 1.5, found.end])
    with pytest.raises(ValueError, match="count is 0; expected at least 1"):
        found.steps(0)


@pytest.mark.parametrize("test", TESTS)
def test_the_body_starts_where_it_is_and_then_moves(test, case):
    found, points = case(test), body_points(test)
    np.testing.assert_allclose(found.motion(points, 0.0), points, rtol=0.0, atol=2e-15)
    assert np.abs(found.motion(points, found.steps()[0]) - points).max() > 1e-3


@pytest.mark.parametrize("test", ["T3a", "T3b", "T4a", "T4b"])
def test_rigid_motions_keep_distances_and_orientation(test, case):
    found, points = case(test), body_points(test)
    for s in found.steps(7):
        moved = found.motion(points, s)
        np.testing.assert_allclose(distances(moved), distances(points), rtol=0.0, atol=1e-13)
        (a, b), (c, d) = (p[[8, 18]] - p[0] for p in (points, moved))
        assert c[0] * d[1] - c[1] * d[0] == pytest.approx(a[0] * b[1] - a[1] * b[0], rel=1e-10)


@pytest.mark.parametrize(
    ("test", "s", "degrees", "shift"),
    [
        ("T3a", 0.7, 0.0, (0.0, 0.7)),
        ("T3b", 90.0, 90.0, (0.0, 0.0)),
        ("T3b", 37.0, 37.0, (0.0, 0.0)),
        ("T4a", 0.25, 15.0, (-2.5, -2.5)),
        ("T4a", 1.0, 60.0, (-10.0, -10.0)),
        ("T4b", 250.0, 250.0, (0.0, 0.0)),
    ],
)
def test_rigid_motions_turn_about_the_centre_then_shift(test, s, degrees, shift, case):
    a = math.radians(degrees)
    centre, right = case(test).motion(np.array([[0.0, 0.0], [0.3, 0.0]]), s)
    assert centre == pytest.approx(shift, abs=1e-14)
    assert right - centre == pytest.approx([0.3 * math.cos(a), 0.3 * math.sin(a)], abs=1e-14)


@pytest.mark.parametrize("degrees", [4.5, 90.0, 270.0])
def test_bending_gives_an_arc_of_unstretched_length(degrees, case):
    motion, a = case("T3c").motion, math.radians(degrees)
    X = np.linspace(-0.5, 0.5, 21)
    middle = motion(np.stack([X, 0.0 * X], axis=-1), degrees)
    chords = 2.0 / a * np.abs(np.sin(0.5 * a * (X[:, None] - X)))  # of equal arcs of a circle of length 1/a × 2π
    np.testing.assert_allclose(distances(middle), chords, rtol=0.0, atol=1e-14)
    top = motion(np.stack([X, 0.01 + 0.0 * X], axis=-1), degrees)
    normal = np.stack([-np.sin(a * X), np.cos(a * X)], axis=-1)
    np.testing.assert_allclose(top - middle, 0.01 * normal, rtol=0.0, atol=1e-14)
    places, weights = np.polynomial.legendre.leggauss(30)
    line = motion(np.stack([0.5 * places, 0.0 * places], axis=-1), degrees)
    assert weights @ line == pytest.approx([0.0, 0.0], abs=1e-14)
    assert middle[0, 1] > middle[10, 1]  # the ends go up


def mode_slope(xi: float) -> float:
    b = BETA * xi
    return BETA * (math.sinh(b) + math.sin(b) - SIGMA * (math.cosh(b) - math.cos(b)))


def test_the_slope_is_that_of_the_first_mode():
    assert quad(mode_slope, 0.0, 1.0)[0] == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize(
    ("test", "root", "length", "sign"), [("WR", (5.5, 6.0), 4.0, 1.0), ("TH", (CLAMP, 0.2), 0.6 - CLAMP, -1.0)]
)
def test_cantilevers_follow_their_slope(test, root, length, sign, case):
    found = case(test)
    for s in (0.05, 0.5 * found.end, found.end):
        for xi in (0.0, 0.3, 1.0):
            point = np.array([[root[0] + xi * length, root[1]]])
            x, y = (
                length * quad(lambda z, s=s, part=part: part(sign * s * mode_slope(z)), 0.0, xi, epsabs=1e-14)[0]
                for part in (math.cos, math.sin)
            )
            moved = found.motion(point, s)[0]
            assert moved - root == pytest.approx([x, y], rel=0.0, abs=2e-13 * length)
            angle = sign * s * mode_slope(xi)
            offset = found.motion(point + np.array([0.0, 0.01]), s)[0] - moved
            assert offset == pytest.approx([-0.01 * math.sin(angle), 0.01 * math.cos(angle)], abs=1e-14)


@pytest.mark.parametrize("test", ["WR", "TH"])
def test_cantilevers_keep_the_length_of_their_middle_line(test, case):
    found = case(test)
    left, bottom, right, top = TESTS[test][4]
    X = np.linspace(left, right, 4001)
    middle = np.stack([X, np.full_like(X, 0.5 * (bottom + top))], axis=-1)
    for s in found.steps(3):
        chords = np.linalg.norm(np.diff(found.motion(middle, s), axis=0), axis=1)
        assert chords.sum() == pytest.approx(right - left, rel=1e-7)  # 4000 chords of at most 4.2 rad in all


@pytest.mark.parametrize("test", ["WR", "TH"])
def test_the_clamp_stays(test, case):
    found = case(test)
    left, bottom, _, top = TESTS[test][4]
    clamp = np.array([[left, bottom], [left, top]])
    np.testing.assert_allclose(found.motion(clamp, found.end), clamp, rtol=0.0, atol=2e-15)


def test_deflections_of_the_flap(case):
    flap = case("WR")
    assert flap.tip(0.16688) == pytest.approx(1.3, abs=2e-5)
    steps = flap.steps()
    tips = [flap.tip(s) for s in steps]
    assert max(tips) == pytest.approx(3.38, abs=0.005)
    assert steps[np.argmax(tips)] == pytest.approx(0.68)
    end = np.array([[9.5, 6.0]])
    assert flap.tip(0.9) == pytest.approx(flap.motion(end, 0.9)[0, 1] - 6.0, rel=1e-12)


def test_drops_of_the_flag(case):
    flag = case("TH")
    assert flag.tip(0.11986) == pytest.approx(83.0, abs=0.01)
    assert flag.tip(0.19022) == pytest.approx(129.0, abs=0.01)
    corner = np.array([[0.6, 0.19]])
    at_wall = brentq(lambda s: flag.motion(corner, s)[0, 1], 0.2, 0.5)
    assert flag.tip(at_wall) == pytest.approx(193.2, abs=0.05)


def test_other_bodies_have_no_tip(case):
    with pytest.raises(ValueError, match="the body of T3c has no tip; expected one of the tests WR and TH"):
        case("T3c").tip(90.0)


@pytest.mark.parametrize("elements", [1, 3])
def test_elements_are_those_of_every_edge(elements, case):
    assert (case("TH").structure.topology.counts == 4).all()
    assert (case("TH", elements=elements).structure.topology.counts == elements).all()


def test_unknown_names(cases):
    with pytest.raises(ValueError, match=r"no test 'T5'; expected one of T3a, T3b, T3c, T4a, T4b, WR, TH\."):
        cases.motion_case("T5", "f4")
    with pytest.raises(ValueError, match=r"T4b has no layout 'f4'; expected one of cross24, O4r3, O10r3\."):
        cases.motion_case("T4b", "f4")
    with pytest.raises(TopologyError, match="counts"):
        cases.motion_case("T4b", "O4r3", elements=0)


def test_cases_cannot_be_changed(case):
    found = case("T3a")
    with pytest.raises(FrozenInstanceError):
        found.end = 2.0
    for numbers in (found.edges, found.driven, found.sliding):
        with pytest.raises(ValueError, match="read-only"):
            numbers[0] = 1
