"""The paper's Figs 5 to 8 of runs of the flap of Wall and Ramm."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from _force_noise import SETTLED, high_passed

Array = NDArray[np.float64]
Runs = Mapping[str, Mapping[str, Array]]

_VIEW = (3.6, 11.2, 3.4, 8.6)
_STYLES = ("-", "--", ":", "-.")


def draw_force_and_tip(runs: Runs, path: Path) -> None:
    """Fig. 5: force and tip displacement of all runs over each other, whole and the last 1.2 s."""
    figure = _figure(10.0, 5.4)
    grid = figure.subplots(2, 2, sharex="col", width_ratios=(1.5, 1.0), squeeze=False)
    for row, (name, label) in zip(grid, (("lift", "vertical force, dyn/cm"), ("u_y", "tip, cm")), strict=True):
        for (mover, run), style in zip(runs.items(), _STYLES, strict=False):
            last = run["t"] >= run["t"][-1] - 1.2
            row[0].plot(run["t"], run[name], style, linewidth=0.7, label=mover)
            row[1].plot(run["t"][last], run[name][last], style, linewidth=1.1, label=mover)
        row[0].set_ylabel(label)
        early = [run[name][run["t"] > 0.1] for run in runs.values()]  # the impulsive start is far above the rest
        largest = max((float(np.abs(values).max()) for values in early if values.size), default=1.0)
        for axes in row:
            axes.set_ylim(-1.1 * largest, 1.1 * largest)
            axes.grid(alpha=0.3)
    figure.legend(*grid[0, 1].get_legend_handles_labels(), fontsize=8, loc="outside upper center", ncols=4)
    for axes in grid[-1]:
        axes.set_xlabel("t, s")
    _save(figure, path)


def draw_meshes(runs: Runs, path: Path) -> None:
    """Fig. 6: the meshes at the last upper peak of the tip."""
    from matplotlib.collections import LineCollection

    figure = _figure(4.2 * max(len(runs), 1), 3.3)
    for axes, (mover, run) in zip(figure.subplots(1, max(len(runs), 1), squeeze=False)[0], runs.items(), strict=False):
        closed = np.concatenate([run["elements"], run["elements"][:, :1]], axis=1)
        axes.add_collection(LineCollection(list(closed), linewidths=0.25, colors="tab:blue"))
        axes.plot(*run["blocks"].T, "k-", linewidth=0.6)
        axes.set(xlim=_VIEW[:2], ylim=_VIEW[2:], aspect="equal", title=f"{mover}, t = {float(run['mesh time']):.3f} s")
        axes.title.set_size(9)
        axes.tick_params(labelsize=7)
    _save(figure, path)


def draw_histograms(runs: Runs, path: Path) -> None:
    """Figs 7 and 8: scaled Jacobian and equiangular skewness of the elements of these meshes."""
    figure = _figure(9.0, 1.6 * max(len(runs), 1) + 0.4)
    names = ("scaled Jacobian", "equiangular skewness")
    grid = figure.subplots(max(len(runs), 1), 2, sharex="col", sharey="col", squeeze=False)
    for row, (mover, run) in zip(grid, runs.items(), strict=False):
        for axes, name in zip(row, names, strict=True):
            values = run[name]
            worst = values.min() if name == names[0] else values.max()
            axes.hist(values, bins=np.linspace(0.0, 1.0, 41), color="tab:blue")
            axes.axvline(worst, color="tab:red", linewidth=0.8)
            text = f"worst {worst:.3f}, mean {values.mean():.3f}"
            side = (0.03, "left") if name == names[0] else (0.97, "right")
            axes.text(side[0], 0.9, text, transform=axes.transAxes, fontsize=8, va="top", ha=side[1])
            axes.set_yscale("log")
        row[0].set_ylabel(f"{mover}\nelements", fontsize=8)
    for axes, name in zip(grid[-1], names, strict=True):
        axes.set_xlabel(name)
    _save(figure, path)


def draw_noise(runs: Runs, path: Path) -> None:
    """What force and the noisiest block vertex have above the cutoff, both in percent of the amplitude."""
    figure = _figure(2.4 * max(len(runs), 2), 4.0)
    grid = figure.subplots(2, max(len(runs), 1), sharex=True, sharey="row", squeeze=False)
    for column, (mover, run) in zip(grid.T, runs.items(), strict=False):
        t = run["t"]
        paths = run["vertices"].reshape(len(t), -1)
        high = np.stack([high_passed(t, path)[1] for path in paths.T])
        late = slice(np.searchsorted(t, SETTLED), None)
        worst = int(np.abs(high[:, late]).max(axis=1).argmax())
        times, force = high_passed(t, run["lift"])
        for axes, values, of in zip(column, (force, high[worst]), (run["lift"], run["u_y"]), strict=True):
            axes.plot(times, 200.0 * values / np.ptp(of[late]), linewidth=0.5)
            axes.set_xlim(SETTLED, max(run["t"][-1] for run in runs.values()))
            axes.grid(alpha=0.3)
        column[0].set_title(mover, size=9)
        column[1].set_xlabel("t, s")
    grid[0, 0].set_ylabel("force, %")
    grid[1, 0].set_ylabel("block vertex, %")
    for row in grid:
        row[0].set_ylim(*_limits(row))
    _save(figure, path)


def _limits(row: Any) -> tuple[float, float]:
    """Limits of axes that hold what is in view, not the start."""
    largest = 1e-3
    for axes in row:
        for line in axes.lines:
            t, values = line.get_data()
            largest = max(largest, float(np.abs(values[t >= SETTLED]).max(initial=0.0)))
    return -1.1 * largest, 1.1 * largest


def _figure(width: float, height: float) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _save(figure: Any, path: Path) -> None:
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    with Image.open(path) as image:  # a third of the bytes
        few = image.convert("RGB").quantize(64)
    few.save(path, optimize=True)
