"""A flap bent far by a channel's flow: hofsi beside Kratos Multiphysics, errors of the motion and the force over time.

The case (`flap.toml`; height of the channel, mean inflow and density of the fluid are 1): Re = 50, a neo-Hookean flap,
0.45 high and 0.06 thick, 5 times as dense, in plane strain. The inflow sets in as (1 - cos πt)/2 until the end at
t = 1; the flap's end moves by 0.22, nearly half of its height. No slip on the walls, no traction at the outlet.
Compared are the displacement of the middle of the end and the force on the flap at t = 0.2, 0.4, ... 1; errors are the
largest of these five, relative to the largest value, because at a single time errors may cancel.

    pip install KratosFSIApplication KratosConstitutiveLawsApplication KratosLinearSolversApplication gmsh
    OMP_NUM_THREADS=1 python benchmarks/peers/flap_kratos.py --picture flap.png

Kratos' partitioned solver (FSIApplication): linear triangles with its stabilised element, graded to the flap and its
corners by Gmsh, solid elements with nine nodes whose boundary nodes are the fluid's, BDF2, multi-vector quasi-Newton
coupling, AMG. hofsi: flap.toml with other orders and numbers of elements, all else as by default. Both have the same
meaning of the outlet, the law of the solid and the force: a sum of nodal reactions. Each run has its own process;
seconds are the processor's, from the mesh to the last step, after a small run that imports what is needed.

The reference is hofsi's, order 6 on 260 elements, extrapolated in time from steps of 0.01 and 0.005.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from _precision import draw, factors, factors_table
from _result import Result, parser, report

Array = NDArray[np.float64]
Row = dict[str, Any]

SCENE = Path(__file__).with_name("flap.toml")
NEEDED = ("KratosMultiphysics", "gmsh")
PACKAGES = "KratosFSIApplication KratosConstitutiveLawsApplication KratosLinearSolversApplication gmsh"
NAMES = ("u_x", "u_y", "f_x")
TIMES = (0.2, 0.4, 0.6, 0.8, 1.0)
REFERENCE = np.array(
    [
        [0.009583, -0.0002906, 0.25344],
        [0.068086, -0.0060049, 0.65669],
        [0.161421, -0.0340884, 1.09569],
        [0.215047, -0.0623420, 1.47420],
        [0.209471, -0.0582006, 1.59076],
    ]
)
LARGEST_VALUES = (0.218047, 0.063985, 1.60640)
"""Of u_x, -u_y and f_x in the whole run."""

# Elements across and along the flap, beside it, above its end, behind it, elsewhere; two gradings.
MESHES: Mapping[str, tuple[tuple[int, ...], tuple[float, float]]] = {
    "small": ((1, 3, 2, 2, 1, 1), (1.8, 1.5)),
    "medium": ((1, 4, 3, 2, 2, 1), (1.8, 1.5)),
    "large": ((2, 7, 5, 4, 3, 2), (3.0, 3.0)),
}
LARGEST = "largest error"
PANELS = {LARGEST: "largest of the three errors"} | {f"error of {name}": f"error of {name}" for name in NAMES}
GOALS = (3e-2, 2e-2, 1e-2, 5e-3, 2e-3)


def changes(order: int, mesh: str, dt: float, end: float) -> list[str]:
    """What a run of hofsi changes in the scene."""
    counts, gradings = MESHES[mesh]
    return [
        f"mesh.order={order}",
        f"time.dt={dt}",
        f"time.end={end}",
        *(f"mesh.count[{k}].elements={count}" for k, count in enumerate(counts)),
        *(f"mesh.grading[{k}].a={a}" for k, a in enumerate(gradings)),
    ]


def _hofsi(order: int, mesh: str, dt: float, end: float) -> tuple[Row, Array]:
    from hofsi import build, evaluators, load_case, simulate
    from hofsi.memory import keep_freed_memory

    keep_freed_memory()  # as `hofsi run` does
    used = process_time()
    problem = build(load_case(SCENE, changes(order, mesh, dt, end)))
    read = evaluators(problem)
    series, iterations = [], 0
    for record in simulate(problem):
        series.append([record.time, *(read[name](record) for name in NAMES)])
        assert record.coupling is not None
        iterations += record.coupling.iterations
    cpu = process_time() - used
    assert record.state.mesh is not None
    assert record.state.solid is not None
    cells = record.state.mesh.mesh.cells
    row = {
        "program": "hofsi",
        "order": order,
        "mesh": mesh,
        "elements": len(cells) + MESHES[mesh][0][0] * MESHES[mesh][0][1],
        "nodes": len(record.state.mesh.mesh.points),
        "dt": dt,
        "steps": len(series),
        "iterations": iterations / len(series),
        "CPU s": cpu,
    }
    return row, np.array(series)


def _kratos(size: float, dt: float, end: float, **others: Any) -> tuple[Row, Array]:
    from _flap_run import run
    from _flap_settings import Setting

    outcome = run(Setting(size, dt, **others), end)
    row = {
        "program": "Kratos",
        "order": 1,
        "mesh": f"size {size:g}" + "".join(f", {value}" for value in others.values()),
        "elements": outcome.elements,
        "nodes": outcome.nodes,
        "dt": dt,
        "steps": len(outcome.series),
        "iterations": outcome.iterations,
        "CPU s": outcome.cpu,
    }
    return row, outcome.series


def one(wanted: Mapping[str, Any]) -> Row:
    """One run in this process, after a small one: its row."""
    given = dict(wanted)
    solve = _hofsi if given.pop("program") == "hofsi" else _kratos
    coarse = {"order": 2, "mesh": "small"} if solve is _hofsi else {"size": 3.0}
    solve(**given | coarse | {"dt": 0.04, "end": 0.08})
    row, series = solve(**given)
    return row | errors(series)


def errors(series: Array) -> Row:
    """Values at the end and errors of a series (t, u_x, u_y, f_x) that may stop early."""
    found: Row = {name: float(value) for name, value in zip(NAMES, series[-1, 1:], strict=True)}
    for k, name in enumerate(NAMES):
        off = [
            abs(float(series[at, k + 1]) - value[k])
            for time, value in zip(TIMES, REFERENCE, strict=True)
            for at in np.flatnonzero(np.isclose(series[:, 0], time))
        ]
        found[f"error of {name}"] = max(off) / LARGEST_VALUES[k]
    complete = np.isclose(series[-1, 0], TIMES[-1])
    for k, name in ((1, "u_x"), (3, "f_x")) if complete else ():
        greatest = float(np.abs(series[:, k]).max())
        found[f"error of max {name}"] = abs(greatest / LARGEST_VALUES[k - 1] - 1.0)
    return found | {LARGEST: max(found[f"error of {name}"] for name in NAMES)}


def apart(wanted: Mapping[str, Any], repeats: int = 1) -> Row:
    """A run in a process of its own, the shortest time of several."""
    rows = []
    for _ in range(repeats):
        command = [sys.executable, __file__, "--one", json.dumps(dict(wanted))]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"{dict(wanted)} failed:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
        rows.append(json.loads(done.stdout.splitlines()[-1]))
    return min(rows, key=lambda row: row["CPU s"])


def study(quick: bool) -> list[Row]:
    """The settings of all runs."""
    if quick:
        hofsi = [{"order": order, "mesh": "small", "dt": 0.04} for order in (2, 3)]
        kratos = [{"size": size, "dt": 0.04} for size in (3.0, 2.0)]
        end = 0.2
    else:
        hofsi = [
            {"order": order, "mesh": mesh, "dt": dt}
            for dt in (0.04, 0.02, 0.01)
            for mesh, orders in (("small", (2, 3, 4)), ("medium", (2, 3, 4, 6)), ("large", (3, 4)))
            for order in orders
        ]
        kratos = [
            {"size": size, "dt": dt}
            for dt, sizes in ((0.04, (2.4, 1.7, 1.2)), (0.02, (1.7, 1.2, 0.85)), (0.01, (1.2,)))
            for size in sizes
        ]
        end = TIMES[-1]
    runs = [{"program": "hofsi", **run} for run in hofsi] + [{"program": "Kratos", **run} for run in kratos]
    return [run | {"end": end} for run in runs]


def labelled(rows: Sequence[Row]) -> list[Row]:
    """The rows with the time step beside the order, for the factors and the picture."""
    return [row | {"order": f"{row['order']}, dt {row['dt']:g}"} for row in rows]


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.formatter_class = argparse.RawDescriptionHelpFormatter
    options.add_argument("--picture", type=Path, metavar="FILE", help="draw errors against CPU seconds")
    options.add_argument("--quick", action="store_true", help="four small runs of five steps")
    options.add_argument("--repeats", type=int, default=1, help="the shortest of so many times (default: %(default)s)")
    options.add_argument("--one", type=json.loads, metavar="JSON", help="one run in this process, printed as JSON")
    chosen = options.parse_args(argv)
    if any(find_spec(name) is None for name in NEEDED):
        print(f"This benchmark compares with Kratos Multiphysics, which is not installed: pip install {PACKAGES}.")
        raise SystemExit(2)
    if chosen.one:
        row = one(chosen.one)
        print(json.dumps(row))
        return Result("flap_kratos", {}, [row])
    rows = []
    for run in study(chosen.quick):
        rows.append(apart(run, chosen.repeats))
        print({name: rows[-1][name] for name in ("program", "order", "mesh", "dt", "CPU s", LARGEST)}, flush=True)
    about: Row = {
        "times": TIMES,
        "reference": REFERENCE.tolist(),
        "repeats": chosen.repeats,
        "factors": factors(labelled(rows), "CPU s", LARGEST, GOALS),
    }
    result = report(Result("flap_kratos", about, rows), chosen.json)
    print(factors_table(about["factors"], "all errors below"))
    if chosen.picture:
        draw(labelled(rows), "CPU s", PANELS, chosen.picture)
    return result


if __name__ == "__main__":
    main()
