"""Regime of the coupling: iterations a step and failures over density ratio, stiffness and step.

Two scenes: a pressure pulse between thin walls (examples/pressure_pulse.toml, coarser) and a stocky block in a channel
(coupling_regime.toml). The load sets in smoothly within the run and grows with the stiffness, so that displacements are
of one order. Each point is computed with every accelerator alone, and with the solid solved together with the condensed
fluid, on extrapolated and on implicit geometry. Steps are not halved: a run ends with the first that fails.

Completed runs are compared, by the largest difference of the last displacements and velocities relative to the largest
of them: `difference` from the condensed coupling on the same geometry, `geometry difference` from the same mode on
extrapolated geometry. Runs that differ from the condensed one by more than 10 tolerances of the coupling are listed.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from operator import itemgetter
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from _result import ROOT, Result, parser
from hofsi import build, load_case, simulate
from hofsi.errors import CouplingError
from hofsi.records import StepRecord

Array = NDArray[np.float64]
Row = dict[str, Any]
Fields = tuple[Array, Array]  # displacement of the solid, velocity of the fluid

DENSITIES = (10.0, 1.0, 0.1, 0.01)  # ρ_s/ρ_f
FACTORS = (0.1, 1.0, 10.0)  # of the scene's stiffness and step
CONDENSED = "condensed"
MODES = {
    "aitken": ["condensed=false", "acceleration=aitken"],
    "iqn-ils": ["condensed=false", "acceleration=iqn-ils"],
    "imvj": ["condensed=false", "acceleration=imvj"],
    CONDENSED: ["condensed=true", "acceleration=iqn-ils"],  # the defaults
}
GEOMETRIES = ("extrapolated", "implicit")
VARIANTS = tuple(itertools.product(MODES, GEOMETRIES))
LIMIT = 50  # coupling iterations a step, and tolerance of the displacement: the defaults
TOLERANCE = 1e-6
SUSPICIOUS = 10.0 * TOLERANCE
WORDS = {"max_iterations": "limit", "geometry": "gap", "MeshMotionError": "mesh", "NewtonError": "Newton"}


@dataclass(frozen=True)
class Point:
    """Density ratio, and factors of the scene's stiffness and step."""

    density: float
    stiffness: float
    dt: float


@dataclass(frozen=True)
class Scene:
    """A scene file, its step, the length displacements are measured by, and what a point changes but for time."""

    file: Path
    dt: float
    length: float
    changes: Callable[[Point], list[str]]


def _pulse(point: Point) -> list[str]:
    mesh = ["mesh.order=2", "mesh.count[0].elements=1"]
    load = [f"constants.P={2e4 * point.stiffness!r}", "fluid.boundary[0].traction_x=P*sin(pi*t/T)**2"]
    wall = [f"solid[0].density={point.density!r}", f"solid[0].youngs_modulus={0.75e6 * point.stiffness!r}"]
    tissue = [f"solid[1].density={0.01 * point.density!r}", f"solid[1].youngs_modulus={1.88088e5 * point.stiffness!r}"]
    return [*mesh, *load, *wall, *tissue]


def _block(point: Point) -> list[str]:
    solid = [f"solid[0].density={point.density!r}", f"solid[0].youngs_modulus={200.0 * point.stiffness!r}"]
    return [f"constants.U={point.stiffness**0.5!r}", *solid]


SCENES = {
    "pulse": Scene(ROOT / "examples" / "pressure_pulse.toml", 1e-4, 0.5, _pulse),
    "block": Scene(ROOT / "benchmarks" / "coupling_regime.toml", 0.05, 0.5, _block),
}


def changes_of(scene: Scene, point: Point, mode: str, geometry: str, steps: int) -> list[str]:
    """What a run changes in its scene file."""
    dt = scene.dt * point.dt
    time = [f"time.dt={dt!r}", f"time.steps={steps}", "time.halvings=0", f"constants.T={steps * dt!r}"]
    coupling = [f"geometry={geometry}", f"max_iterations={LIMIT}", f"tolerance={TOLERANCE!r}", *MODES[mode]]
    return [*scene.changes(point), *time, *(f"coupling.{key}" for key in coupling)]


def march(file: Path, changes: Sequence[str]) -> tuple[list[StepRecord], Exception | None]:
    """The steps of a run, and the error that it ended with, if any."""
    records: list[StepRecord] = []
    try:
        for record in simulate(build(load_case(file, changes))):
            records.append(record)
    except Exception as error:  # noqa: BLE001 - what no run should end with is a finding and must not end the study
        return records, error
    return records, None


def outcome_of(error: Exception | None) -> str:
    """A word for how a run ended."""
    word = error.reason if isinstance(error, CouplingError) else type(error).__name__
    return "completed" if error is None else WORDS.get(word, word)


def measure(scene: Scene, changes: Sequence[str]) -> tuple[Row, Fields | None]:
    """The row of a run, without its point, and its last fields if it was completed."""
    start = process_time()
    records, error = march(scene.file, changes)
    fields = [(r.state.solid.displacement, r.state.fluid.velocity) for r in records if r.state.solid and r.state.fluid]
    iterations = [r.coupling.iterations for r in records if r.coupling]
    row = {
        "steps": len(records),
        "iterations": float(np.mean(iterations)) if iterations else None,
        "outcome": outcome_of(error),
        "displacement": max((float(np.abs(d).max()) for d, _ in fields), default=0.0) / scene.length,
        "CPU s": process_time() - start,
        "error": "" if error is None else type(error).__name__,
        "message": "" if error is None else str(error),
    }
    return row, None if error else fields[-1]


def difference(a: Fields | None, b: Fields | None) -> float | None:
    """Largest difference of two runs relative to the largest value, the larger one of both fields."""
    if a is None or b is None:
        return None
    return max(float(np.abs(x - y).max() / max(np.abs(x).max(), np.abs(y).max())) for x, y in zip(a, b, strict=True))


def measure_point(name: str, point: Point, steps: int) -> list[Row]:
    """The rows of a point, one a variant."""
    scene = SCENES[name]
    found = {v: measure(scene, changes_of(scene, point, *v, steps)) for v in VARIANTS}
    rows = []
    for (mode, geometry), (row, fields) in found.items():
        key = {"scene": name, **asdict(point), "mode": mode, "geometry": geometry}
        others = {"difference": (CONDENSED, geometry), "geometry difference": (mode, GEOMETRIES[0])}
        rows.append(key | row | {what: difference(fields, found[other][1]) for what, other in others.items()})
    return rows


def tables(rows: Sequence[Row]) -> str:
    """A Markdown table a scene: mean iterations a step, or why a run failed, by point and variant."""
    heads = [f"{mode}, {geometry[:3]}." for mode, geometry in VARIANTS]
    parts = []
    for name in dict.fromkeys(row["scene"] for row in rows):
        lines = [["ρ_s/ρ_f", "stiffness", "dt", *heads], ["---:"] * (3 + len(heads))]
        own = [row for row in rows if row["scene"] == name]
        for point, cells in itertools.groupby(own, itemgetter("density", "stiffness", "dt")):
            lines.append([*(f"{value:g}" for value in point), *(_cell(row) for row in cells)])
        parts.append("\n".join([f"**{name}**", "", *("| " + " | ".join(line) + " |" for line in lines)]))
    return "\n\n".join(parts)


def _cell(row: Row) -> str:
    return f"{row['iterations']:.1f}" if row["outcome"] == "completed" else f"{row['outcome']} ({row['steps']})"


def suspicious(rows: Iterable[Row]) -> list[str]:
    """Completed runs that found something else than the condensed coupling did on the same geometry."""
    return [
        f"{row['scene']}, ρ_s/ρ_f = {row['density']:g}, stiffness {row['stiffness']:g}, dt {row['dt']:g}, "
        f"{row['mode']}, {row['geometry']}: differs by {row['difference']:.1e}"
        for row in rows
        if row["difference"] is not None and row["difference"] > SUSPICIOUS
    ]


def draw(rows: Sequence[Row], path: Path) -> None:
    """Heat maps of iterations over density ratio and stiffness; failed runs are crossed out."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.colors import LogNorm

    columns = list(dict.fromkeys((row["scene"], row["dt"]) for row in rows))
    size = (2.2 * len(columns) + 1.5, 1.35 * len(VARIANTS) + 0.8)
    figure, axes = plt.subplots(len(VARIANTS), len(columns), figsize=size, squeeze=False, layout="constrained")
    for (mode, geometry), line in zip(VARIANTS, axes, strict=True):
        for (scene, dt), axis in zip(columns, line, strict=True):
            wanted = (scene, dt, mode, geometry)
            own = [row for row in rows if (row["scene"], row["dt"], row["mode"], row["geometry"]) == wanted]
            image = _heat_map(axis, own, LogNorm(2.0, LIMIT))
            axis.set_title(f"{scene}, dt × {dt:g}" if axis in axes[0] else "", fontsize=9)
            axis.tick_params(labelbottom=axis in axes[-1], labelleft=axis in axes[:, 0], labelsize=7)
        line[0].set_ylabel(f"{mode}\n{geometry}\n\nstiffness ×", fontsize=8)
    figure.supxlabel("ρ_s/ρ_f", fontsize=9)
    label, ticks = "mean coupling iterations a step; ×: failed", [2, 3, 5, 10, 20, LIMIT]
    bar = figure.colorbar(image, ax=axes, label=label, ticks=ticks, format="%g", shrink=0.5, aspect=40)
    bar.minorticks_off()
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _heat_map(axis: Any, rows: Sequence[Row], norm: Any) -> Any:
    densities, factors = (sorted({row[name] for row in rows}) for name in ("density", "stiffness"))
    values = np.full((len(factors), len(densities)), np.nan)
    for row in rows:
        i, j = factors.index(row["stiffness"]), densities.index(row["density"])
        if row["outcome"] == "completed":
            values[i, j] = row["iterations"]
            color = "white" if values[i, j] < 15.0 else "black"
            axis.text(j, i, f"{values[i, j]:.1f}", ha="center", va="center", fontsize=7, color=color)
        else:
            axis.text(j, i, "×", ha="center", va="center", fontsize=13, color="crimson")
    axis.set_xticks(range(len(densities)), [f"{value:g}" for value in densities])
    axis.set_yticks(range(len(factors)), [f"{value:g}" for value in factors])
    axis.set_facecolor("0.88")
    return axis.imshow(values, norm=norm, cmap="viridis", origin="lower", aspect="auto")


def main(argv: Sequence[str] | None = None) -> Result:
    """Make all runs and report them."""
    options = parser(__doc__)
    options.add_argument("--scenes", nargs="+", choices=list(SCENES), default=list(SCENES), help="both by default")
    options.add_argument("--steps", type=int, help="of a run (default: 10, quick 4)")
    options.add_argument("--quick", action="store_true", help="two density ratios, one stiffness and step")
    options.add_argument("--densities", type=float, nargs="+", help="ratios (default: 10 to 0.01)")
    options.add_argument("--picture", type=Path, metavar="FILE", help="default beside the result")
    given = options.parse_args(argv)
    densities, factors, steps = ((10.0, 0.01), (1.0,), 4) if given.quick else (DENSITIES, FACTORS, 10)
    densities, steps = given.densities or densities, given.steps or steps
    path = given.json or ROOT / "results" / "coupling_regime.json"
    rows: list[Row] = []
    result = Result("coupling_regime", {"scenes": given.scenes, "steps": steps, "limit": LIMIT}, rows)
    for name, values in itertools.product(given.scenes, itertools.product(densities, factors, factors)):
        rows += measure_point(name, Point(*values), steps)
        result.write(path)
        print(name, values, ", ".join(_cell(row) for row in rows[-len(VARIANTS) :]), flush=True)
    draw(rows, given.picture or path.with_suffix(".png"))
    print("", tables(rows), "", *(suspicious(rows) or ["All completed runs agree."]), sep="\n")
    print(f"\nwrote {path}, {len(rows)} rows with the columns {', '.join(rows[0])}")
    return result


if __name__ == "__main__":
    main()
