"""Gradings that keep lengths, through generate and regenerate on structures that move."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, Parametric, Polyline
from hoblock.errors import GradingError
from hoblock.generate import generate, regenerate
from hoblock.grading import BoundaryLayer, Listed, Pieces, TanhSpacing
from hoblock.layout import layout

ORDER = 4
FIRST = 2e-4


def corners_along(mesh, structure, first, second):
    """Points of the element corners along an edge, in the direction asked for."""
    topology = structure.topology
    edge, forward = topology.edge(topology.vertex(first), topology.vertex(second))
    points = mesh.points[layout(structure, mesh.order).nodes_of_edge(edge)][:: mesh.order]
    return points if forward else points[::-1]


def chords(points):
    return np.hypot(*np.diff(points, axis=0).T)


@pytest.fixture
def channel():
    """Two blocks side by side; a–d and c–f are walls seen from below, layers given in both directions."""
    vertices = {"a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (0, 1), "e": (1, 1), "f": (2, 1)}
    blocks = {"left": [("a", "b", "e", "d")], "right": [("b", "c", "f", "e")]}
    return BlockStructure.build(
        vertices,
        blocks,
        counts={("a", "d"): 36, ("a", "b"): 5, ("b", "c"): 5},
        gradings={
            ("a", "d"): BoundaryLayer(FIRST, 1.4),
            ("e", "b"): BoundaryLayer(FIRST, ends="second"),
            ("c", "f"): BoundaryLayer(FIRST, 1.3, 0.05, "both"),
            ("d", "e"): TanhSpacing(0.05, 0.3),
        },
    )


@pytest.mark.parametrize("keep", [False, True])
def test_first_heights_survive_a_motion_of_straight_edges(channel, keep):
    mesh = generate(channel, ORDER)
    rng = np.random.default_rng(311)
    before = channel
    for _ in range(6):
        moved = channel.moved(channel.vertices * 1.4 + 0.2 * rng.standard_normal((6, 2)))
        mesh = regenerate(mesh, moved, previous=before if keep else None)
        before = moved
        for first, second in ("ad", "be", "cf", "fc"):
            found = chords(corners_along(mesh, moved, first, second))
            assert found[0] == pytest.approx(FIRST, abs=1e-12)
        ends = chords(corners_along(mesh, moved, "d", "e"))[[0, -1]]
        np.testing.assert_allclose(ends, [0.05, 0.3], rtol=0, atol=1e-12)


def test_regenerated_is_generated_anew(channel):
    moved = channel.moved(channel.vertices @ np.array([[1.1, 0.3], [-0.1, 1.5]]))
    again = regenerate(generate(channel, ORDER), moved)
    np.testing.assert_allclose(again.points, generate(moved, ORDER).points, rtol=0, atol=1e-15)
    back = regenerate(again, channel)
    np.testing.assert_allclose(back.points, generate(channel, ORDER).points, rtol=0, atol=1e-15)


def sector(r, R, angle, layer):
    at = {
        name: (radius * np.cos(turn), radius * np.sin(turn))
        for name, radius, turn in (("a", r, 0), ("b", R, 0), ("c", R, angle), ("d", r, angle))
    }
    arcs = {
        ("a", "d"): Arc.from_center((0, 0), at["a"], at["d"]),
        ("c", "b"): Arc.from_center((0, 0), at["c"], at["b"]),
    }
    return BlockStructure.build(
        at,
        [("a", "b", "c", "d")],
        counts={("a", "d"): 24, ("a", "b"): 6},
        curves=arcs,
        gradings={("d", "a"): layer, ("b", "c"): layer},
    )


@pytest.mark.parametrize("ends", ["first", "second", "both"])
def test_first_heights_are_arc_lengths_on_arcs(ends):
    layer = BoundaryLayer(FIRST, ends=ends)
    structure = sector(0.5, 2.0, 1.2, layer)
    mesh = generate(structure, ORDER)
    bigger = sector(0.8, 2.5, 1.2, layer)
    moved = structure.moved(bigger.vertices, bigger.curves)
    for shape, radii, points in (
        (structure, (0.5, 2.0), mesh),
        (moved, (0.8, 2.5), regenerate(mesh, moved)),
    ):
        for (first, second), radius in zip(("da", "bc"), radii, strict=True):
            arcs = 2 * radius * np.arcsin(chords(corners_along(points, shape, first, second)) / (2 * radius))
            if ends != "second":
                assert arcs[0] == pytest.approx(FIRST, abs=1e-12)
            if ends != "first":
                assert arcs[-1] == pytest.approx(FIRST, abs=1e-12)


def test_first_height_on_a_curve_with_uneven_speed_whose_end_moves():
    bump = Parametric(lambda t: np.stack([t**2 + t, 0.4 * np.sin(np.pi * t)], axis=-1))  # speed varies threefold
    structure = BlockStructure.build(
        {"a": (0, 0), "b": (2, 0), "c": (2, 2), "d": (0, 2)},
        [("a", "b", "c", "d")],
        counts={("a", "b"): 20},
        curves={("a", "b"): bump},
        gradings={("a", "b"): BoundaryLayer(1e-3, ends="both")},
    )
    mesh = generate(structure, ORDER)
    shift = np.array([[0.0, 0.0], [0.7, -0.2], [0.7, 0.0], [0.0, 0.0]])
    moved = structure.moved(structure.vertices + shift)
    mesh = regenerate(mesh, moved)

    def speed(t):  # the displacement of the end is blended linearly into the curve
        return np.hypot(2 * t + 1 + 0.7, 0.4 * np.pi * np.cos(np.pi * t) - 0.2)

    edge, forward = moved.topology.edge(0, 1)
    t = layout(moved, ORDER).nodes_of_edge(edge)
    points = mesh.points[t][::ORDER]
    points = points if forward else points[::-1]
    parameters = [_root(lambda s, x=x: s**2 + s + 0.7 * s - x) for x in points[[1, -2], 0]]
    assert quad(speed, 0.0, parameters[0], epsabs=1e-14)[0] == pytest.approx(1e-3, abs=1e-12)
    assert quad(speed, parameters[1], 1.0, epsabs=1e-14)[0] == pytest.approx(1e-3, abs=1e-12)


def _root(function):
    return brentq(function, -0.1, 1.1, xtol=1e-15, rtol=1e-15)


def test_errors_name_the_edge(channel):
    shrunk = channel.moved(channel.vertices * 1e-4)
    with pytest.raises(GradingError, match=r"^edge a–d: boundary layer: the first height 0\.0002 does not fit into"):
        layout(shrunk, ORDER)
    listed = channel.with_gradings({("a", "d"): Listed((0.0, 0.5, 1.0))})
    with pytest.raises(GradingError, match=r"edge a–d: the grading lists 2 elements, the edge has 36\."):
        generate(listed, ORDER)
    with pytest.raises(GradingError, match=r"edge a–d: pieces: .* are for 2 pieces and 7 elements; the curve has 1"):
        generate(channel.with_gradings({("a", "d"): Pieces((3, 4))}), ORDER)


def test_corners_on_the_kinks_of_a_polyline():
    kinks = np.array([(0, 0), (0.3, 0.2), (1.1, 0.1), (2, 0)])
    structure = BlockStructure.build(
        {"a": (0, 0), "b": (2, 0), "c": (2, 2), "d": (0, 2)},
        [("a", "b", "c", "d")],
        counts={("a", "b"): 9},
        curves={("a", "b"): Polyline(kinks)},
        gradings={("a", "b"): Pieces()},
    )
    points = corners_along(generate(structure, 3), structure, "a", "b")
    for kink in kinks:
        assert np.hypot(*(points - kink).T).min() < 1e-14
    np.testing.assert_allclose(chords(points)[:2], np.hypot(0.3, 0.2) / 2, rtol=1e-13)
