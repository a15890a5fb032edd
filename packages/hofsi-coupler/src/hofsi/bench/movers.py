"""Benchmark of the movers: the flag of Turek and Hron bent to and fro, its mesh made anew each time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from hoblock.quality import scaled_jacobian
from hofsi.bench.benchmark import Measured
from hofsi.bench.checks import Limit, judged
from hofsi.bench.scene_benchmark import SCENES
from hofsi.build import build
from hofsi.errors import MeshMotionError
from hofsi.io.scene import load_case
from hofsi.motion import MeshMotion

Array = NDArray[np.float64]

__all__ = ["Movers", "bent"]

_MOVERS = {
    "barrier": 'mover={type="barrier"}',
    "pseudo-solid": 'mover={type="pseudo-solid"}',
    "angles": 'mover={type="angle-optimisation"}',
}
_CLAMP, _LENGTH = 0.2489898, 0.3510102
_LARGEST = 0.09  # m: somewhat more than the flag of FSI2 swings
_STATELESS = ("barrier", "pseudo-solid")
_WAY_BACK = "the mesh depends on the flag's position alone"
_CHECKS = (
    *(
        Limit(f"worst scaled Jacobian, {name}", "of a flag that is bent by 90 mm", at_least=worst)
        for name, worst in (("barrier", 0.35), ("pseudo-solid", 0.2), ("angles", 0.2))
    ),
    *(Limit(f"way back, {name}", _WAY_BACK, at_most=1e-12) for name in _STATELESS),
)


@dataclass(frozen=True)
class Movers:
    """Three movers on the mesh of FSI3; see `hofsi.bench.benchmark.Benchmark`."""

    name: str = "movers"
    title: str = "meshes around a flag that bends by 90 mm and back, with three movers"

    def measure(self, folder: Path, *, quick: bool) -> Measured:
        """Bend the flag of the scene fsi3 as the first mode of a cantilever."""
        began = perf_counter()
        values: dict[str, float | None] = {}
        seconds: dict[str, float] = {}
        cycles, steps = (1, 20) if quick else (5, 40)
        size = ""
        for name, change in _MOVERS.items():
            problem = build(load_case(SCENES / "fsi3.toml", [change]))
            assert problem.fluid is not None
            assert problem.fluid.motion is not None
            mesh = problem.fluid.mesh
            size = f"{len(mesh.cells)} elements of order {mesh.order}, {cycles * steps} meshes with each mover"
            start = perf_counter()
            values |= {f"{what}, {name}": value for what, value in _swung(problem.fluid.motion, cycles, steps).items()}
            seconds[name] = perf_counter() - start
        return Measured(
            judged(_CHECKS, values),
            size,
            {"cycles": cycles, "steps": steps, "deflection": _LARGEST},
            {**seconds, "total": perf_counter() - began},
            {f"ms a mesh, {name}": 1e3 * value / (cycles * steps) for name, value in seconds.items()},
        )


def _swung(motion: MeshMotion, cycles: int, steps: int) -> Mapping[str, float | None]:
    """Worst element on the way, and how far nodes are from their first places in the end."""
    first = state = motion.reference
    places = first.mesh.points[motion.driven.nodes]
    worst = 1.0
    for fraction in np.tile(np.sin(2.0 * np.pi * np.arange(1, steps + 1) / steps), cycles):
        try:
            state = motion.move(state, bent(places, _LARGEST * fraction) - places, 0.0)
        except MeshMotionError:
            return {"worst scaled Jacobian": None, "way back": None}
        worst = min(worst, float(scaled_jacobian(state.mesh).min()))
    return {"worst scaled Jacobian": worst, "way back": float(np.abs(state.mesh.points - first.mesh.points).max())}


def bent(points: Array, deflection: float) -> Array:
    """Points of the flag with its axis bent to s² (3 L - s) / (2 L³) times a deflection, sections normal to it."""
    s = points[:, 0] - _CLAMP
    half = points[:, 1] - 0.2
    slope = deflection * 3.0 * s * (2.0 * _LENGTH - s) / (2.0 * _LENGTH**3)
    turned = np.arctan(slope)
    # The axis keeps its length: ∫ cos of its angle, by Gauss's rule from the clamp to each point.
    xi, weights = np.polynomial.legendre.leggauss(12)
    t = 0.5 * s[:, None] * (1.0 + xi)
    angle = np.arctan(deflection * 3.0 * t * (2.0 * _LENGTH - t) / (2.0 * _LENGTH**3))
    x = _CLAMP + 0.5 * s * (np.cos(angle) @ weights)
    y = 0.2 + 0.5 * s * (np.sin(angle) @ weights)
    return np.stack([x - half * np.sin(turned), y + half * np.cos(turned)], axis=1)
