"""Regions bounded by curves of every kind: errors of area, perimeter and distance from the curve, and their orders.

Errors are those with the fewest elements, orders those of the last refinement before round-off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from _result import Result, parser, report
from hoblock import BlockStructure, generate
from hoblock.curves import (
    Arc,
    ArcLength,
    Bezier,
    BSpline,
    Curve,
    Displaced,
    Ellipse,
    LagrangeEdge,
    LevelSet,
    Nurbs,
    Parametric,
    PiecewiseCurve,
    Polyline,
    Spline,
    nearest_on_level_set,
    piece,
)
from hoblock.fit import fit_errors
from hoblock.grading import Pieces
from hoblock.layout import layout
from hoblock.quality import element_areas
from hoblock.reference import differentiation_matrix, gauss_legendre, gauss_lobatto, lagrange, lagrange_derivative

PANELS, ORDER = 24, 20  # of the quadrature along the exact curve: between its breaks
ROUND_OFF = 1e-14
HEIGHTS = np.array([0.0, 0.13, 0.21, 0.16, 0.24, 0.31, 0.19, 0.12, 0.05, 0.0])
POINTS = np.stack([np.linspace(0.0, 1.0, 10), HEIGHTS], axis=-1)
FIVE = POINTS[[0, 2, 5, 7, 9]]
SIX = POINTS[[0, 1, 3, 5, 7, 8, 9]]


def wave(t: np.ndarray) -> np.ndarray:
    return np.stack([t + 0.05 * np.sin(2.0 * np.pi * t), 0.3 * np.sin(np.pi * t) * np.exp(t)], axis=-1)


def superellipse(points: np.ndarray) -> np.ndarray:
    return (points[:, 0] - 0.5) ** 4 * 16.0 + (points[:, 1] + 0.2) ** 4 * 20.0 - 1.0


def level_set() -> LevelSet:
    first, second = nearest_on_level_set(superellipse, [(0.1, 0.15), (0.85, 0.2)])
    return LevelSet(superellipse, first, second)


NURBS = Nurbs(SIX, [1.0, 2.0, 0.7, 1.5, 1.0, 0.8, 1.0], 3)
ELLIPSE = Ellipse((0.5, -0.1), (0.6, 0.3), 0.2, 0.9 * np.pi, -0.8 * np.pi)
KINDS: dict[str, Callable[[], Curve]] = {
    "arc": lambda: Arc.with_angle((0.0, 0.0), (1.0, 0.0), -2.5),
    "ellipse": lambda: ELLIPSE,
    "ellipse by arc length": lambda: ArcLength(ELLIPSE),
    "lagrange, degree 9": lambda: LagrangeEdge(POINTS, "gll"),
    "bezier, degree 9": lambda: Bezier(POINTS),
    "rational bezier, degree 4": lambda: Bezier(FIVE, [1.0, 2.0, 0.6, 1.5, 1.0]),
    "spline": lambda: Spline(FIVE),
    "spline by arc length": lambda: ArcLength(Spline(FIVE)),
    "b-spline, degree 3": lambda: BSpline(SIX),
    "nurbs, degree 3": lambda: NURBS,
    "nurbs by arc length": lambda: ArcLength(NURBS),
    "part of a nurbs": lambda: piece(NURBS, 0.1, 0.9),
    "parametric": lambda: Parametric(wave),
    "parametric, displaced": lambda: Displaced(Parametric(wave), (-0.1, 0.0), (0.1, -0.1)),
    "level set": level_set,
    "level set by arc length": lambda: ArcLength(level_set()),
    "polyline": lambda: Polyline(FIVE),
}


@dataclass(frozen=True)
class Errors:
    """Relative errors of a mesh of the region below a curve, and the largest distance from it."""

    area: float
    perimeter: float
    distance: float


def breaks(curve: Curve) -> np.ndarray:
    return np.array([0.0, *(curve.breaks if isinstance(curve, PiecewiseCurve) else ()), 1.0])


def below(curve: Curve, elements: int) -> BlockStructure:
    """One block: the curve above, straight sides otherwise; element corners on the curve's breaks."""
    (x0, y0), (x1, y1) = curve(np.array([0.0, 1.0]))
    vertices = {"a": (x0, y0), "b": (x1, y1), "c": (x1, -1.0), "d": (x0, -1.0)}
    pieces = len(breaks(curve)) - 1
    grading = {("a", "b"): Pieces((elements // pieces,) * pieces)} if pieces > 1 else {}
    return BlockStructure.build(
        vertices,
        [("d", "c", "b", "a")],
        counts={("a", "b"): elements // pieces * pieces},
        curves={("a", "b"): curve},
        gradings=grading,
    )


def exact(curve: Curve) -> tuple[float, float]:
    """Area below the curve by Green's theorem, and its length: Gauss quadrature of polynomials through its points."""
    ends = np.concatenate([np.linspace(a, b, PANELS, endpoint=False) for a, b in pairwise(breaks(curve))])
    ends = np.append(ends, 1.0)
    nodes, (gauss, weights) = gauss_lobatto(ORDER), gauss_legendre(ORDER + 1)
    t = ends[:-1, None] + 0.5 * np.diff(ends)[:, None] * (1.0 + nodes)
    points = np.asarray(curve(t.ravel())).reshape(*t.shape, 2)
    D = lagrange(nodes, gauss) @ differentiation_matrix(nodes)
    values, slopes = lagrange(nodes, gauss) @ points, D @ (points - points[:, :1])
    area = float(np.sum(((values[..., 1] + 1.0) * slopes[..., 0]) @ weights))  # above y = -1
    return area, float(np.sum(np.hypot(slopes[..., 0], slopes[..., 1]) @ weights))


def errors(curve: Curve, order: int, elements: int, reference: tuple[float, float]) -> Errors:
    structure = below(curve, elements)
    mesh = generate(structure, order, check=False)
    (edge,) = structure.curves
    nodes = layout(structure, order).nodes_of_edge(edge)
    sides = mesh.points[nodes[np.arange((len(nodes) - 1) // order)[:, None] * order + np.arange(order + 1)]]
    x, w = gauss_legendre(2 * order + 16)
    tangents = lagrange_derivative(gauss_lobatto(order), x) @ (sides - sides[:, :1])
    length = float(np.sum(np.hypot(tangents[..., 0], tangents[..., 1]) @ w))
    area = float(element_areas(mesh).sum())
    distance = fit_errors(structure, order, mesh)[edge]
    return Errors(abs(area / reference[0] - 1.0), abs(length / reference[1] - 1.0), distance)


def observed_order(counts: Sequence[int], found: Sequence[float]) -> float | str:
    """Between the last two numbers of elements with errors above round-off, if there are two."""
    last = next((k for k, error in enumerate(found) if error <= ROUND_OFF), len(found)) - 1
    if last < 1:
        return "round-off"
    return float(np.log(found[last - 1] / found[last]) / np.log(counts[last] / counts[last - 1]))


def rows_of(kind: str, orders: Sequence[int], elements: Sequence[int]) -> list[dict[str, object]]:
    curve = KINDS[kind]()
    pieces = len(breaks(curve)) - 1
    counts = [max(1, n // pieces) * pieces for n in elements]
    reference, rows = exact(curve), []
    for order in orders:
        found = [errors(curve, order, n, reference) for n in counts]
        row: dict[str, object] = {"curve": kind, "order": order, "elements": "/".join(map(str, counts))}
        for name in ("area", "perimeter", "distance"):
            values = [getattr(one, name) for one in found]
            row |= {name: values[0], f"{name} order": observed_order(counts, values)}
        rows.append(row)
    return rows


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--orders", type=int, nargs="+", default=list(range(1, 9)))
    options.add_argument("--elements", type=int, nargs="+", default=[8, 16, 32], help="along the curve, ascending")
    options.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS), metavar="KIND")
    chosen = options.parse_args(argv)
    rows = [row for kind in chosen.kinds for row in rows_of(kind, chosen.orders, chosen.elements)]
    settings = {"orders": chosen.orders, "elements": chosen.elements}
    return report(Result("curve_accuracy", settings, rows), chosen.json)


if __name__ == "__main__":
    main()
