"""Benchmark of mesh generation: area and boundary of a channel with a cylinder, and the time beside a copy's."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from hoblock.building import build_structure
from hoblock.generate import generate, raise_if_invalid, regenerate
from hoblock.mesh import QuadMesh
from hoblock.quality import det_jacobian
from hoblock.reference import gauss_legendre
from hofsi.bench.benchmark import Measured
from hofsi.bench.checks import Check, Limit, judged
from hofsi.bench.scene_benchmark import SCENES
from hofsi.io.scene import load_case

__all__ = ["MeshGeneration"]

_AREA = 2.2 * 0.41 - math.pi * 0.05**2  # of the channel of DFG 2D-1
_NODES = {False: 200_000, True: 50_000}
_ORDER = 6
_EXACT = "2.2 · 0.41 - π 0.05², the circle a polynomial of order 6 on each element"
_CHECKS = (
    Check("area", _AREA, 0.0, 1e-11, _EXACT),
    Limit("regenerated beside generated", "a mesh is a function of its block structure", at_most=1e-13),
    Limit("regeneration / copy of the nodes", "a mesh is made anew in every step", at_most=60.0),
    Limit("generation / copy of the nodes", "it includes the map of every block", at_most=400.0),
)


@dataclass(frozen=True)
class MeshGeneration:
    """The blocks of DFG 2D-1 meshed with order 6; see `hofsi.bench.benchmark.Benchmark`."""

    name: str = "mesh-generation"
    title: str = "a channel with a cylinder meshed with elements of order 6, generated and regenerated"

    def measure(self, folder: Path, *, quick: bool) -> Measured:
        """Generate, move and regenerate."""
        began = perf_counter()
        # All counts are multiples of one number: 48 k² elements of 36 nodes each.
        k = max(1, round(math.sqrt(_NODES[quick] / (48 * _ORDER**2))))
        counts = [f"mesh.count[{i}].elements={n * k}" for i, n in enumerate((1, 2, 6, 2))]
        structure = build_structure(load_case(SCENES / "dfg_2d_1.toml", counts).mesh)
        mesh = generate(structure, _ORDER, check=False)
        again = structure.moved(structure.vertices)
        buffer = np.empty_like(mesh.points)
        copied = _fastest(lambda: np.copyto(buffer, mesh.points))
        generated = _fastest(lambda: generate(again, _ORDER, check=False))
        regenerated = _fastest(lambda: regenerate(mesh, again, out=buffer))
        certified = _fastest(lambda: raise_if_invalid(mesh, structure), 1)
        values: dict[str, float | None] = {
            "area": area(mesh),
            "regenerated beside generated": float(np.abs(buffer - mesh.points).max()),
            "regeneration / copy of the nodes": regenerated / copied,
            "generation / copy of the nodes": generated / copied,
        }
        seconds = {"generate": generated, "regenerate": regenerated, "certify": certified}
        return Measured(
            judged(_CHECKS, values),
            f"{len(mesh.cells)} elements of order {_ORDER}, {len(mesh.points)} nodes",
            {"order": _ORDER, "elements": len(mesh.cells), "nodes": len(mesh.points)},
            {**seconds, "total": perf_counter() - began},
            {"million nodes a second": 1e-6 * len(mesh.points) / regenerated},
        )


def area(mesh: QuadMesh) -> float:
    """The integral of det J, exact for the polynomials that it consists of."""
    points, weights = gauss_legendre(mesh.order + 1)
    xi, eta = (part.ravel() for part in np.meshgrid(points, points))
    return float((det_jacobian(mesh, np.stack([xi, eta], axis=1)) @ np.outer(weights, weights).ravel()).sum())


def _fastest(call: Callable[[], object], repeats: int = 5) -> float:
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return min(times)
