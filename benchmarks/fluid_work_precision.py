"""DFG 2D-1, steady flow past a cylinder at Re = 20: errors of drag, lift and pressure difference against time.

The scene is examples/dfg_2d_1.toml with different numbers of elements along its blocks, each run one problem from the
scene to the three quantities, after a warm-up; starting Python and importing is stated apart. Reference: FeatFlow (TU
Dortmund). With ``--ngsolve`` the same by NGSolve, run by run in turn, on its best meshes: `pip install ngsolve` first.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from _precision import draw, factors
from _result import ROOT, Result, fastest, parser, report
from hofsi import build, evaluators, load_case, simulate
from hofsi.memory import keep_freed_memory

REFERENCE = {"c_D": 5.57953523384, "c_L": 0.010618948146, "dp": 0.11752016697}
LARGEST = "largest error"
PANELS = {LARGEST: "largest of the three errors"} | {f"error of {name}": f"error of {name}" for name in REFERENCE}


def measure(order: int, counts: Sequence[int]) -> dict[str, Any]:
    """One run with so many elements before, around, behind the cylinder, and from it outwards."""
    changes = [f"mesh.count[{entry}].elements={count}" for entry, count in enumerate(counts)]
    keep_freed_memory()  # as `hofsi run` does
    start, used = perf_counter(), process_time()
    problem = build(load_case(ROOT / "examples" / "dfg_2d_1.toml", [f"mesh.order={order}", *changes]))
    built = perf_counter()
    (record,) = simulate(problem)
    found = {name: evaluate(record) for name, evaluate in evaluators(problem).items()}
    stop, cpu = perf_counter(), process_time() - used
    assert record.state.fluid is not None
    velocity, pressure = record.state.fluid.velocity, record.state.fluid.pressure
    row = {
        "program": "hofsi",
        "order": order,
        "mesh": ",".join(map(str, counts)),
        "elements": len(record.state.mesh.mesh.cells) if record.state.mesh else 0,
        "unknowns": velocity.size + pressure.size,
        "build s": built - start,
        "seconds": stop - start,
        "CPU s": cpu,
    }
    return row | _errors(found)


def _errors(found: dict[str, float]) -> dict[str, float]:
    errors = {f"error of {name}": abs(found[name] - value) for name, value in REFERENCE.items()}
    return errors | {LARGEST: max(errors.values())}


def _peer_runs() -> list[Callable[[], dict[str, Any]]]:
    """Runs of NGSolve; an ImportError that says what to install if it is missing."""
    from peers.dfg_2d_1_ngsolve import FRONT, Setting, run

    def one(setting: Setting) -> dict[str, Any]:
        outcome = run(setting)
        row = {
            "program": "NGSolve",
            "order": setting.order,
            "mesh": f"{setting.far:g}/{setting.near:g}/{setting.grading:g}/{setting.curvature:g} {setting.solver}",
            "elements": outcome.elements,
            "unknowns": outcome.unknowns,
            "build s": outcome.build,
            "seconds": outcome.seconds,
            "CPU s": outcome.cpu,
        }
        return row | _errors({"c_D": outcome.c_D, "c_L": outcome.c_L, "dp": outcome.dp})

    one(FRONT[0])
    return [lambda setting=setting: one(setting) for setting in FRONT]  # type: ignore[misc]


def _imports(modules: str) -> float:
    """Seconds from the start of Python to the end of its imports."""
    command = [sys.executable, "-c", f"import {modules}"]
    return fastest(lambda: subprocess.run(command, check=True), 3)


def _counts(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split(","))


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--orders", type=int, nargs="+", default=list(range(2, 13)))
    options.add_argument(
        "--counts",
        type=_counts,
        nargs="+",
        default=[(1, 2, 4, 3), (1, 3, 4, 3), (2, 4, 12, 4)],
        help="elements before, around, behind the cylinder, and from it outwards, such as 1,2,6,2",
    )
    options.add_argument("--unknowns", type=int, default=30_000, help="skip larger meshes (default: %(default)s)")
    options.add_argument("--repeats", type=int, default=1, help="the shortest of so many times (default: %(default)s)")
    options.add_argument("--ngsolve", action="store_true", help="compare with NGSolve")
    options.add_argument("--picture", type=Path, metavar="FILE", help="draw errors against CPU seconds")
    chosen = options.parse_args(argv)
    peers = _peer_runs() if chosen.ngsolve else []
    measure(2, (1, 2, 6, 2))  # imports what the solver needs
    measure(6, (1, 2, 6, 2))
    settings = [(p, counts) for counts in chosen.counts for p in chosen.orders if _size(p, counts) <= chosen.unknowns]
    runs = [lambda s=s: measure(*s) for s in settings] + peers  # type: ignore[misc]
    rows = [run() for run in runs]
    for _ in range(chosen.repeats - 1):
        for row, run in zip(rows, runs, strict=True):
            again = run()
            row |= {name: min(row[name], again[name]) for name in ("build s", "seconds", "CPU s")}
    about: dict[str, Any] = {"reference": REFERENCE, "repeats": chosen.repeats}
    about["factors"] = factors(rows, "CPU s", LARGEST)
    about["start and imports s"] = {"hofsi": _imports("hofsi, hofsi.solvers.fluid, hofsi.quantities")}
    if peers:
        about["start and imports s"]["NGSolve"] = _imports("ngsolve, netgen.occ")
        about["factors by wall clock"] = factors(rows, "seconds", LARGEST)
    result = report(Result("fluid_work_precision", about, rows), chosen.json)
    for line in about.get("factors", []):
        print(line)
    if chosen.picture:
        draw(rows, "CPU s", PANELS, chosen.picture)
    return result


def _size(order: int, counts: Sequence[int]) -> int:
    """About how many unknowns: three a node."""
    before, around, behind, outwards = counts
    elements = (2 * before + around) * (before + behind) + 2 * before * around + 4 * around * outwards
    return 3 * order**2 * elements


if __name__ == "__main__":
    main()
