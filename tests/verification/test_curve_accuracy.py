"""Regions bounded by curves of every kind: area and perimeter against exact values, for every order."""

from __future__ import annotations

import importlib
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipeinc

from hoblock.curves import Arc, BSpline, Ellipse, Polyline, Spline
from hoblock.fit import fit_errors
from hoblock.generate import generate
from hoblock.quality import element_areas

pytestmark = pytest.mark.verification

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
COUNTS = (16, 32, 64, 128)
FLOOR, RESOLVED, ROUND_OFF = 1e-13, 1e-12, 1e-15
SMOOTH = (
    "arc",
    "bezier, degree 9",
    "ellipse",
    "ellipse by arc length",
    "lagrange, degree 9",
    "level set",
    "level set by arc length",
    "parametric",
    "parametric, displaced",
    "rational bezier, degree 4",
)
PIECEWISE = ("nurbs by arc length", "nurbs, degree 3", "part of a nurbs", "spline by arc length")
POLYNOMIAL = ("b-spline, degree 3", "spline")


@pytest.fixture(scope="module")
def accuracy() -> Iterator[Any]:
    """The benchmark of the same name, whose regions and references are used."""
    before = set(sys.modules)
    sys.path.insert(0, str(FOLDER))
    yield importlib.import_module("curve_accuracy")
    sys.path.remove(str(FOLDER))
    for name in {"_result", "curve_accuracy"} - before:
        sys.modules.pop(name, None)


def errors(accuracy: Any, kind: str, order: int) -> dict[str, list[float]]:
    curve = accuracy.KINDS[kind]()
    pieces, reference = len(accuracy.breaks(curve)) - 1, accuracy.exact(curve)
    found = [accuracy.errors(curve, order, n // pieces * pieces, reference) for n in COUNTS]
    return {name: [getattr(one, name) for one in found] for name in ("area", "perimeter", "distance")}


def last_order(found: list[float]) -> float:
    """Of the last step of refinement that starts well above round-off; infinite if there is none."""
    last = max((k for k, error in enumerate(found[:-1]) if error > RESOLVED), default=None)
    return math.inf if last is None else math.log2(found[last] / max(found[last + 1], ROUND_OFF))


def test_every_kind_is_verified(accuracy: Any) -> None:
    assert {*SMOOTH, *PIECEWISE, *POLYNOMIAL, "polyline"} == set(accuracy.KINDS)


def test_references_agree_with_formulas(accuracy: Any) -> None:
    arc = Arc((0.3, 0.1), 0.7, 0.9 * math.pi, -0.8 * math.pi)
    area, length = accuracy.exact(arc)
    (x0, y0), (x1, y1) = arc(np.array([0.0, 1.0]))
    segment = 0.5 * arc.radius**2 * (0.8 * math.pi - math.sin(0.8 * math.pi))
    assert length == pytest.approx(0.56 * math.pi, rel=4e-15)
    assert area == pytest.approx(segment + (x1 - x0) * (1.0 + 0.5 * (y0 + y1)), rel=4e-15)
    half = Ellipse((0.0, 0.0), (1.5, 0.5), 0.0, math.pi, -math.pi)
    area, length = accuracy.exact(half)
    assert area == pytest.approx(3.0 + 0.375 * math.pi, rel=4e-15)
    assert length == pytest.approx(1.5 * ellipeinc(math.pi, 1.0 - (0.5 / 1.5) ** 2), rel=4e-15)


@pytest.mark.parametrize("order", range(1, 9))
@pytest.mark.parametrize("kind", [*SMOOTH, *PIECEWISE, *POLYNOMIAL])
def test_area_and_perimeter_converge_to_round_off(accuracy: Any, kind: str, order: int) -> None:
    found = errors(accuracy, kind, order)
    for name in ("area", "perimeter"):
        assert last_order(found[name]) >= order + 0.9, (name, found[name])
        assert order < 4 or min(found[name]) <= FLOOR, (name, found[name])
    assert last_order(found["distance"]) >= 0.75 * (order + 1), found["distance"]


@pytest.mark.parametrize("order", range(1, 9))
@pytest.mark.parametrize("kind", POLYNOMIAL)
def test_cubics_are_exact_from_order_3(accuracy: Any, kind: str, order: int) -> None:
    found = errors(accuracy, kind, order)
    for name in ("area", "perimeter", "distance"):
        assert (max(found[name]) < 1e-14) == (order >= 3), (name, found[name])


@pytest.mark.parametrize("order", range(1, 9))
def test_polylines_are_exact_with_corners_on_their_kinks(accuracy: Any, order: int) -> None:
    found = errors(accuracy, "polyline", order)
    for values in found.values():
        assert max(values) < 1e-14, found


@pytest.mark.parametrize("curve", [Polyline, Spline, BSpline])
def test_corners_off_the_breaks_cost_the_order(accuracy: Any, curve: Any) -> None:
    """What `Pieces` is for: the same curves with equal elements."""
    places = curve(accuracy.POINTS[[0, 1, 4, 6, 9]])
    structure = accuracy.below(places, 32)
    uneven = type(structure).build(
        dict(zip("abcd", structure.vertices[[structure.topology.vertex(n) for n in "abcd"]], strict=True)),
        [("d", "c", "b", "a")],
        counts={("a", "b"): 33},
        curves={("a", "b"): places},
    )
    area, _ = accuracy.exact(places)
    meshes = [generate(one, 5, check=False) for one in (structure, uneven)]
    on, off = (abs(float(element_areas(mesh).sum()) / area - 1.0) for mesh in meshes)
    assert on < 1e-14 < 1e-11 < off
    assert max(fit_errors(uneven, 5).values()) > 1e-8
