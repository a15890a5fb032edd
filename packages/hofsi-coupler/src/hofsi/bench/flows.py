"""Benchmarks of fluids alone: DFG 2D-1, and CFD1 to CFD3 of Turek and Hron."""

from __future__ import annotations

from hofsi.bench.checks import Check
from hofsi.bench.scene_benchmark import Quick, SceneBenchmark

__all__ = ["FLOWS"]

_DFG = "FeatFlow (TU Dortmund); lift: two sources, G. Nabh (1998) the other, differ by 1e-8"
_STEADY = "FeatFlow, level 6+0; uncertainty: its change from level 5+3"
_CFD3 = "FeatFlow, level 4+0, dt 0.005; uncertainty: Feel++, orders 4/3, dt 0.002"


def _steady(name: str, title: str, drag: float, lift: float) -> SceneBenchmark:
    checks = (Check("drag last", drag, 1e-5, 1e-4, _STEADY), Check("lift last", lift, 3e-5, 1e-4, _STEADY))
    return SceneBenchmark(name, title, name, checks)


FLOWS = (
    SceneBenchmark(
        "dfg-2d-1",
        "steady flow past a cylinder, Re = 20",
        "dfg_2d_1",
        (
            Check("c_D last", 5.57953523384, 1e-10, 1e-9, _DFG),
            Check("c_L last", 0.010618948146, 1e-6, 2e-6, _DFG),
            Check("dp last", 0.11752016697, 1e-10, 3e-8, _DFG),
        ),
        ("mesh.order=8",),
        Quick(("mesh.order=4",), {"c_D last": 1e-5, "c_L last": 2e-3, "dp last": 3e-4}),
    ),
    _steady("cfd1", "steady flow past a cylinder with a rigid flag, Re = 20", 14.2929, 1.11905),
    _steady("cfd2", "steady flow past a cylinder with a rigid flag, Re = 100", 136.700, 10.5343),
    SceneBenchmark(
        "cfd3",
        "vortices behind a cylinder with a rigid flag, Re = 200",
        "cfd3",
        (
            Check("drag mean", 439.45, 1.5e-3, 2e-3, _CFD3),
            Check("drag amplitude", 5.6183, 3e-2, 3e-2, _CFD3),
            Check("lift amplitude", 437.81, 6e-3, 1e-2, _CFD3),
            Check("lift frequency", 4.3956, 5e-3, 6e-3, _CFD3),
        ),
        ("output.period_of=lift",),
        Quick(
            ("mesh.order=3", "time.dt=0.01", "time.end=8"),
            {"drag amplitude": 0.1, "lift amplitude": 0.1, "lift frequency": 0.03},
        ),
    ),
)
