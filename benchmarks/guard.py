"""A guard against slowness: times in terms of a reference computation, compared with a committed baseline.

    python benchmarks/guard.py             # about a minute; exit code 1 if something has become slower
    python benchmarks/guard.py --update    # after a change that is meant to cost time: a new baseline

The reference is what the solvers consist of, in about their shares: factors and inverses of small dense matrices,
products of batches, and small operations that cost the interpreter's time. It is computed in turn with each step of a
case, so that a slow minute of the machine meets both; a figure is the median of the ratios of processor times. It
differs between machines by less than times do, but a baseline is best made on the machine that is compared with it.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from _result import ROOT, Result, parser, report
from hofsi import build, load_case, simulate

BASELINE = ROOT / "benchmarks" / "measured" / "guard.json"
TABLES_ONLY = ("output.fields=false", "output.plots=false")
SLOWER = 1.15  # of the baseline; the same code differs by up to 10 % from run to run beside other jobs
_WARM = 4


def reference() -> Callable[[], object]:
    """The computation that times are measured in, some milliseconds long."""
    rng = np.random.default_rng(2718)
    fronts = rng.standard_normal((6, 160, 160)) + 160.0 * np.eye(160)
    blocks = rng.standard_normal((120, 43, 43)) + 43.0 * np.eye(43)
    tables, small = rng.standard_normal((36, 25)), rng.standard_normal(30)

    def compute() -> object:
        inverse = np.linalg.inv(blocks)
        product = blocks @ inverse
        factors = [np.linalg.solve(front, front[:, :40]) for front in fronts]
        fields = [tables.T @ (tables * value) for value in small for _ in range(4)]
        total = 0.0
        for k in range(2000):
            total += small[k % 30] * k
        return product, factors, fields, total

    return compute


def steps(scene: str, *changes: str) -> Iterator[object]:
    """Steps of a scene."""
    return iter(simulate(build(load_case(ROOT / "examples" / f"{scene}.toml", [*changes, *TABLES_ONLY]))))


def steady(scene: str, *changes: str) -> Iterator[object]:
    """The same steady state again and again, building included."""
    while True:
        yield from steps(scene, *changes)


CASES: dict[str, Callable[[], Iterator[object]]] = {
    "step of FSI3": lambda: steps("fsi3"),
    "step of FSI3, order 6": lambda: steps("fsi3", "mesh.order=6"),
    "step of FSI3, implicit geometry": lambda: steps("fsi3", 'coupling.geometry="implicit"'),
    "step of CFD3": lambda: steps("cfd3", "mesh.order=3"),
    "step of CSM3": lambda: steps("csm1", "time={dt=0.005, end=10}"),
    "step of the oscillating cylinder": lambda: steps("oscillating_cylinder", "mesh.order=3"),
    "CSM1": lambda: steady("csm1", "mesh.order=6"),
    "DFG 2D-1": lambda: steady("dfg_2d_1", "mesh.order=6"),
    "FSI1": lambda: steady("fsi1", "mesh.order=3"),
}


def measure(make: Callable[[], Iterator[object]], compute: Callable[[], object], count: int) -> float:
    """Median of the ratios of a step's processor time to that of the reference, before and after it."""
    run = make()
    for _ in range(_WARM if count > _WARM else 1):
        next(run)
    ratios, before = [], _timed(compute)
    for _ in range(count):
        taken = _timed(lambda: next(run))
        after = _timed(compute)
        ratios.append(taken / (0.5 * (before + after)))
        before = after
    return float(np.median(ratios))


def _timed(call: Callable[[], object]) -> float:
    began = process_time()
    call()
    return process_time() - began


def compared(found: dict[str, float], baseline: dict[str, float]) -> list[dict[str, Any]]:
    """What was found beside the baseline."""
    rows = []
    for name, ratio in found.items():
        before = baseline.get(name)
        change = None if before is None else ratio / before
        slower = change is not None and change > SLOWER
        rows.append(
            {"case": name, "ratio": ratio, "baseline": before, "change": change, "": "SLOWER" if slower else ""}
        )
    return rows


def main(argv: Sequence[str] | None = None) -> Result:
    """Measure all cases and compare them."""
    options = parser(__doc__)
    options.add_argument("--steps", type=int, default=15, help="of each case (default: %(default)s)")
    options.add_argument("--cases", nargs="+", metavar="WORD", help="only those with one of these words in their names")
    options.add_argument("--baseline", type=Path, default=BASELINE, metavar="FILE", help="default: the committed one")
    options.add_argument("--update", action="store_true", help="write the baseline")
    asked = options.parse_args(argv)
    compute = reference()
    compute()
    chosen = {name: make for name, make in CASES.items() if not asked.cases or any(w in name for w in asked.cases)}
    found = {name: measure(make, compute, asked.steps) for name, make in chosen.items()}
    known = json.loads(asked.baseline.read_text(encoding="utf-8")) if asked.baseline.is_file() else {"rows": []}
    baseline = {row["case"]: row["ratio"] for row in known["rows"]}
    result = Result("guard", {"steps": asked.steps, "slower": SLOWER}, compared(found, baseline))
    if asked.update:
        kept = {**baseline, **found}
        Result("guard", {"steps": asked.steps}, [{"case": n, "ratio": r} for n, r in kept.items()]).write(
            asked.baseline
        )
    return report(result, asked.json)


if __name__ == "__main__":
    sys.exit(any(row[""] for row in main().rows))
