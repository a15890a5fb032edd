"""Histograms of element quality with the flap's tip at 1.3 cm, for all block movers (the paper's Figs 7 and 8).

The flap of WR is raised to its benchmark deflection in equal steps. Scaled Jacobian, Jacobian ratio (what the
literature of high-order meshes calls scaled Jacobian) and equiangular skewness of all elements.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from _result import ROOT, Result, parser, report
from hoblock import HoblockError, QuadMesh, equiangular_skewness, jacobian_ratio, scaled_jacobian
from motion_cases import motion_case
from motion_contest.contestants import chosen
from motion_contest.journey import MARKS

Array = NDArray[np.float64]
MEASURES = {
    "scaled Jacobian": (scaled_jacobian, True),
    "Jacobian ratio": (jacobian_ratio, True),
    "equiangular skewness": (equiangular_skewness, False),
}


def draw(values: dict[str, dict[str, Array]], file: Path) -> Path:
    """One row a mover, one column a measure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 1.45 * len(values)), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(len(values), len(MEASURES), sharex="col", sharey="col", squeeze=False)
    for row, (name, of_mover) in zip(grid, values.items(), strict=True):
        for axes, (measure, elements) in zip(row, of_mover.items(), strict=True):
            axes.hist(elements, bins=np.linspace(0.0, 1.0, 41), color="tab:blue")
            worst = elements.min() if MEASURES[measure][1] else elements.max()
            axes.axvline(worst, color="tab:red", linewidth=0.8)
            text = f"worst {worst:.3f}, mean {elements.mean():.3f}"
            axes.text(0.5, 0.92, text, transform=axes.transAxes, fontsize=7, va="top", ha="center")
            axes.set_yscale("log")
        row[0].set_ylabel(name.replace(", ", ",\n", 1), fontsize=7)
    for axes, measure in zip(grid[-1], MEASURES, strict=True):
        axes.set_xlabel(measure)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=120)
    return file


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--order", type=int, default=4)
    options.add_argument("--elements", type=int, default=3, help="along each block edge (default: %(default)s)")
    options.add_argument("--steps", type=int, default=30, help="to the deflection (default: %(default)s)")
    options.add_argument("--layout", default="f4", choices=["f4", "f1"])
    options.add_argument("--picture", type=Path, default=ROOT / "results" / "mesh_motion_histograms.png")
    given = options.parse_args(argv)
    case = motion_case("WR", given.layout, given.elements)
    rows: list[dict[str, object]] = []
    values: dict[str, dict[str, Array]] = {}
    for one in chosen(["blocks"], None):
        _, start, move = one.begin(case, given.order)
        mesh: QuadMesh | None = None
        try:
            for s in np.linspace(0.0, MARKS["WR"], given.steps + 1)[1:]:
                mesh = move(case.motion(start, s))
        except HoblockError:
            mesh = None
        row: dict[str, object] = {"mover": one.name}
        if mesh is not None:
            values[one.name] = {name: measure(mesh) for name, (measure, _) in MEASURES.items()}
        for name, (_, high_is_good) in MEASURES.items():
            found = None if mesh is None else values[one.name][name]
            row[f"worst {name}"] = "invalid" if found is None else float(found.min() if high_is_good else found.max())
            row[f"mean {name}"] = "" if found is None else float(found.mean())
        rows.append(row)
    print(draw(values, given.picture))
    settings = {name: getattr(given, name) for name in ("order", "elements", "steps", "layout")}
    return report(Result("mesh_motion_histograms", settings, rows), given.json)


if __name__ == "__main__":
    main()
