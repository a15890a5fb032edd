"""Benchmarks of fluid and solid: FSI1 to FSI3 of Turek and Hron, and the flap of Wall and Ramm."""

from __future__ import annotations

from hofsi.bench.checks import Check, Limit
from hofsi.bench.scene_benchmark import Quick, SceneBenchmark

__all__ = ["FLAGS"]

_FSI1 = "FeatFlow, level 7; uncertainty: two other programs agree with each other this far from it"
_LEVELS = "uncertainty: its change from level 3 to 4"
_FSI2 = f"FeatFlow, level 4, dt 0.0005; {_LEVELS}"
_FSI3 = f"FeatFlow, level 4, dt 0.00025; {_LEVELS}"
_PUBLISHED = "range of what eleven papers found for plane strain and plane stress"
_FEW = Limit("iterations a step", "fluid and solid have to agree in few iterations", at_most=5.0)
_COARSE = {
    "u_x amplitude": 0.2,
    "u_y amplitude": 0.05,
    "drag mean": 0.04,
    "drag amplitude": 0.1,
    "lift amplitude": 0.25,
    "u_y frequency": 0.03,
}

FLAGS = (
    SceneBenchmark(
        "fsi1",
        "steady flow past a cylinder with an elastic flag, Re = 20",
        "fsi1",
        (
            Check("u_x last", 2.270493e-5, 1e-3, 1e-3, _FSI1),
            Check("u_y last", 8.208773e-4, 3e-3, 3e-3, _FSI1),
            Check("drag last", 14.29426, 2e-4, 3e-4, _FSI1),
            Check("lift last", 0.7637460, 2e-3, 2e-3, _FSI1),
        ),
        ("mesh.order=5",),
        Quick(("mesh.order=4",), {"drag last": 5e-4}),
    ),
    SceneBenchmark(
        "fsi2",
        "heavy elastic flag that swings by itself, Re = 100",
        "fsi2",
        (
            Check("u_x amplitude", 12.70e-3, 2e-2, 4e-2, _FSI2),
            Check("u_y amplitude", 81.6e-3, 1.1e-2, 1e-2, _FSI2),
            Check("drag mean", 215.06, 1e-2, 5e-3, _FSI2),
            Check("drag amplitude", 77.65, 2.5e-2, 2.5e-2, _FSI2),
            Check("lift amplitude", 237.8, 1.3e-2, 2e-2, _FSI2),
            Check("u_y frequency", 1.93, 5e-3, 5e-3, _FSI2),
            _FEW,
        ),
        quick=Quick(("mesh.order=3", "time.dt=0.01", "time.end=12"), _COARSE),
    ),
    SceneBenchmark(
        "fsi3",
        "elastic flag as dense as the fluid that swings by itself, Re = 200",
        "fsi3",
        (
            Check("u_x amplitude", 2.72e-3, 4e-2, 2.5e-2, _FSI3),
            Check("u_y amplitude", 34.99e-3, 1.6e-2, 1e-2, _FSI3),
            Check("drag mean", 460.5, 3e-3, 5e-3, _FSI3),
            Check("drag amplitude", 27.74, 4.5e-2, 2.5e-2, _FSI3),
            Check("lift amplitude", 153.91, 2.6e-2, 2e-2, _FSI3),
            Check("u_y frequency", 5.46, 5e-3, 5e-3, _FSI3),
            _FEW,
        ),
        quick=Quick(("mesh.order=3", "time.dt=0.004", "time.end=5"), _COARSE),
    ),
    SceneBenchmark(
        "wall-ramm",
        "thin plate behind a square that swings by itself, Re = 333",
        "wall_ramm",
        (
            Check("u_y amplitude", 1.15, 0.22, 0.22, _PUBLISHED),
            Check("u_y frequency", 3.05, 0.083, 0.083, _PUBLISHED),
            _FEW,
        ),
        quick=Quick(("time.dt=0.01", "time.end=5"), {"u_y amplitude": 0.6}),
    ),
)
