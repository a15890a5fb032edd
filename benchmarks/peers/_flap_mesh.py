"""Meshes of the case of flap.toml for programs with triangles: Gmsh's in the fluid, a grid in the solid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import gmsh
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LENGTH, HEIGHT = 4.0, 1.0


@dataclass(frozen=True)
class Meshes:
    """Both meshes, whose nodes on the interface are the same, from the foot on the left to that on the right.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Of the fluid, the first of them on the interface.
    triangles : ndarray, shape (m, 3)
    wet : int
        Number of nodes on the interface.
    x, y : ndarray
        Coordinates of the solid's grid of nodes.
    """

    points: Array
    triangles: NDArray[np.int64]
    wet: int
    x: Array
    y: Array


def _pairs(length: float, size: Any, least: int) -> Array:
    """Coordinates from 0 to a length, with the wanted sizes, in pairs of equal intervals."""
    s = np.linspace(0.0, length, 2001)
    density = 1.0 / size(s)
    count = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2.0 * np.diff(s))])
    pairs = max(least, round(count[-1] / 2.0))
    ends = np.interp(np.linspace(0.0, count[-1], pairs + 1), count, s)
    middles = (ends[1:] + ends[:-1]) / 2.0
    return np.sort(np.concatenate([ends, middles]))


@contextmanager
def _gmsh() -> Iterator[None]:
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        yield
    finally:
        gmsh.finalize()


def meshes(size: float, scene: Mapping[str, Any]) -> Meshes:
    """Triangles of the fluid, small at the flap, smaller at the singular corners of its end, and a grid of the solid.

    Parameters
    ----------
    size : float
        Of all elements; 1 is a mesh with 2888 nodes and five solid elements across the flap.
    scene : mapping
    """
    x0, thickness, height = (float(scene["constants"][name]) for name in ("x0", "t0", "h0"))
    corner, wall, far, slope = size * thickness / 16.0, size * thickness / 4.0, size * 0.05, size * 0.13
    x = x0 + _pairs(thickness, lambda s: np.minimum(wall, corner + slope * np.minimum(s, thickness - s)), 1)
    y = _pairs(height, lambda s: np.minimum(wall, np.minimum(corner + slope * (height - s), 2 * corner + slope * s)), 2)
    path = [(x[0], v) for v in y] + [(u, y[-1]) for u in x[1:-1]] + [(x[-1], v) for v in y[::-1]]
    with _gmsh():
        geo, mesh = gmsh.model.geo, gmsh.model.mesh
        wet = [geo.addPoint(u, v, 0) for u, v in path]
        outer = [geo.addPoint(u, v, 0) for u, v in ((LENGTH, 0), (LENGTH, HEIGHT), (0, HEIGHT), (0, 0))]
        loop = [*wet, *outer]
        lines = [geo.addLine(a, b) for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)]
        geo.addPlaneSurface([geo.addCurveLoop(lines)])
        for line in lines[: len(wet) - 1]:
            geo.mesh.setTransfiniteCurve(line, 2)
        geo.synchronize()
        fields = []
        tips = [wet[len(y) - 1], wet[len(y) + len(x) - 2]]
        for kind, tags, least in (("PointsList", tips, corner), ("PointsList", wet, wall)):
            distance = mesh.field.add("Distance")
            mesh.field.setNumbers(distance, kind, tags)
            threshold = mesh.field.add("Threshold")
            numbers = {
                "InField": distance,
                "SizeMin": least,
                "SizeMax": far,
                "DistMin": 0.0,
                "DistMax": (far - least) / slope,
            }
            for name, value in numbers.items():
                mesh.field.setNumber(threshold, name, value)
            fields.append(threshold)
        both = mesh.field.add("Min")
        mesh.field.setNumbers(both, "FieldsList", fields)
        mesh.field.setAsBackgroundMesh(both)
        for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
        gmsh.option.setNumber("Mesh.Algorithm", 6)
        mesh.generate(2)
        tags, coordinates, _ = mesh.getNodes()
        _, corners = mesh.getElementsByType(2)
    order = np.argsort(tags)  # the interface's points were made first and have the first numbers
    points = np.asarray(coordinates).reshape(-1, 3)[order, :2]
    triangles = np.searchsorted(np.asarray(tags)[order], np.asarray(corners)).reshape(-1, 3)
    assert np.allclose(points[: len(path)], path)
    return Meshes(points, triangles.astype(np.int64), len(path), x, y)
