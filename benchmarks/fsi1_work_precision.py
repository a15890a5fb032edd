"""Errors of FSI1, the steady flag in a flow, against seconds over order and mesh, beside NGSolve where it is installed.

The reference are values on which two programs that share nothing agree to 0.05 % (docs/verification.md), for the
published ones are as far from both as 0.3 %. "error" is the largest one of displacement and forces.
"""

from __future__ import annotations

import copy
import sys
import tomllib
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from _precision import draw, factors, factors_table
from _result import ROOT, Result, parser, report
from hofsi import build, evaluators, read_case, simulate

Row = dict[str, Any]

REFERENCE = {"u_x": 2.2693e-5, "u_y": 8.183e-4, "drag": 14.29396, "lift": 0.76475}
GOALS = (1e-1, 1e-2, 5e-3, 2e-3, 1e-3)
SETTINGS = ((1, (2, 3, 4, 5, 6, 8)), (2, (2, 3, 4)))  # factor of the scene's elements each way, orders
PEERS = ((2, 1e-2), (3, 1e-2), (3, 3e-3), (4, 3e-3), (4, 1e-3))  # order, size at the tip; then 5, 5e-4 takes minutes


def measure(order: int, factor: int) -> Row:
    """One run of hofsi."""
    scene = copy.deepcopy(tomllib.loads((ROOT / "examples" / "fsi1.toml").read_text(encoding="utf-8")))
    scene["mesh"]["order"] = order
    for count in scene["mesh"]["count"]:
        count["elements"] *= factor
    wall, cpu = perf_counter(), process_time()
    problem = build(read_case(scene, "fsi1.toml"))
    read = evaluators(problem)
    (record,) = simulate(problem)
    found = {name: evaluate(record) for name, evaluate in read.items()}
    used = {"seconds": perf_counter() - wall, "CPU s": process_time() - cpu}
    assert problem.fluid is not None
    row = {"program": "hofsi", "order": order, "mesh": f"{factor} x", "elements": len(problem.fluid.mesh.cells)}
    return _judged({**row, **found, **used})


def peer(order: int, tip: float) -> Row:
    """One run of NGSolve."""
    import fsi1_ngsolve

    wall, cpu = perf_counter(), process_time()
    result = fsi1_ngsolve.main(order, tip)
    found = {name: getattr(result, name) for name in REFERENCE}
    used = {"seconds": perf_counter() - wall, "CPU s": process_time() - cpu}
    row = {"program": "NGSolve", "order": order, "mesh": f"{tip:g}", "elements": result.elements}
    return _judged({**row, **found, **used})


def _judged(row: Row) -> Row:
    return {**row, "error": max(abs(row[name] / value - 1.0) for name, value in REFERENCE.items())}


def main(argv: Sequence[str] | None = None) -> Result:
    """Measure, draw and report."""
    options = parser(__doc__)
    options.add_argument("--quick", action="store_true", help="orders 2 and 3")
    options.add_argument("--picture", type=Path, metavar="FILE", help="default beside the result")
    asked = options.parse_args(argv)
    settings, peers = (((1, (2, 3)),), PEERS[:1]) if asked.quick else (SETTINGS, PEERS)
    measure(2, 1)  # loads what it needs
    runs: list[Callable[[], Row]] = [lambda p=p, k=k: measure(p, k) for k, orders in settings for p in orders]  # type: ignore[misc]
    if find_spec("ngsolve"):
        sys.path.insert(0, str(ROOT / "benchmarks" / "peers"))
        runs += [lambda p=p, tip=tip: peer(p, tip) for p, tip in peers]  # type: ignore[misc]
    rows = [run() for run in runs]
    about = {"reference": REFERENCE, "factors": factors(rows, "CPU s", "error", GOALS)}
    path = asked.json or ROOT / "results" / "fsi1_work_precision.json"
    result = report(Result("fsi1_work_precision", about, rows), path)
    print(factors_table(about["factors"], "all errors below"))  # type: ignore[arg-type]
    draw(rows, "CPU s", {"error": "FSI1: displacement and forces"}, asked.picture or path.with_suffix(".png"))
    return result


if __name__ == "__main__":
    main()
