"""Quantities over time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hofsi.plot.canvas import TITLE_SIZE, new_figure, save

Array = NDArray[np.float64]

__all__ = ["plot_series"]

_WIDTH = 10.0
_PANEL, _MARGIN = 1.6, 1.1  # inches
_MANY = 50  # values, below which no peak is cut off
_FLATTENED = 6.0  # peaks this many times larger than all the rest are cut off
_TAKEN = ("mesh", "velocity", "pressure", "displacement", "quantities")


def plot_series(
    series: Mapping[str, Array], directory: Path, title: str, first: str | None, *, alone: str | None
) -> list[Path]:
    """Draw ``quantities.png`` with all quantities above each other, and one of them in a file of its own.

    Parameters
    ----------
    series : mapping of str to ndarray, shape (n,)
        By name, with the times as ``"t"``.
    directory : Path
    title : str
    first : str or None
        The quantity on top, drawn larger.
    alone : str or None
        The quantity with a file of its own, ``NAME.png``; ``NAME_over_time.png`` if another picture has that name.

    Raises
    ------
    ValueError
        If the series have different lengths.
    """
    times = series["t"]
    names = sorted((name for name in series if name != "t"), key=lambda name: name != first)
    for name in names:
        if len(series[name]) != len(times):
            raise ValueError(
                f"series {name!r} has {len(series[name])} values; expected {len(times)}, one for each time."
            )
    heights = [2.0 if name == first else 1.0 for name in names]
    written = [_draw(series, names, heights, title, directory / "quantities.png")]
    if alone in names:
        file = f"{alone}_over_time.png" if alone in _TAKEN else f"{alone}.png"
        written.append(_draw(series, [alone], [3.0], title, directory / file))
    return written


def _draw(series: Mapping[str, Array], names: list[str], heights: list[float], title: str, path: Path) -> Path:
    figure = new_figure(_WIDTH, _MARGIN + _PANEL * sum(heights))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    times = series["t"]
    for axes, name, height in zip(panels, names, heights, strict=True):
        _panel(axes, times, series[name], height > 1.0)
        axes.set_ylabel(name, fontsize=11)
    if len(times) > 1:
        panels[-1].set_xlim(times[0], times[-1])
    panels[-1].set_xlabel("t", fontsize=11)
    if title:
        panels[0].set_title(title, fontsize=TITLE_SIZE, loc="left")
    return save(figure, path)


def _panel(axes: Any, times: Array, values: Array, large: bool) -> None:
    marker = "o" if len(times) < 20 else ""
    axes.plot(
        times,
        values,
        color="#1f4e8c" if large else "0.25",
        linewidth=1.3 if large else 1.0,
        marker=marker,
        markersize=3,
    )
    axes.grid(color="0.9", linewidth=0.6)
    axes.tick_params(labelsize=9)
    axes.ticklabel_format(axis="y", style="sci", scilimits=(-3, 4), useOffset=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    limits = _limits(values)
    if limits is not None:
        axes.set_ylim(limits)
        axes.text(
            0.99,
            0.95,
            f"from {np.nanmin(values):.4g} to {np.nanmax(values):.4g}: peaks are cut off",
            fontsize=9,
            color="0.4",
            ha="right",
            va="top",
            transform=axes.transAxes,
        )


def _limits(values: Array) -> tuple[float, float] | None:
    """Limits that leave out short peaks, as after an impulsive start, if these would flatten all the rest."""
    finite = values[np.isfinite(values)]
    if finite.size < _MANY:
        return None
    low, high = (float(q) for q in np.quantile(finite, (0.03, 0.97)))
    margin = 0.25 * (high - low)
    if margin == 0.0 or np.ptp(finite) < _FLATTENED * (high - low):
        return None
    return low - margin, high + margin
