"""Named groups of elements and of element sides, and their legend."""

from __future__ import annotations

from typing import Any

import numpy as np

from hoblock.extras import import_extra
from hoblock.mesh import QuadMesh
from hoblock.plot.colours import EDGE_COLOURS, GROUP_COLOURS
from hoblock.plot.outlines import group_outlines

__all__ = ["draw_edge_groups", "draw_legend", "group_handles"]

_LEGEND_COLUMNS = 6
_LEGEND_ENTRIES = 30


def draw_edge_groups(axes: Any, mesh: QuadMesh) -> list[Any]:
    """Draw named sides in colours; return the legend's entries for those in view."""
    collections = import_extra("matplotlib.collections", "plot")
    lines = import_extra("matplotlib.lines", "plot")
    limits = np.array([axes.get_xlim(), axes.get_ylim()])
    handles = []
    for k, (name, outlines) in enumerate(group_outlines(mesh).items()):
        # When the colours are used up, dashes tell the groups apart.
        style = {
            "color": EDGE_COLOURS[k % len(EDGE_COLOURS)],
            "linestyle": ("-", "--", ":")[k // len(EDGE_COLOURS) % 3],
        }
        met = (outlines.max(axis=1) >= limits[:, 0]) & (outlines.min(axis=1) <= limits[:, 1])
        if not met.all(axis=1).any():
            continue
        axes.add_collection(collections.LineCollection(list(outlines), linewidths=2.0, zorder=4.5, **style))
        handles.append(lines.Line2D([], [], linewidth=2.0, label=_literal(name), **style))
    return handles


def group_handles(mesh: QuadMesh) -> list[Any]:
    """Return the legend's entries for the groups of elements."""
    patches = import_extra("matplotlib.patches", "plot")
    return [
        patches.Patch(
            facecolor=GROUP_COLOURS[k % len(GROUP_COLOURS)], edgecolor="black", linewidth=0.3, label=_literal(name)
        )
        for k, name in enumerate(mesh.cell_groups)
    ]


def draw_legend(figure: Any, handles: list[Any]) -> None:
    """Draw a legend below the axes, none without entries."""
    if not handles:
        return
    shown = handles[:_LEGEND_ENTRIES]
    legend = figure.legend(
        handles=shown, loc="outside lower center", ncols=min(len(shown), _LEGEND_COLUMNS), frameon=False, fontsize=8
    )
    for text in legend.get_texts():
        text.set_parse_math(False)


def _literal(name: str) -> str:
    """Return a label that matplotlib shows: those with a leading underscore it leaves out."""
    return f" {name}" if name.startswith("_") else name
