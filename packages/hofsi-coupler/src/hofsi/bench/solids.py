"""Benchmarks of a solid alone: CSM1 to CSM3 of Turek and Hron."""

from __future__ import annotations

from hofsi.bench.checks import Check
from hofsi.bench.scene_benchmark import Quick, SceneBenchmark

__all__ = ["SOLIDS"]

_AT_REST = "a p-version computation that agrees with FeatFlow's finest level; uncertainty: FeatFlow's last change"
_CSM3 = "FeatFlow's series, level 4, dt 0.005; uncertainty: its amplitudes differ from period to period"
_QUICK = Quick(("mesh.order=4",), {"u_x last": 1e-4, "u_y last": 1e-4})

SOLIDS = (
    SceneBenchmark(
        "csm1",
        "elastic flag under its own weight",
        "csm1",
        (
            Check("u_x last", -7.18784e-3, 1.5e-5, 1e-5, _AT_REST),
            Check("u_y last", -6.610320e-2, 1e-5, 1e-5, _AT_REST),
        ),
        ("mesh.order=10",),
        _QUICK,
    ),
    SceneBenchmark(
        "csm2",
        "the same flag, four times as stiff",
        "csm1",
        (
            Check("u_x last", -4.690106e-4, 1.5e-5, 1e-5, _AT_REST),
            Check("u_y last", -1.6974091e-2, 1e-5, 1e-5, _AT_REST),
        ),
        ("solid[0].youngs_modulus=5.6e6", "mesh.order=10"),
        _QUICK,
    ),
    SceneBenchmark(
        "csm3",
        "the flag let go from rest",
        "csm1",
        (
            Check("u_x amplitude", 14.305724e-3, 5e-3, 5e-3, _CSM3),
            Check("u_y amplitude", 65.160709e-3, 5e-3, 5e-3, _CSM3),
            Check("u_y mean", -63.607775e-3, 5e-3, 5e-3, _CSM3),
            Check("u_y frequency", 1.09405, 2e-3, 3e-3, _CSM3),
        ),
        (
            "time={dt=0.005, end=10, solid='energy-momentum'}",
            "output.period_of=u_y",
        ),
        Quick(
            ("mesh.order=2", "time.dt=0.01", "time.end=5"),
            {"u_x amplitude": 0.03, "u_y amplitude": 0.03, "u_y mean": 0.03, "u_y frequency": 0.01},
        ),
    ),
)
