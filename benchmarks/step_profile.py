"""Where the time of a step of FSI3 goes: by phase, and by function.

The phases are those of a run without a profiler: a step's processor time, the median over the steps, divided as the
clock divides it. The functions are those of a run under cProfile, whose own cost falls on what calls many small ones:
the times are scaled so that they add up to that of a step without it. "own" is without the functions that are called.
"""

from __future__ import annotations

import cProfile
import pstats
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from _result import ROOT, Result, parser, report
from hofsi import build, load_case, simulate
from hofsi.build import Problem
from hofsi.records import StepRecord

_WARM = 5


def steps(scene: str, changes: Sequence[str]) -> tuple[Problem, Iterator[StepRecord]]:
    """A run without output, after its first steps."""
    case = load_case(ROOT / "examples" / f"{scene}.toml", [*changes, "output.fields=false", "output.plots=false"])
    problem = build(case)
    run = simulate(problem)
    for _ in range(_WARM):
        next(run)
    return problem, run


def by_phase(scene: str, changes: Sequence[str], count: int) -> dict[str, float]:
    """Milliseconds of each phase in a step, and of the whole step."""
    problem, run = steps(scene, changes)
    before, began, taken = dict(problem.clock.seconds), perf_counter(), []
    for _ in range(count):
        start = process_time()
        next(run)
        taken.append(process_time() - start)
    whole, wall = 1e3 * float(np.median(taken)), perf_counter() - began
    shares = {name: (total - before.get(name, 0.0)) / wall for name, total in problem.clock.seconds.items()}
    parts = {name: whole * share for name, share in shares.items() if share > 0.0}
    return {**parts, "other": whole - sum(parts.values()), "step": whole}


def by_function(scene: str, changes: Sequence[str], count: int, whole: float) -> list[dict[str, Any]]:
    """Functions with the largest own times, in milliseconds a step, scaled to a step of ``whole`` milliseconds."""
    _, run = steps(scene, changes)
    profiler = cProfile.Profile(process_time)
    profiler.enable()
    for _ in range(count):
        next(run)
    profiler.disable()
    found = pstats.Stats(profiler).stats  # type: ignore[attr-defined]
    scale = whole / sum(own for _, _, own, _, _ in found.values())
    rows = [
        {"function": _name(*place), "calls": calls / count, "own ms": scale * own, "with callees ms": scale * total}
        for place, (_, calls, own, total, _) in found.items()
    ]
    return sorted(rows, key=lambda row: -float(row["own ms"]))


def _name(file: str, line: int, function: str) -> str:
    """Module and function; the line tells functions of the same name apart."""
    if file == "~":
        return function.removeprefix("<").removesuffix(">")
    path = Path(file)
    parts = path.with_suffix("").parts
    start = next((k for k, part in enumerate(parts) if part in ("hofsi", "hoblock", "numpy", "scipy")), len(parts) - 1)
    return f"{'.'.join(parts[start:])}.{function}"


def main(argv: Sequence[str] | None = None) -> Result:
    """Measure and report."""
    options = parser(__doc__)
    options.add_argument("--scene", default="fsi3", help="in examples/ (default: %(default)s)")
    options.add_argument("--set", action="append", default=[], dest="changes", metavar="KEY=VALUE")
    options.add_argument("--steps", type=int, default=60, help="(default: %(default)s)")
    options.add_argument("--functions", type=int, default=20, help="how many to show (default: %(default)s)")
    options.add_argument("--quick", action="store_true", help="8 steps")
    asked = options.parse_args(argv)
    count = 8 if asked.quick else asked.steps
    phases = by_phase(asked.scene, asked.changes, count)
    functions = by_function(asked.scene, asked.changes, max(4, count // 2), phases["step"])
    modules: dict[str, float] = defaultdict(float)
    for row in functions:
        modules[str(row["function"]).rpartition(".")[0] or "built-in"] += row["own ms"]
    largest = dict(sorted(modules.items(), key=lambda item: -item[1])[:12])
    shown = functions[: asked.functions]
    rest = sum(float(row["own ms"]) for row in functions[asked.functions :])
    others = f"{len(functions) - len(shown)} others"
    shown.append({"function": others, "calls": None, "own ms": rest, "with callees ms": None})
    settings = {
        "scene": asked.scene,
        "changes": asked.changes,
        "steps": count,
        "phases ms": phases,
        "modules ms": largest,
    }
    for parts in (phases, largest):
        print(", ".join(f"{name} {value:.1f} ms" for name, value in parts.items()), end="\n\n")
    return report(Result("step_profile", settings, shown), asked.json)


if __name__ == "__main__":
    main()
