"""Distances of meshes from the curves of their edges, against exact ones."""

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import (
    Affine,
    Arc,
    ArcLength,
    Between,
    Bezier,
    BSpline,
    Displaced,
    Ellipse,
    LagrangeEdge,
    LevelSet,
    NodalCurve,
    Nurbs,
    Parametric,
    Piece,
    Polyline,
    Reversed,
    Spline,
)
from hoblock.errors import CurveError
from hoblock.fit import distances_along, fit_errors
from hoblock.generate import generate
from hoblock.grading import BoundaryLayer, Exponential, Pieces

QUARTER = Arc((0.0, 0.0), 1.0, 0.75 * np.pi, -0.5 * np.pi)  # over the top, from left to right
ENDS = QUARTER(np.array([0.0, 1.0]))
HALF = np.sqrt(0.5)
POINTS = np.array([(0.0, 0.0), (0.2, 0.15), (0.5, 0.1), (0.8, 0.2), (1.0, 0.0)])


def below(curve, count, **options):
    """A block whose upper edge is the curve."""
    first, second = curve(np.array([0.0, 1.0]))
    vertices = {"a": first, "b": second, "c": (second[0], -2.0), "d": (first[0], -2.0)}
    return BlockStructure.build(vertices, [("d", "c", "b", "a")], counts=count, curves={("a", "b"): curve}, **options)


def error(curve, count, order, grading=None):
    gradings = {} if grading is None else {("a", "b"): grading}
    (found,) = fit_errors(below(curve, count, gradings=gradings), order).values()
    return found


def parabola(t):
    return np.stack([t, t * (1.0 - t)], axis=-1)


def test_a_chord_is_its_sagitta_away():
    assert error(Parametric(parabola), 1, 1) == pytest.approx(0.25, rel=1e-13)
    for count in (1, 2, 5, 40):
        assert error(QUARTER, count, 1) == pytest.approx(1.0 - np.cos(np.pi / 4.0 / count), rel=1e-12)


@pytest.mark.parametrize(
    "curve",
    [
        ArcLength(QUARTER),
        Reversed(Arc((0.0, 0.0), 1.0, 0.25 * np.pi, 0.5 * np.pi)),
        Piece(Arc((0.0, 0.0), 1.0, np.pi, -np.pi), 0.25, 0.75),
        Displaced(QUARTER, (0.3, 0.1), (0.3, 0.1)),
        Affine(Arc((0.0, 0.0), 2.0, -0.75 * np.pi, 0.5 * np.pi), np.diag([0.5, -0.5]), np.array([0.1, 0.0])),
        Between(QUARTER, QUARTER, 0.4, tuple(map(tuple, ENDS))),
        Ellipse((0.0, 0.0), (1.0, 1.0), 0.3, 0.75 * np.pi - 0.3, -0.5 * np.pi),
        Nurbs([(-HALF, HALF), (0.0, 2.0 * HALF), (HALF, HALF)], [1.0, HALF, 1.0], 2),
        LevelSet(lambda x: np.hypot(x[:, 0], x[:, 1]) - 1.0, *ENDS),
        Reversed(LevelSet(lambda x: np.hypot(x[:, 0], x[:, 1]) - 1.0, *ENDS[::-1])),
        Bezier([(-HALF, HALF), (0.0, 2.0 * HALF), (HALF, HALF)], [1.0, HALF, 1.0]),
    ],
    ids=lambda curve: type(curve).__name__,
)
def test_a_quarter_circle_of_every_kind_is_as_far(curve):
    assert error(curve, 1, 1) == pytest.approx(1.0 - HALF, rel=1e-7)


def test_distances_are_normal_to_the_curve():
    """The nodes of a curve whose parameter runs unevenly are shifted along it, which is no error of the geometry."""

    def uneven(t):
        s = t + 0.15 * np.sin(2.0 * np.pi * t)
        return np.stack([s, 0.5 * s], axis=-1)

    assert error(Parametric(uneven), 2, 2) < 1e-15


def test_kinks_are_errors_unless_corners_lie_on_them():
    tent = Polyline([(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)])
    assert error(tent, 1, 1) == pytest.approx(0.5 / np.sqrt(1.25), rel=1e-12)
    lopsided = Polyline(POINTS)
    assert error(lopsided, 5, 3) > 1e-3
    assert error(lopsided, 5, 3, Pieces()) < 1e-15


@pytest.mark.parametrize("order", [1, 2, 3, 4, 6])
@pytest.mark.parametrize(
    "curve",
    [
        QUARTER,
        ArcLength(Ellipse((0.0, 0.0), (1.0, 0.6), 0.2, 0.8 * np.pi, -0.6 * np.pi)),
        LevelSet(lambda x: x[:, 0] ** 4 + x[:, 1] ** 2 - 1.0, (-0.8, np.sqrt(1 - 0.8**4)), (0.7, np.sqrt(1 - 0.7**4))),
        Bezier(POINTS, [1, 2, 1, 2, 1]),
    ],
    ids=["arc", "ellipse", "level set", "bezier"],
)
def test_errors_of_smooth_curves_fall_with_the_order(curve, order):
    coarse, fine = (error(curve, count, order) for count in (24, 48))
    assert fine < 1e-15 or np.log2(coarse / fine) > order + 0.5


@pytest.mark.parametrize("curve", [Spline(POINTS), BSpline(POINTS), LagrangeEdge(POINTS, "gll")])
def test_polynomials_are_met_exactly(curve):
    assert error(curve, 8, 4, Pieces()) < 1e-15


@pytest.mark.parametrize("grading", [Exponential(2.0), BoundaryLayer(0.01)])
def test_nodes_of_a_simulation(grading):
    curve = NodalCurve(QUARTER(np.linspace(0.0, 1.0, 7)), 2)
    assert error(curve, 3, 2, grading) == 0.0
    assert error(curve, 3, 4, grading) < 1e-15
    assert error(curve, 3, 1, grading) == pytest.approx(1.0 - np.cos(np.pi / 12.0), rel=1e-4)


def test_every_curved_edge_is_measured_with_the_mesh_that_is_there(layouts):
    structure = layouts.annulus(sectors=5, counts=2)
    mesh = generate(structure, 3)
    errors = fit_errors(structure, 3, mesh)
    assert errors == fit_errors(structure, 3)
    assert list(errors) == sorted(structure.curves)
    assert len(errors) == 10
    assert min(errors.values()) > 0.0
    assert max(errors.values()) == pytest.approx(2.0 * min(errors.values()), rel=1e-6)
    assert fit_errors(layouts.square(), 2) == {}


def test_distances_of_any_points(rng):
    angle = rng.uniform(0.3 * np.pi, 0.7 * np.pi, 50)
    radius = rng.uniform(0.8, 1.2, 50)
    points = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    t = (0.75 * np.pi - angle) / (0.5 * np.pi)
    guesses = np.clip(t + rng.uniform(-0.1, 0.1, 50), 0.0, 1.0)
    found = distances_along(QUARTER, points, guesses, np.full(50, 0.2))
    np.testing.assert_allclose(found, np.abs(radius - 1.0), atol=1e-9)


def test_another_mesh_is_refused(layouts):
    structure = layouts.annulus(counts=2)
    with pytest.raises(ValueError, match="the mesh has order 2 and 80 nodes; expected order 3 and 168 nodes"):
        fit_errors(structure, 3, generate(structure, 2))


def test_a_curve_that_fails_is_named():
    structure = below(QUARTER, 2)
    mesh = generate(structure, 3)

    def broken(t):
        return np.where((t > 0.3)[:, None] & (t < 0.4)[:, None], np.nan, QUARTER(t))

    with pytest.raises(CurveError, match=r"edge a–b: parametric curve: not finite at t = 0\.3"):
        fit_errors(structure.moved(structure.vertices, {next(iter(structure.curves)): Parametric(broken)}), 3, mesh)
