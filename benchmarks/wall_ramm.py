"""The paper's flap of Wall and Ramm: force, tip displacement and meshes with each mover (its Figs 5 to 8), and noise.

Runs of examples/wall_ramm.toml to t = 7.5 s, as many as movers × planes × steps × orders are asked for:

    python benchmarks/wall_ramm.py --dt 0.005 0.0025
    python benchmarks/wall_ramm.py --movers barrier --planes strain stress --orders 4 5
    python benchmarks/wall_ramm.py --movers barrier --set time.solid=bdf2

Runs are appended to the JSON file, their series go to a folder beside it; one that is there already is not made again,
so that a study of hours can be made in parts. The pictures show the runs with the first plane, step and order asked
for; that of the noise all movers in the file. Noise is what the force has above 50 Hz from 2.5 s on, largest value in
percent of its amplitude (`_force_noise.py`); that of the mesh is the same of the worst block vertex, in terms of the
tip's amplitude.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from _force_noise import SETTLED, noise
from _result import ROOT, Result, parser, report
from _wall_ramm_pictures import draw_force_and_tip, draw_histograms, draw_meshes, draw_noise
from hoblock import equiangular_skewness, scaled_jacobian
from hoblock.plot import block_outlines, element_outlines
from hofsi import build, evaluators, load_case, simulate
from hofsi.errors import ConvergenceError
from hofsi.observers.quality import MeshQuality
from hofsi.records import StepRecord
from hofsi.statistics import statistics

Array = NDArray[np.float64]
Row = dict[str, Any]

MOVERS = {
    "barrier": 'type="barrier"',
    "pseudo-solid": 'type="pseudo-solid"',
    "angles": 'type="angle-optimisation"',
    "angles, published": 'type="angle-optimisation", form="published"',
    "published, tight": 'type="angle-optimisation", form="published", lower=0.8, penalty=100',
    "published, n = 1": 'type="angle-optimisation", form="published", power=1',
}
PAPER = ("barrier", "pseudo-solid", "angles, published")
LAST = 0.36  # s before the end, longer than a period: the mesh that is kept is that of the highest tip in it
KEYS = ("mover", "plane", "dt", "order", "end", "changes")


def measure(key: Mapping[str, Any]) -> tuple[Row, dict[str, Array]]:
    """Make one run; a run that fails has its figures until then."""
    changes = [f"mover={{{MOVERS[key['mover']]}}}", f"solid[0].plane={key['plane']}", f"mesh.order={key['order']}"]
    changes += [f"time.dt={key['dt']}", f"time.end={key['end']}", "output.fields=false", "output.plots=false"]
    wall, cpu = perf_counter(), process_time()
    problem = build(load_case(ROOT / "examples" / "wall_ramm.toml", [*changes, *str(key["changes"]).split()]))
    read, quality = evaluators(problem), MeshQuality()
    steps: list[tuple[float, float, float]] = []
    vertices, iterations, top, failure = list[Array](), 0, None, ""
    try:
        for record in simulate(problem):
            quality.observe(record)
            steps.append((record.time, read["u_y"](record), read["lift"](record)))
            iterations += 0 if record.coupling is None else record.coupling.iterations
            vertices.append(_mesh(record).vertices)
            if record.time >= float(key["end"]) - LAST and (top is None or steps[-1][1] > top[0]):
                top = steps[-1][1], record
    except ConvergenceError as error:
        failure = f"{type(error).__name__} after {steps[-1][0] if steps else 0.0:g} s"
    quality.close()
    t, u_y, lift = np.array(steps).reshape(-1, 3).T
    series = {"t": t, "u_y": u_y, "lift": lift, "vertices": np.array(vertices)}
    used = {"wall s": perf_counter() - wall, "CPU s": process_time() - cpu}
    row = dict(key) | figures(series) | {"iterations": iterations / max(len(t), 1)} | used
    row |= {"CPU ms a step": 1e3 * used["CPU s"] / max(len(t), 1)}
    worst = quality.summary()
    row |= {"worst scaled Jacobian": worst.get("scaled_jacobian_min"), "worst skewness": worst.get("skewness_max")}
    return row | {"failure": failure}, series | ({} if top is None else _shape(top[1]))


def figures(series: Mapping[str, Array]) -> Row:
    """Amplitudes, frequency and noise of a run; None where it is too short for them."""
    t, u_y, lift, vertices = (series[name] for name in ("t", "u_y", "lift", "vertices"))
    of = statistics(t, {"u_y": u_y, "lift": lift}, "u_y")
    row: Row = {"steps": len(t), "u_y": of["u_y"].amplitude, "Hz": of["u_y"].frequency, "lift": of["lift"].amplitude}
    late = t >= SETTLED
    row["u_y max"] = float(np.ptp(u_y[late])) / 2.0 if late.any() else None
    row["peaks"] = " ".join(f"{value:.3f}" for value in peaks(t, u_y)[-3:])
    try:
        row["noise %"], row["noise rms %"] = (100.0 * value for value in noise(t, lift, SETTLED))
        row["mesh noise %"] = 100.0 * mesh_noise(t, u_y, vertices)
    except (ValueError, IndexError):  # fewer steps than the filter has, or longer ones
        row |= {"noise %": None, "noise rms %": None, "mesh noise %": None}
    return row


def peaks(t: Array, values: Array) -> Array:
    """The upper peaks of a series from SETTLED on."""
    k = np.flatnonzero((values[1:-1] > values[:-2]) & (values[1:-1] >= values[2:]) & (values[1:-1] > 0.0)) + 1
    return np.asarray(values[k[t[k] >= SETTLED]])


def mesh_noise(t: Array, u_y: Array, vertices: Array) -> float:
    """Largest noise of a coordinate of a block vertex (n, v, 2), in terms of the tip's amplitude."""
    late = t >= SETTLED
    amplitude = float(np.ptp(u_y[late])) / 2.0
    paths = vertices[late].reshape(int(late.sum()), -1)
    moving = paths[:, np.ptp(paths, axis=0) > 0.0]
    worst = (noise(t[late], path, SETTLED)[0] * float(np.ptp(path)) / 2.0 for path in moving.T)
    return max(worst) / amplitude


def _mesh(record: StepRecord) -> Any:
    assert record.state.mesh is not None
    return record.state.mesh


def _shape(record: StepRecord) -> dict[str, Array]:
    """The mesh of a step: outlines of its elements and, between nan, of its blocks; quality of its elements."""
    state = _mesh(record)
    gap = np.full((1, 2), np.nan)
    blocks = [part for line in block_outlines(state.mesh, state.structure) for part in (line, gap)]
    return {
        "mesh time": np.array(record.time),
        "elements": element_outlines(state.mesh),
        "blocks": np.concatenate(blocks),
        "scaled Jacobian": scaled_jacobian(state.mesh),
        "equiangular skewness": equiangular_skewness(state.mesh),
    }


def _shown(row: Mapping[str, Any]) -> dict[str, object]:
    names = ("mover", "plane", "dt", "order", "changes", "u_y max", "u_y", "Hz", "lift", "noise %", "noise rms %")
    names += ("mesh noise %", "iterations", "CPU s", "worst scaled Jacobian", "worst skewness", "failure")
    return {name: row[name] for name in names}


def _beside(picture: Path, name: str) -> Path:
    return picture.with_stem(f"{picture.stem}_{name}")


def _file(folder: Path, key: Mapping[str, Any]) -> Path:
    name = "_".join(str(key[name]) for name in KEYS)
    return folder / ("".join(c if c.isalnum() or c in ".-_=" else "-" for c in name) + ".npz")


def _loaded(file: Path) -> dict[str, Array]:
    with np.load(file, allow_pickle=False) as stored:
        return dict(stored)


def main(argv: Sequence[str] | None = None) -> Result:
    """Make the runs that are missing, draw and report all."""
    options = parser(__doc__)
    options.add_argument(
        "--movers", nargs="+", choices=MOVERS, default=["barrier", "pseudo-solid", "angles, published"]
    )
    options.add_argument("--planes", nargs="+", choices=("strain", "stress"), default=["strain"])
    options.add_argument("--dt", nargs="+", type=float, default=[0.005], help="s (default: 0.005)")
    options.add_argument("--orders", nargs="+", type=int, default=[4], help="(default: 4)")
    options.add_argument("--end", type=float, default=7.5, help="s (default: 7.5)")
    options.add_argument("--set", action="append", default=[], dest="changes", metavar="KEY=VALUE")
    options.add_argument("--picture", type=Path, metavar="FILE", help="default beside the result; -meshes, … are added")
    asked = options.parse_args(argv)
    path = asked.json or ROOT / "results" / "wall_ramm.json"
    rows: list[Row] = json.loads(path.read_text(encoding="utf-8"))["rows"] if path.is_file() else []
    keys = [
        {"mover": m, "plane": p, "dt": dt, "order": n, "end": asked.end, "changes": " ".join(asked.changes)}
        for n in asked.orders for dt in asked.dt for p in asked.planes for m in asked.movers
    ]  # fmt: skip
    folder = path.with_suffix("")
    for key in keys:
        if any(all(row[name] == key[name] for name in KEYS) for row in rows):
            continue
        row, series = measure(key)
        folder.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(_file(folder, key), **series)  # type: ignore[arg-type]
        rows.append(row)
        Result("wall_ramm", {}, rows).write(path)
    runs = {key["mover"]: _loaded(_file(folder, key)) for key in keys[: len(asked.movers)]}
    picture = asked.picture or path.with_suffix(".png")
    draw_force_and_tip(runs, picture)
    runs = {mover: run for mover, run in runs.items() if "elements" in run}
    draw_meshes(runs, _beside(picture, "meshes"))
    alike = [row for row in rows if all(row[name] == keys[0][name] for name in ("plane", "dt", "order", "changes"))]
    noisy = {row["mover"]: _loaded(_file(folder, row)) for row in alike if row["noise %"] is not None}
    draw_noise(noisy, _beside(picture, "noise"))
    draw_histograms(runs, _beside(picture, "quality"))
    print(Result("wall_ramm", {}, [_shown(row) for row in rows]).table(), end="\n\n")
    return report(Result("wall_ramm", {}, rows), path)


if __name__ == "__main__":
    main()
