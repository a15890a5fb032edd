"""FSI2 and FSI3, the swinging flags of Turek and Hron: figures of the last period against FeatFlow's, and their time.

Each run is a scene of examples/ from rest to its end, with the changes that are asked for:

    python benchmarks/flag_oscillations.py fsi3 --orders 4 5 --set time.dt=0.001
    python benchmarks/flag_oscillations.py fsi2 --set 'mover.type="pseudo-solid"'

    python benchmarks/flag_oscillations.py fsi3_ring --like fsi2 --set constants.U=1 --set 'solid[0].density=10000' ...

Without a scene the whole study is made, or another set of runs. Runs are appended to the JSON file; one that is there
already is not made again, so that a study of hours can be made in parts. A picture shows the errors of all runs in the
file against their seconds. Where the environment variable HOFSI_REFERENCE names a folder with FeatFlow's series
ref_fsi2.point and ref_fsi3.point, each run is drawn over them.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from _result import ROOT, Result, parser, report
from hofsi import load_case, run

Array = NDArray[np.float64]

# FeatFlow (TU Dortmund), level 4, FSI2 with dt 0.0005, FSI3 with dt 0.00025; the means of u_y and lift are nearly zero.
REFERENCE = {
    "fsi2": {
        "u_x mean": -14.85e-3,
        "u_x amplitude": 12.70e-3,
        "u_y amplitude": 81.6e-3,
        "drag mean": 215.06,
        "drag amplitude": 77.65,
        "lift amplitude": 237.8,
        "frequency": 1.93,
    },
    "fsi3": {
        "u_x mean": -2.88e-3,
        "u_x amplitude": 2.72e-3,
        "u_y amplitude": 34.99e-3,
        "drag mean": 460.5,
        "drag amplitude": 27.74,
        "lift amplitude": 153.91,
        "frequency": 5.46,
    },
}
# What half the element size changes in FeatFlow's amplitudes, level 3 to 4, relative.
UNCERTAINTY = {
    "fsi2": {"u_x": 0.020, "u_y": 0.011, "drag": 0.025, "lift": 0.013},
    "fsi3": {"u_x": 0.040, "u_y": 0.016, "drag": 0.045, "lift": 0.026},
}
PHASES = ("mesh", "fluid", "solid", "coupling", "quantities", "other")
NAMES = ("u_x", "u_y", "drag", "lift")
FSI2 = ["constants.U=1", "solid[0].density=10000", "solid[0].youngs_modulus=1.4e6", "time.dt=0.005", "time.end=15"]
# The flag of fsi1.toml: two elements across, three at the clamp, 278 + 16 instead of 255 + 7 elements.
FINER = ["mesh.count[3].elements=2", "mesh.count[4].elements=3", "mesh.grading[2].a=3"]
# Scene, whose figures, changes: as shipped; over order and step with the finer flag; the other mover and geometry;
# another layout.
STUDY = [
    *((scene, scene, changes) for changes in ([], FINER) for scene in ("fsi2", "fsi3")),
    *((scene, scene, [*FINER, f"mesh.order={order}"]) for order in (5, 6) for scene in ("fsi2", "fsi3")),
    *(("fsi2", "fsi2", [*FINER, f"time.dt={dt}"]) for dt in (0.0025, 0.00125)),
    *(("fsi3", "fsi3", [*FINER, f"time.dt={dt}"]) for dt in (0.001, 0.0005)),
    *((scene, scene, [*FINER, 'mover.type="pseudo-solid"']) for scene in ("fsi2", "fsi3")),
    ("fsi2", "fsi2", ['coupling.geometry="implicit"']),
    ("fsi3", "fsi3", [*FINER, 'coupling.geometry="implicit"']),
    ("fsi3_ring", "fsi3", ["mesh.order=5"]),
    ("fsi3_ring", "fsi2", [*FSI2, "mesh.order=5"]),
]
# Orders and steps, each coarser and as shipped, for errors over seconds; and two short runs that show how it works.
PRECISION = [
    (scene, scene, [f"mesh.order={order}", f"time.dt={dt}"])
    for scene, dts in (("fsi2", (0.01, 0.005)), ("fsi3", (0.004, 0.002)))
    for order in (3, 4)
    for dt in dts
]
QUICK = [
    ("fsi3", "fsi3", [f"mesh.order={order}", f"time.dt={dt}", "time.end=5"]) for order, dt in ((2, 0.004), (3, 0.008))
]
SETS = {"study": STUDY, "precision": PRECISION, "quick": QUICK}
COLUMNS = {"t": 0, "u_x": 10, "u_y": 11, "drag": (4, 6), "lift": (5, 7)}  # of the series


def measure(scene: str, like: str, changes: Sequence[str], folder: Path) -> dict[str, Any]:
    """One run: its settings, figures of the last period, iterations and seconds."""
    case = load_case(ROOT / "examples" / f"{scene}.toml", [*changes, "output.fields=false", "output.plots=false"])
    load, used = os.getloadavg()[0], process_time()
    result = run(case, folder)
    if result.status != "completed":
        raise SystemExit(f"{scene} {' '.join(changes)}: {result.reason}")
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    counts, seconds = summary["counts"], summary["seconds"]
    row: dict[str, Any] = {
        "scene": scene,
        "reference": like,
        "changes": " ".join(changes),
        "elements": counts["fluid"]["elements"] + counts["solid"]["elements"],
        "unknowns": counts["fluid"]["unknowns"],
        "steps": counts["steps"],
        "iterations": counts["coupling_iterations"] / counts["steps"],
        "seconds": seconds["total"],
        "CPU s": process_time() - used,
        "load before": load,
    }
    row |= {f"{name} ms": 1e3 * seconds[name] / counts["steps"] for name in PHASES}
    for name in NAMES:
        row[f"{name} mean"] = summary["quantities"][name]["mean"]
        row[f"{name} amplitude"] = summary["quantities"][name]["amplitude"]
    row["frequency"] = summary["quantities"]["u_y"]["frequency"]
    return row


def errors(row: Mapping[str, Any]) -> dict[str, float]:
    """Relative differences from the reference; nan where a run was too short for a period."""
    reference = REFERENCE[row["reference"]]
    return {name: _number(row[name]) / value - 1.0 for name, value in reference.items()}


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _short(changes: str) -> str:
    """Changes with names for those of several settings."""
    return changes.replace(" ".join(FINER), "finer flag").replace(" ".join(FSI2), "solid and speed of FSI2")


def shown(row: Mapping[str, Any]) -> dict[str, object]:
    """A run as a line of the table: mean ± amplitude, displacements in mm, and percent off."""
    off = errors(row)
    line: dict[str, object] = {"scene": row["scene"], "changes": _short(row["changes"]), "unknowns": row["unknowns"]}
    for name in NAMES:
        factor, digits = (1e3, 3) if name.startswith("u") else (1.0, 2)
        mean, amplitude = (factor * _number(row[f"{name} {part}"]) for part in ("mean", "amplitude"))
        line[name] = f"{mean:.{digits}f} ± {amplitude:.{digits}f} ({100 * off[f'{name} amplitude']:+.1f} %)"
    line["Hz"] = f"{_number(row['frequency']):.3f} ({100 * off['frequency']:+.1f} %)"
    line["iterations"] = f"{row['iterations']:.2f}"
    line["seconds"] = f"{row['seconds']:.0f} ({row['CPU s']:.0f} CPU)"
    return line


def draw_errors(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Errors of the amplitudes against seconds of the processor, which other jobs on the machine change the least."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    scenes = sorted({row["reference"] for row in rows})
    figure, axes = plt.subplots(len(scenes), 4, figsize=(16, 3.4 * len(scenes)), squeeze=False, layout="constrained")
    for scene, line in zip(scenes, axes, strict=True):
        own = [row for row in rows if row["reference"] == scene]
        for name, axis in zip(NAMES, line, strict=True):
            axis.axhspan(0.0, 100.0 * UNCERTAINTY[scene][name], color="0.92", label="FeatFlow, level 3 to 4")
            for row in own:
                off = 100.0 * abs(errors(row)[f"{name} amplitude"])
                label = f"{row['scene']} {_short(row['changes'])}"
                axis.plot(row["CPU s"], off, "o", label=label)
            axis.set(
                xscale="log", title=f"{scene}: amplitude of {name}", xlabel="CPU seconds", ylabel="difference in %"
            )
            axis.set_ylim(bottom=0.0)
        line[-1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.02, 0.5))
    figure.savefig(path, dpi=130)
    plt.close(figure)


def reference_series(scene: str) -> dict[str, Array] | None:
    """FeatFlow's series, from the folder HOFSI_REFERENCE; None if it is not there."""
    folder = os.environ.get("HOFSI_REFERENCE")
    path = Path(folder) / f"ref_{scene}.point" if folder else None
    if path is None or not path.is_file():
        print(f"FeatFlow's series of {scene} are absent: HOFSI_REFERENCE does not name a folder with ref_{scene}.point")
        return None
    table = np.loadtxt(path)
    return {name: table[:, list(np.atleast_1d(columns))].sum(axis=1) for name, columns in COLUMNS.items()}


def draw_overlay(series: Mapping[str, Array], reference: Mapping[str, Array], title: str, path: Path) -> None:
    """The last two periods of a run over those of the reference, each from an upward crossing of u_y on."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    ends = [_last_crossings(part["t"], part["u_y"]) for part in (series, reference)]
    figure, axes = plt.subplots(4, 1, figsize=(9, 9), sharex=True, layout="constrained")
    for name, axis in zip(NAMES, axes, strict=True):
        for part, (start, stop), style in zip((reference, series), reversed(ends), ("k-", "C1--"), strict=True):
            inside = (part["t"] >= start) & (part["t"] <= stop)
            axis.plot(part["t"][inside] - start, part[name][inside], style, lw=1.2)
        axis.set_ylabel(name)
    axes[0].set_title(title)
    axes[0].legend(["FeatFlow, level 4", "here"], loc="upper right")
    axes[-1].set_xlabel("time since the flag's middle position, s")
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _last_crossings(t: Array, u: Array) -> tuple[float, float]:
    """Times of the last upward crossing of the mean but two, and of the last one."""
    v = u - 0.5 * (u[-len(u) // 4 :].max() + u[-len(u) // 4 :].min())
    k = np.flatnonzero((v[:-1] < 0.0) & (v[1:] >= 0.0))
    times = t[k] - v[k] * (t[k + 1] - t[k]) / (v[k + 1] - v[k])
    return float(times[-3]), float(times[-1])


def main(argv: Sequence[str] | None = None) -> Result:
    """Make the runs that are missing and report all."""
    options = parser(__doc__)
    options.add_argument(
        "scene", nargs="?", help="name of a scene in examples/: fsi2, fsi3, ...; default: the whole study"
    )
    options.add_argument("--runs", choices=SETS, default="study", help="without a scene (default: %(default)s)")
    options.add_argument("--like", choices=REFERENCE, help="whose figures to compare with; default that of its name")
    options.add_argument("--orders", type=int, nargs="+", default=[None], help="mesh.order of each run")
    options.add_argument("--set", action="append", default=[], dest="changes", metavar="KEY=VALUE")
    options.add_argument("--picture", type=Path, metavar="FILE", help="default beside the result")
    asked = options.parse_args(argv)
    path = asked.json or ROOT / "results" / "flag_oscillations.json"
    rows: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["rows"] if path.is_file() else []
    picture = asked.picture or path.with_suffix(".png")
    runs: Sequence[tuple[str, str, list[str]]] = SETS[asked.runs]
    if asked.scene is not None:
        like = asked.like or asked.scene.split("_")[0]
        orders = [[] if order is None else [f"mesh.order={order}"] for order in asked.orders]
        runs = [(asked.scene, like, [*order, *asked.changes]) for order in orders]
    for scene, like, changes in runs:
        if any((row["scene"], row["changes"]) == (scene, " ".join(changes)) for row in rows):
            continue
        with tempfile.TemporaryDirectory() as folder:
            rows.append(measure(scene, like, changes, Path(folder)))
            series = _series(Path(folder) / "quantities.csv")
        Result("flag_oscillations", {}, rows).write(path)
        reference = reference_series(like)
        if reference is not None:
            name = "_".join([scene, *(change.replace("=", "-") for change in changes)]).replace('"', "")
            draw_overlay(series, reference, " ".join([scene, *changes]), picture.with_name(f"{name}.png"))
    draw_errors(rows, picture)
    print(Result("flag_oscillations", {}, [shown(row) for row in rows]).table(), end="\n\n")
    return report(Result("flag_oscillations", {}, rows), path)


def _series(path: Path) -> dict[str, Array]:
    table = np.genfromtxt(path, delimiter=",", names=True)
    return {name: np.asarray(table[name]) for name in ("t", *NAMES)}


if __name__ == "__main__":
    main()
