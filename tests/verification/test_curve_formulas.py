"""Regions between a curve and its image turned by 180°: area and perimeter against formulas not the library's own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import BPoly, CubicSpline
from scipy.interpolate import BSpline as ScipyBSpline

from hoblock.blocks import BlockStructure
from hoblock.curves import (
    Affine,
    Arc,
    ArcLength,
    Bezier,
    BSpline,
    Curve,
    Displaced,
    Ellipse,
    LagrangeEdge,
    Nurbs,
    Parametric,
    Piece,
    Spline,
    transformed,
)
from hoblock.curves.curve import breaks_of
from hoblock.generate import generate
from hoblock.grading import Pieces
from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.quality import element_areas
from hoblock.reference import gauss_legendre, gauss_lobatto, lagrange_derivative

pytestmark = pytest.mark.verification

Array = NDArray[np.float64]
Formula = Callable[[Array], tuple[Array, Array]]
"""Points and derivatives by the parameter, each (n, 2), at parameters (n,)."""

FLOOR, RESOLVED = 1e-13, 1e-2
ASYMPTOTIC = 5  # beyond, errors are at round-off before their slope has settled, and a bound of that slope is left
HEIGHT = 0.75  # distance between the two chords of a region, over their length
POINTS = np.array([(0.0, 0.0), (0.45, -0.25), (1.0, -0.2), (1.55, -0.35), (2.0, 0.0)])
WEIGHTS = np.array([1.0, 2.0, 0.7, 1.5, 1.0])
KNOTS = np.array([0.0, 0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0, 1.0])
CIRCLE = Ellipse((1.0, 0.5), (1.5, 1.5), 0.0, 3.8, 1.8)
ELLIPSE = Ellipse((1.0, 0.0), (1.3, 0.6), 0.2, 3.5, 2.2)
SHEAR, OFFSET = np.array([[1.0, 0.3], [0.2, 1.1]]), np.array([0.5, -1.0])
SHIFT = np.array([0.2, -0.1])


@dataclass(frozen=True)
class Case:
    """A curve, what it is by formula, and the formula's parameters where that is not smooth."""

    curve: Curve
    formula: Formula
    breaks: Sequence[float] | Array = ()

    def area_and_length(self) -> tuple[float, float]:
        """Area between the curve and its chord, to the right of the latter, and length: composite Gauss quadrature."""
        x, w = gauss_legendre(24)
        ends = [np.linspace(a, b, 49)[:-1] for a, b in pairwise([0.0, *self.breaks, 1.0])]
        bounds = np.append(np.concatenate(ends), 1.0)
        half = 0.5 * np.diff(bounds)[:, None]
        points, tangents = self.formula((bounds[:-1, None] + half * (1.0 + x)).ravel())
        weights, offsets = (half * w).ravel(), points - self.formula(np.zeros(1))[0]
        cross = offsets[:, 0] * tangents[:, 1] - offsets[:, 1] * tangents[:, 0]
        return 0.5 * float(weights @ cross), float(weights @ np.hypot(*tangents.T))


def elliptic(ellipse: Ellipse) -> Formula:
    """The affine image of a circle."""
    (a, b), angle = ellipse.radii, ellipse.rotation
    axes = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) * [a, b]

    def formula(t: Array) -> tuple[Array, Array]:
        theta = ellipse.start + ellipse.opening * t
        c, s = np.cos(theta), np.sin(theta)
        slopes = ellipse.opening * np.stack([-s, c], axis=-1)
        return np.stack([c, s], axis=-1) @ axes.T + ellipse.center, slopes @ axes.T

    return formula


def sheared(t: Array) -> tuple[Array, Array]:
    points, tangents = elliptic(ELLIPSE)(t)
    return points @ SHEAR.T + OFFSET, tangents @ SHEAR.T


def wave(t: Array) -> tuple[Array, Array]:
    f, df = np.exp(-2.0 * t) * np.sin(np.pi * t), np.pi * np.exp(-2.0 * t) * np.cos(np.pi * t)
    points = np.stack([2.0 * t, -f], axis=-1)
    return points, np.stack([np.full_like(t, 2.0), 2.0 * f - df], axis=-1)


def displaced(t: Array) -> tuple[Array, Array]:
    points, tangents = wave(t)
    return points + t[:, None] * SHIFT, tangents + SHIFT


def part(t: Array) -> tuple[Array, Array]:
    points, tangents = wave(0.1 + 0.6 * t)
    return points, 0.6 * tangents


def polynomial(t: Array) -> tuple[Array, Array]:
    fits = [Polynomial.fit(np.linspace(0.0, 1.0, len(POINTS)), values, len(POINTS) - 1) for values in POINTS.T]
    return np.stack([f(t) for f in fits], axis=-1), np.stack([f.deriv()(t) for f in fits], axis=-1)


def of(spline: BPoly | CubicSpline | ScipyBSpline) -> Formula:
    slope = spline.derivative()
    return lambda t: (np.asarray(spline(t)), np.asarray(slope(t)))


def quotient(spline: BPoly | ScipyBSpline) -> Formula:
    """A curve (n, 3) over its last component."""

    def formula(t: Array) -> tuple[Array, Array]:
        values, slopes = of(spline)(t)
        points = values[:, :2] / values[:, 2:]
        return points, (slopes[:, :2] - points * slopes[:, 2:]) / values[:, 2:]

    return formula


def cases() -> dict[str, Case]:
    homogeneous = np.concatenate([WEIGHTS[:, None] * POINTS, WEIGHTS[:, None]], axis=1)
    bernstein, rational = (BPoly(values[:, None, :], [0.0, 1.0]) for values in (POINTS, homogeneous))
    b_spline, nurbs = (ScipyBSpline(KNOTS, values, 3) for values in (POINTS, homogeneous))
    chords = np.cumsum([0.0, *np.hypot(*np.diff(POINTS, axis=0).T)])
    spline = CubicSpline(chords / chords[-1], POINTS)
    natural = CubicSpline(np.linspace(0.0, 1.0, len(POINTS)), POINTS, bc_type="natural")
    waving, weighted = Parametric(lambda t: wave(t)[0]), Nurbs(POINTS, WEIGHTS, 3, KNOTS)
    return {
        "arc": Case(Arc(CIRCLE.center, CIRCLE.radii[0], CIRCLE.start, CIRCLE.opening), elliptic(CIRCLE)),
        "ellipse": Case(ELLIPSE, elliptic(ELLIPSE)),
        "ellipse by arc length": Case(ArcLength(ELLIPSE), elliptic(ELLIPSE)),
        "sheared ellipse": Case(Affine(ELLIPSE, SHEAR, OFFSET), sheared),
        "parametric": Case(waving, wave),
        "parametric by arc length": Case(ArcLength(waving), wave),
        "displaced": Case(Displaced(waving, (0.0, 0.0), (0.2, -0.1)), displaced),
        "piece": Case(Piece(waving, 0.1, 0.7), part),
        "Lagrange": Case(LagrangeEdge(POINTS), polynomial),
        "Bézier": Case(Bezier(POINTS), of(bernstein)),
        "rational Bézier": Case(Bezier(POINTS, WEIGHTS), quotient(rational)),
        "spline": Case(Spline(POINTS), of(spline), spline.x[1:-1]),
        "natural spline": Case(Spline(POINTS, "natural", parameter="uniform"), of(natural), natural.x[1:-1]),
        "B-spline": Case(BSpline(POINTS, 3, KNOTS), of(b_spline), KNOTS[4:5]),
        "NURBS": Case(weighted, quotient(nurbs), KNOTS[4:5]),
        "NURBS by arc length": Case(ArcLength(weighted), quotient(nurbs), KNOTS[4:5]),
    }


CASES = cases()


def region(curve: Curve, count: int) -> BlockStructure:
    """One block with ``count`` elements along the curves, corners on their breaks, and one across."""
    a, b = curve(np.array([0.0, 1.0]))
    across = HEIGHT * np.array([a[1] - b[1], b[0] - a[0]])
    return BlockStructure.build(
        np.array([a, b, b + across, a + across]),
        [(0, 1, 2, 3)],
        counts={(0, 1): count, (1, 2): 1},
        curves={(0, 1): curve, (2, 3): transformed(curve, -np.eye(2), a + b + across)},
        gradings={(0, 1): Pieces(), (2, 3): Pieces()} if breaks_of(curve).size else {},
        edges={"curved": [(0, 1), (2, 3)]},
    )


def perimeter(mesh: QuadMesh) -> float:
    sides = mesh.edge_groups["curved"]
    nodes = mesh.points[mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]]]
    x, w = gauss_legendre(4 * mesh.order + 8)
    tangents = lagrange_derivative(gauss_lobatto(mesh.order), x) @ nodes
    return float((np.hypot(tangents[..., 0], tangents[..., 1]) @ w).sum())


def errors(case: Case, order: int, counts: Sequence[int]) -> Array:
    """Relative errors of area and perimeter for growing numbers of elements, until both are round-off, (k, 2)."""
    bulge, length = case.area_and_length()
    chord = np.hypot(*np.diff(case.curve(np.array([0.0, 1.0])), axis=0)[0])
    area = HEIGHT * chord**2 + 2.0 * bulge
    found: list[tuple[float, float]] = []
    for count in counts:
        mesh = generate(region(case.curve, count), order, check=count <= 64)
        found.append((abs(element_areas(mesh).sum() / area - 1.0), abs(perimeter(mesh) / (2.0 * length) - 1.0)))
        if max(found[-1]) <= FLOOR:
            break
    return np.array(found)


def observed_order(found: Array) -> float:
    """Slope by least squares over all errors that are resolved and above round-off; infinite if there are no two."""
    k = np.flatnonzero((found > FLOOR) & (found < RESOLVED))
    return float(-np.polyfit(k, np.log2(found[k]), 1)[0]) if len(k) > 1 else np.inf


@pytest.mark.parametrize("order", range(1, 9))
@pytest.mark.parametrize("name", CASES)
def test_errors_fall_at_the_order_of_the_elements_down_to_round_off(name: str, order: int) -> None:
    case = CASES[name]
    pieces = len(breaks_of(case.curve)) + 1
    found = errors(case, order, [pieces * 2**k for k in range(13)])
    power = 2.0 ** (-(order + 1) * np.arange(len(found)))[:, None]
    constant = (found / power)[:3].max(axis=0)  # one mesh may be lucky, three are not
    assert (found <= np.maximum(1.5 * constant * power, FLOOR)).all(), found
    if order <= ASYMPTOTIC:
        assert min(map(observed_order, found.T)) >= order + 0.9, found
    assert found[-1].max() <= (FLOOR if order > 1 else 1e-6), found


@pytest.mark.parametrize(("name", "ellipse"), [("arc", CIRCLE), ("ellipse", ELLIPSE)])
def test_the_quadrature_of_formulas_agrees_with_known_areas(name: str, ellipse: Ellipse) -> None:
    area, length = CASES[name].area_and_length()
    a, b = ellipse.radii
    assert area == pytest.approx(0.5 * a * b * (ellipse.opening - np.sin(ellipse.opening)), rel=1e-14)
    if a == b:
        assert length == pytest.approx(a * ellipse.opening, rel=1e-14)
