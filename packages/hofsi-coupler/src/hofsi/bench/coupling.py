"""Benchmark of the coupling: a pressure pulse between walls that are lighter than the fluid."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from hofsi.bench.benchmark import Measured
from hofsi.bench.checks import Limit, judged
from hofsi.bench.scene_benchmark import SCENES
from hofsi.io.scene import load_case
from hofsi.run import Result, run

__all__ = ["Coupling"]

_MODES = {
    "condensed": [],
    "condensed, implicit geometry": ["coupling.geometry=implicit"],
    "IQN-ILS": ["coupling.condensed=false", "coupling.acceleration=iqn-ils"],
    "IMVJ": ["coupling.condensed=false", "coupling.acceleration=imvj"],
}
_MOST = {"condensed": 2.5, "condensed, implicit geometry": 5.0, "IQN-ILS": 12.0, "IMVJ": 12.0}
_CHECKS = (
    *(
        Limit(f"iterations a step, {name}", "fluid and solid of equal density", at_most=most)
        for name, most in _MOST.items()
    ),
    *(
        Limit(f"difference from condensed, {name}", "another way to the same solution", at_most=1e-4)
        for name in ("IQN-ILS", "IMVJ")
    ),
    Limit(
        "speed of the pulse, cm/s",
        "long waves have sqrt(k R/ρ) = 434 cm/s, short ones are slower",
        at_least=300.0,
        at_most=440.0,
    ),
)


@dataclass(frozen=True)
class Coupling:
    """The scene of the pressure pulse with four ways to couple; see `hofsi.bench.benchmark.Benchmark`."""

    name: str = "coupling"
    title: str = "pressure pulse between elastic walls as dense as the fluid, coupled in four ways"

    def measure(self, folder: Path, *, quick: bool) -> Measured:
        """Run the whole pulse condensed, and its beginning in every way."""
        began = perf_counter()
        size = ["mesh.order=2", "time.end=0.003"] if quick else ["time.end=0.005"]
        runs = {name: _run([*changes, *size], folder / str(k)) for k, (name, changes) in enumerate(_MODES.items())}
        whole = _run(["mesh.order=2", "time.end=0.012"] if quick else [], folder / "whole")
        failures = [f"{name}: {result.reason}" for name, result in runs.items() if result.status != "completed"]
        values: dict[str, float | None] = {}
        for name, result in runs.items():
            values[f"iterations a step, {name}"] = _iterations(result)
            values[f"difference from condensed, {name}"] = _difference(result, runs["condensed"])
        values["speed of the pulse, cm/s"] = _speed(whole)
        counts = whole.summary["counts"]
        return Measured(
            judged(_CHECKS, values),
            f"{counts['fluid']['unknowns']} unknowns of the fluid, {counts['solid']['unknowns']} of the walls",
            {"changes": size, "modes": _MODES},
            {name: result.summary["seconds"]["total"] for name, result in runs.items()}
            | {"whole pulse": whole.summary["seconds"]["total"], "total": perf_counter() - began},
            failure="; ".join(failures),
        )


def _run(changes: list[str], folder: Path) -> Result:
    case = load_case(SCENES / "pressure_pulse.toml", [*changes, "output.fields=false", "output.plots=false"])
    return run(case, folder)


def _iterations(result: Result) -> float | None:
    counts = result.summary["counts"]
    return float(counts["coupling_iterations"] / counts["steps"]) if counts["steps"] else None


def _difference(one: Result, other: Result) -> float | None:
    """Largest difference of the wall's displacement relative to its largest value."""
    a, b = one.series["wall_1"], other.series["wall_1"]
    return float(np.abs(a - b).max() / np.abs(b).max()) if a.shape == b.shape and a.size else None


def _speed(result: Result) -> float | None:
    """From the times at which the walls at x = 1 and 3 cm are widest."""
    times = [result.times[int(np.argmax(result.series[name]))] for name in ("wall_1", "wall_3") if result.times.size]
    return float(2.0 / (times[1] - times[0])) if len(times) == 2 and times[1] > times[0] else None
