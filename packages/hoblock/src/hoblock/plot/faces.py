"""Elements drawn as curved polygons in colours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.extras import import_extra
from hoblock.mesh import QuadMesh
from hoblock.plot.colours import INVALID, MEASURES, UNDECIDED, Verdicts, group_colours, verdicts
from hoblock.plot.outlines import element_outlines

Array = NDArray[np.float64]

__all__ = ["draw_elements", "draw_faces"]


def _line_widths(outlines: Array, scale: float) -> Array:
    """Widths in points, thinner for elements whose thickness in the drawing is small: layers do not turn black."""
    x, y = outlines[..., 0], outlines[..., 1]
    area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1))
    box = np.hypot(*(outlines.max(axis=1) - outlines.min(axis=1)).T)
    return np.asarray(np.clip(0.08 * scale * area / np.maximum(box, 1e-300), 0.04, 0.35))


def draw_faces(axes: Any, mesh: QuadMesh, seen: NDArray[np.bool_]) -> None:
    """Elements in the colours of their groups, without lines."""
    collections = import_extra("matplotlib.collections", "plot")
    colours = np.array(group_colours(mesh))[seen].tolist()
    # Lines of the same colour close the hair cracks between faces.
    faces = collections.PolyCollection(
        element_outlines(mesh)[seen], facecolors=colours, edgecolors=colours, linewidths=0.4
    )
    axes.add_collection(faces)


def draw_elements(
    figure: Any, axes: Any, mesh: QuadMesh, seen: NDArray[np.bool_], color: str | None, scale: float
) -> None:
    """Draw the elements in view, coloured by a measure or, without, by group; ``scale`` is points a unit length."""
    collections = import_extra("matplotlib.collections", "plot")
    outlines = element_outlines(mesh)
    widths = _line_widths(outlines, scale)
    bad = verdicts(mesh)
    good = seen.copy()
    good[np.concatenate([bad.invalid, bad.undecided])] = False
    if color is None:
        colours = np.array(group_colours(mesh))[good].tolist()
        axes.add_collection(
            collections.PolyCollection(outlines[good], facecolors=colours, edgecolors="black", linewidths=widths[good])
        )
        if bad.describe():
            axes.set_title("\n".join(filter(None, [axes.get_title(), bad.describe()])))
    else:
        _draw_measure(figure, axes, mesh, good, color, (outlines, widths), bad.describe())
    _draw_bad(axes, outlines, widths, bad)


def _draw_measure(
    figure: Any,
    axes: Any,
    mesh: QuadMesh,
    good: NDArray[np.bool_],
    color: str,
    shapes: tuple[Array, Array],
    bad: str,
) -> None:
    collections = import_extra("matplotlib.collections", "plot")
    measure = MEASURES[color]
    values = measure.values(mesh)
    outlines, widths = shapes
    colours = import_extra("matplotlib", "plot").colormaps[measure.colours]
    patches = collections.PolyCollection(
        outlines[good], array=values[good], cmap=colours, edgecolors="black", linewidths=widths[good]
    )
    finite = values[np.isfinite(values)]
    lowest, highest = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    low, high = (lowest, highest) if measure.limits is None else measure.limits
    high = high if high > low else 2.0 * abs(low) + 1.0  # one colour needs an interval, too
    scales = import_extra("matplotlib.colors", "plot")
    patches.set_norm((scales.LogNorm if measure.logarithmic else scales.Normalize)(low, high))
    axes.add_collection(patches)
    label = ", ".join(filter(None, [measure.label, bad]))
    bar = figure.colorbar(
        patches,
        ax=axes,
        orientation="horizontal",
        shrink=0.5,
        aspect=40,
        pad=0.02,
        label=f"{label}: {lowest:.3g} to {highest:.3g}",
    )
    if measure.logarithmic:
        ticks = [m * 10.0**k for k in range(-3, 16) for m in (1, 2, 5) if low <= m * 10.0**k <= high]
        step = 1 + len(ticks) // 12
        bar.set_ticks(ticks[::step], labels=[f"{tick:g}" for tick in ticks[::step]], minor=False)
        bar.minorticks_off()


def _draw_bad(axes: Any, outlines: Array, widths: Array, bad: Verdicts) -> None:
    """Invalid elements red, undecided ones orange, and rings round the worst places."""
    collections = import_extra("matplotlib.collections", "plot")
    for elements, colour in ((bad.undecided, UNDECIDED), (bad.invalid, INVALID)):
        finite = elements[np.isfinite(outlines[elements]).all(axis=(1, 2))]
        axes.add_collection(
            collections.PolyCollection(
                outlines[finite], facecolors=colour, edgecolors="black", linewidths=widths[finite], zorder=3
            )
        )
    if len(bad.worst):
        x, y = bad.worst.T
        axes.plot(
            x, y, "o", markersize=9, markerfacecolor="none", markeredgecolor="black", markeredgewidth=0.8, zorder=6
        )
