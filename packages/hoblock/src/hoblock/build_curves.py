"""From the curves of a scene to the geometry of block edges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hoblock.build_paths import Pair, at, edge_pairs, take
from hoblock.curves import Arc, Curve, Parametric
from hoblock.scene import ArcAbout, ArcThrough, CurveScene, Formula, MeshScene
from hoblock.topology_checks import check_ends, tolerance

Array = NDArray[np.float64]
Ends = tuple[str | int, str | int]

__all__ = ["build_curves"]


def build_curves(scene: MeshScene, sides: set[frozenset[str]]) -> dict[Ends, Curve]:
    """Curves of single edges; ``sides`` are the block edges there are."""
    places: dict[frozenset[str], str] = {}
    curves: dict[Ends, Curve] = {}
    allowed = tolerance(np.array(list(scene.vertices.values()))) if scene.curves else 0.0
    for entry in scene.curves:
        for pair in edge_pairs(entry.on, sides, entry.place):
            take(places, pair, entry.place, "curve")
            curves[pair] = _curve(entry, pair, scene.vertices, allowed)
    return curves


def _curve(entry: CurveScene, pair: Pair, vertices: Mapping[str, tuple[float, float]], allowed: float) -> Curve:
    ends = np.array([vertices[name] for name in pair])
    with at(f"{entry.place} on {pair[0]}–{pair[1]}"):
        match entry.shape:
            case ArcAbout(center):
                return Arc.from_center(center, ends[0], ends[1])
            case ArcThrough(point):
                return Arc.through(ends[0], np.array(point), ends[1])
            case Formula() as formula:
                curve = _parametric(formula)
                check_ends(curve(np.array([0.0, 1.0])), ends, pair, allowed, "curve")
                return curve


def _parametric(formula: Formula) -> Parametric:
    def points(s: Array) -> Array:
        return np.stack([formula.x.evaluate(s=s), formula.y.evaluate(s=s)], axis=-1)

    return Parametric(points)
