"""Isolines as curves."""

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves.curve import CuttableCurve
from hoblock.curves.level_set import LevelSet
from hoblock.curves.nearest import nearest_on_level_set
from hoblock.errors import CurveError, FieldError
from hoblock.generate import generate
from hoblock.quality import certify, element_areas

T = np.linspace(0.0, 1.0, 101)


def circle(points):
    return points[:, 0] ** 2 + points[:, 1] ** 2 - 1.0


def two_circles(points):
    x, y = points.T
    return (np.hypot(x - 1.0, y) - 0.5) * (np.hypot(x + 1.0, y) - 0.5)


def waves(points):
    """Nested waves, 0.0314 apart."""
    return np.sin(100.0 * points[:, 1] - 10.0 * np.sin(np.pi * points[:, 0]))


def polar(angle):
    return np.cos(angle), np.sin(angle)


class Counted:
    """A function that knows how often it was called."""

    def __init__(self, function):
        self.function = function
        self.calls = 0

    def __call__(self, points):
        self.calls += 1
        return self.function(points)


@pytest.mark.parametrize("opening", [1e-3, 0.3, 1.5, 2.6, 3.0])
@pytest.mark.parametrize("gradient", [None, lambda p: 2.0 * p])
def test_circle_is_found_over_its_chord_to_round_off(opening, gradient):
    first, second = polar(0.4), polar(0.4 + opening)
    curve = LevelSet(circle, first, second, gradient=gradient)
    points = curve(T)
    np.testing.assert_allclose(np.hypot(*points.T), 1.0, atol=4e-16)
    np.testing.assert_allclose(points[[0, -1]], [first, second], atol=1e-14)
    chord = np.subtract(second, first)
    np.testing.assert_allclose((points - first) @ chord / (chord @ chord), T, atol=1e-12)


def test_a_point_does_not_depend_on_the_others():
    curve = LevelSet(circle, polar(0.1), polar(1.9))
    together = curve(T)
    np.testing.assert_allclose(np.concatenate([curve(T[k : k + 1]) for k in range(len(T))]), together, atol=4e-16)
    np.testing.assert_allclose(curve(T[::-1])[::-1], together, atol=4e-16)
    assert curve(np.zeros(0)).shape == (0, 2)


def test_few_calls_of_the_function_do():
    for function, ends in ((circle, (polar(0.0), polar(1.5))), (circle, (polar(0.0), polar(2.9)))):
        counted = Counted(function)
        LevelSet(counted, *ends)(T)
        assert counted.calls <= 18


def test_levels_other_than_zero_and_a_gradient_of_the_functions_own():
    class Distance:
        used = 0

        def __call__(self, points):
            return np.hypot(points[:, 0], points[:, 1])

        def gradient(self, points):
            Distance.used += 1
            return points / np.hypot(points[:, 0], points[:, 1])[:, None]

    points = LevelSet(Distance(), (2.0, 0.0), (0.0, 2.0), level=2.0)(T)
    np.testing.assert_allclose(np.hypot(*points.T), 2.0, atol=1e-15)
    assert Distance.used > 0


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0.0), (1e7, 0.0), (1.0, 1e4), (1e-3, 10.0)])
def test_size_and_place_do_not_matter(scale, shift):
    def moved(points):
        return circle((points - shift) / scale)

    ends = nearest_on_level_set(moved, scale * np.array([polar(0.2), polar(1.4)]) + shift, reach=scale)
    points = LevelSet(moved, *ends)(T)
    rounding = np.finfo(float).eps * (1.0 + shift / scale)
    np.testing.assert_allclose(np.hypot(*((points - shift) / scale).T), 1.0, atol=20 * rounding)


@pytest.mark.parametrize("gap", [0.3, 0.02, 1e-3, 1e-4])
def test_branch_from_end_to_end_is_followed_whatever_lies_beside(gap):
    def bump(x):
        return 0.1 * np.sin(np.pi * x)

    def parallel(points):
        x, y = points.T
        return (y - bump(x)) * (y - bump(x) - gap) * (y - bump(x) + 0.4)

    points = LevelSet(parallel, (0.0, 0.0), (1.0, 0.0))(T)
    np.testing.assert_allclose(points[:, 1], bump(T), atol=1e-11)


def test_waves_among_waves():
    points = LevelSet(waves, (0.0, 0.0), (1.0, 0.0))(T)
    np.testing.assert_allclose(points[:, 1], 0.1 * np.sin(np.pi * T), atol=1e-15)


def test_steep_layers_and_high_powers():
    def layer(points):
        return np.tanh(circle(points) / 1e-3)

    def superellipse(points):
        return points[:, 0] ** 60 + points[:, 1] ** 60 - 1.0

    np.testing.assert_allclose(np.hypot(*LevelSet(layer, polar(0.0), polar(1.5))(T).T), 1.0, atol=1e-14)
    corner = 0.5 ** (1.0 / 60.0)
    points = LevelSet(superellipse, (1.0, 0.0), (corner, corner))(T)
    np.testing.assert_allclose(superellipse(points), 0.0, atol=1e-13)


def test_kinks_and_functions_of_bounded_smoothness_are_followed():
    def roof(points):
        return points[:, 1] - 0.2 + 0.4 * np.abs(points[:, 0] - 0.5)

    np.testing.assert_allclose(LevelSet(roof, (0, 0), (1, 0))(T)[:, 1], 0.2 - 0.4 * np.abs(T - 0.5), atol=1e-15)


def test_cut_keeps_to_the_isoline():
    curve = LevelSet(circle, polar(0.0), polar(1.0), reach=0.3)
    assert isinstance(curve, CuttableCurve)
    part = curve.cut(np.array(polar(0.2)), np.array(polar(1.3)))
    assert isinstance(part, LevelSet)
    assert part.reach == 0.3
    np.testing.assert_allclose(np.hypot(*part(T).T), 1.0, atol=1e-15)
    np.testing.assert_allclose(part(T)[[0, -1]], [polar(0.2), polar(1.3)], atol=1e-15)
    assert curve.cut(np.array(polar(0.2)), 1.001 * np.array(polar(1.3))) is None
    assert curve.cut(np.array(polar(0.2)), np.array(polar(0.2))) is None


def test_vertices_slide_along_an_isoline():
    structure = ring(circle, 4)
    vertices = structure.vertices.copy()
    turn = 0.2
    vertices[:4] = vertices[:4] @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    mesh = generate(structure.moved(vertices), 4)
    np.testing.assert_allclose(np.hypot(*mesh.points[mesh.edge_nodes("hole")].T), 1.0, atol=1e-14)


def test_distance_is_that_to_first_order():
    curve = LevelSet(circle, polar(0.0), polar(1.0))
    points = np.array([1.0, 1.0 + 1e-5, 1.0 - 1e-4])[:, None] * np.array(polar(0.3))
    np.testing.assert_allclose(curve.distance(points), [0.0, 1e-5, 1e-4], rtol=1e-3, atol=1e-15)


def ring(function, sectors, *, guess=1.0, size=2.5, counts=1):
    angle = 2.0 * np.pi * np.arange(sectors) / sectors + np.pi / 4.0
    rays = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inner = nearest_on_level_set(function, guess * rays)
    vertices = np.concatenate([inner, size * rays / np.abs(rays).max(axis=1, keepdims=True)])
    pairs = [(k, (k + 1) % sectors) for k in range(sectors)]
    return BlockStructure.build(
        vertices,
        [(a, sectors + a, sectors + b, b) for a, b in pairs],
        counts=counts,
        curves={(a, b): LevelSet(function, inner[a], inner[b]) for a, b in pairs},
        edges={"hole": pairs},
    )


def blob(points):
    x, y = points.T
    return np.exp(-4.0 * ((x - 0.45) ** 2 + y**2)) + np.exp(-4.0 * ((x + 0.45) ** 2 + (y - 0.1) ** 2)) - 0.5


def superellipse(points):
    return points[:, 0] ** 6 + (points[:, 1] / 0.7) ** 6 - 1.0


@pytest.mark.parametrize("order", [1, 4, 8])
@pytest.mark.parametrize(("function", "guess"), [(blob, 0.7), (superellipse, 0.9)])
def test_regions_with_such_holes_are_meshed_and_certified(function, guess, order):
    mesh = generate(ring(function, 8, guess=guess, counts=2), order)
    assert certify(mesh).valid
    np.testing.assert_allclose(function(mesh.points[mesh.edge_nodes("hole")]), 0.0, atol=1e-13)


@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_area_of_a_region_with_a_round_hole_converges(order):
    coarse, fine = (
        abs(float(element_areas(generate(ring(circle, 4, counts=count), order)).sum()) - (25.0 - np.pi))
        for count in (1, 2)
    )
    assert fine < {1: 0.4, 2: 5e-3, 3: 3e-4, 5: 1e-6}[order]
    assert np.log2(coarse / fine) > order + 0.8


def nan_inside(points):
    return np.where(np.hypot(*points.T) < 0.5, np.nan, circle(points))


def outside(points):
    raise FieldError("(9, 9) is outside the grid. Give values on a larger grid.")


def sine(points):
    return points[:, 1] - 0.8 * np.sin(np.pi * points[:, 0])


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: LevelSet(circle, (1, 0), (1, 0)), "both ends are the same point; expected two"),
        (lambda: LevelSet(circle, (1, 0, 0), (1, 0)), "first is .* expected two finite coordinates"),
        (lambda: LevelSet(circle, (1, 0), (np.inf, 0)), "second is .* expected two finite coordinates"),
        (lambda: LevelSet("x", (1, 0), (0, 1)), r"function is 'x'; expected a function of points \(n, 2\)"),
        (lambda: LevelSet(circle, (1, 0), (0, 1), gradient=3), "gradient is 3; expected a function of points"),
        (lambda: LevelSet(circle, (1, 0), (0, 1), level=np.nan), "level is nan; expected a finite number"),
        (lambda: LevelSet(circle, (1, 0), (0, 1), reach=0.0), "reach is 0.0; expected a positive fraction"),
        (
            lambda: LevelSet(circle, (1, 0), (0, 1.01)),
            r"second vertex \(0, 1\.01\) is 0\.00995 away .*\(nearest point: \(.*, 1\)\); .*project = true",
        ),
        (
            lambda: LevelSet(lambda p: np.sum(p * p, axis=1) + 7.0, (0, 0), (2, 0)),
            r"first vertex \(0, 0\) is not on the isoline, and the function's gradient vanishes there; expected a",
        ),
        (lambda: LevelSet(lambda p: 0.0 * circle(p), (1, 0), (0, 1)), "gradient vanishes at the first vertex"),
        (lambda: LevelSet(circle, (1, 0), (-1, 0)), "along the chord's normal at the first vertex .* Split the edge"),
        (lambda: LevelSet(two_circles, (-1, 0.5), (1, 0.5)), r"runs along the chord's normal at t = 0\.25, \(-0\.5, "),
        (lambda: LevelSet(sine, (0, 0), (1, 0)), r"no root at t = 0\.2149.*runs from .* within 0\.5 .* a larger reach"),
        (lambda: LevelSet(waves, (0, 0), (1, np.pi / 100)), r"arrives at \(1\.0.*, not at the second vertex; the"),
        (lambda: LevelSet(lambda p: circle(p) ** 2, (1, 0), (0, 1)), "does not change its sign .* at the first vertex"),
        (lambda: LevelSet(lambda p: circle(p) ** 3, (1, 0), (0, 1)), "jumps or its gradient vanishes .* simple root"),
        (lambda: LevelSet(lambda p: np.sign(circle(p)), (1, 0), (0, 1)), "the function jumps or its gradient"),
        (
            lambda: LevelSet(lambda p: (p[:, 1] - p[:, 0] + 0.5) * (p[:, 1] + p[:, 0] - 0.5), (0, -0.5), (1, 0.5)),
            r"ends or meets another one at t = 0\.5.* Put a vertex",
        ),
        (lambda: LevelSet(nan_inside, (1, 0), (0, 1), reach=1), r"the function is nan at \(.* Choose a smaller reach"),
        (lambda: LevelSet(lambda p: circle(p).astype(np.float32), (1, 0), (0, 1)), "returned float32 .* double"),
        (lambda: LevelSet(lambda p: p, (1, 0), (0, 1)), r"returned shape \(2, 2\) for 2 points; expected \(2,\)"),
        (
            lambda: LevelSet(circle, (1, 0), (0, 1), gradient=lambda p: p[:, 0]),
            r"gradient returned shape \(2,\) for 2 points; expected \(2, 2\)",
        ),
        (lambda: LevelSet(outside, (1, 0), (0, 1)), "outside the grid.*larger grid. Or choose a smaller reach"),
    ],
)  # fmt: skip
def test_errors(make, match):
    with pytest.raises(CurveError, match=match):
        make()(T)


def test_larger_reach_finds_what_was_out_of_reach():
    points = LevelSet(sine, (0, 0), (1, 0), reach=1.0)(T)
    np.testing.assert_allclose(points[:, 1], 0.8 * np.sin(np.pi * T), atol=1e-15)
