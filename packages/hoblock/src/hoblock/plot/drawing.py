"""Meshes drawn into files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError
from hoblock.extras import import_extra
from hoblock.mesh import QuadMesh
from hoblock.plot.colours import MEASURES
from hoblock.plot.faces import draw_elements, draw_faces
from hoblock.plot.groups import draw_edge_groups, draw_legend, group_handles
from hoblock.plot.labels import Labels
from hoblock.plot.outlines import block_outlines, boundary_sides, element_outlines, side_outlines

Array = NDArray[np.float64]

__all__ = ["plot_mesh"]

_SUFFIXES = (".pdf", ".png", ".svg")


def plot_mesh(
    mesh: QuadMesh,
    path: str | Path,
    *,
    structure: BlockStructure | None = None,
    color: str | None = "scaled_jacobian",
    vertex_names: bool = False,
    counts: bool = False,
    element_numbers: bool = False,
    nodes: bool = False,
    edge_groups: bool = True,
    blocks_only: bool = False,
    zoom: tuple[float, float, float, float] | None = None,
    title: str = "",
    width: float = 10.0,
    dpi: int = 200,
) -> None:
    """Draw a mesh into a file.

    Parameters
    ----------
    mesh : QuadMesh
    path : str or Path
        Ends in ``.png``, ``.svg`` or ``.pdf``.
    structure : BlockStructure, optional
        The structure the mesh was made from; its edges are drawn thicker.
    color : str, optional
        Measure that colours the elements, one of ``MEASURES``. None colours the groups of elements. Invalid elements
        are red and undecided ones orange in all of them; rings mark the worst places.
    vertex_names, counts : bool
        Write the names of the block vertices, and the number of elements on each block edge; need ``structure``. Texts
        that would cover others are left out, and the drawing says how many.
    element_numbers : bool
        Write the numbers of the elements.
    nodes : bool
        Draw the nodes of the elements.
    edge_groups : bool
        Draw the named groups of element sides in colours, with a legend.
    blocks_only : bool
        Draw no elements, but the blocks in the colours of their groups; needs ``structure``.
    zoom : (float, float, float, float), optional
        Draw the part x0 ≤ x ≤ x1, y0 ≤ y ≤ y1 only.
    title : str
        Written above.
    width : float
        Of the drawing, in inches; the height follows from the mesh.
    dpi : int
        Pixels an inch, for ``.png``.

    Raises
    ------
    MeshFileError
        If the suffix is unknown.
    ValueError
        If the colour is unknown, blocks are asked for without structure, or the part to draw is empty.
    MissingExtraError
        If matplotlib is not installed.
    """
    path = Path(path)
    if path.suffix.lower() not in _SUFFIXES:
        raise MeshFileError(f"{path}: suffix is {path.suffix!r}; expected one of {', '.join(_SUFFIXES)}.")
    _check(color, structure, zoom, vertex_names=vertex_names, counts=counts, blocks_only=blocks_only)
    view = _view(mesh, zoom)
    figure, axes = _canvas(view, width, title)
    seen = _seen(mesh, view)
    if blocks_only:
        draw_faces(axes, mesh, seen)
    else:
        draw_elements(figure, axes, mesh, seen, color, 0.9 * 72 * width / (view[1] - view[0]))
    if nodes:
        _draw_nodes(axes, mesh.points[np.unique(mesh.cells[seen])])
    lines = _draw_blocks(axes, mesh, structure)
    handles = group_handles(mesh) if color is None or blocks_only else []
    if edge_groups:
        handles += draw_edge_groups(axes, mesh)
    draw_legend(figure, handles)
    labels = Labels(axes)
    if structure is not None and vertex_names:
        labels.vertex_names(structure, lines)
    if structure is not None and counts:
        labels.counts(structure, lines)
    if element_numbers:
        labels.element_numbers(mesh, seen)
    covered = labels.settle(figure)
    if covered:
        what = f"{covered} names or numbers would cover others and are left out; zoom in to see them."
        axes.set_xlabel(f"x\n{what}", fontsize=8)
    # Without dates the same mesh gives the same file.
    metadata = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}[path.suffix.lower()]
    figure.savefig(path, dpi=dpi, metadata=metadata, bbox_inches="tight", pad_inches=0.1)


def _check(
    color: str | None, structure: BlockStructure | None, zoom: tuple[float, ...] | None, **needs_structure: bool
) -> None:
    if color is not None and color not in MEASURES:
        raise ValueError(f"plot_mesh: color is {color!r}; expected None or one of {', '.join(map(repr, MEASURES))}.")
    if structure is None:
        for name, wanted in needs_structure.items():
            if wanted:
                raise ValueError(f"plot_mesh: {name} needs structure.")
    if zoom is not None and not (zoom[0] < zoom[1] and zoom[2] < zoom[3] and np.isfinite(zoom).all()):
        raise ValueError(f"plot_mesh: zoom is {zoom}; expected x0 < x1 and y0 < y1, in the order x0, x1, y0, y1.")


def _view(mesh: QuadMesh, zoom: tuple[float, float, float, float] | None) -> tuple[float, float, float, float]:
    """Limits x0, x1, y0, y1 of the axes."""
    if zoom is not None:
        return zoom
    outlines = element_outlines(mesh)
    finite = outlines[np.isfinite(outlines).all(axis=(1, 2))].reshape(-1, 2)
    low, high = (finite.min(axis=0), finite.max(axis=0)) if finite.size else (np.zeros(2), np.ones(2))
    margin = 0.02 * max(float((high - low).max()), 1e-300)
    return float(low[0] - margin), float(high[0] + margin), float(low[1] - margin), float(high[1] + margin)


def _seen(mesh: QuadMesh, view: tuple[float, float, float, float]) -> NDArray[np.bool_]:
    """Elements whose box meets the view."""
    x = mesh.coordinates
    low, high = x.min(axis=1), x.max(axis=1)
    inside = (low[:, 0] <= view[1]) & (high[:, 0] >= view[0]) & (low[:, 1] <= view[3]) & (high[:, 1] >= view[2])
    return np.asarray(inside & np.isfinite(x).all(axis=(1, 2)))


def _canvas(view: tuple[float, float, float, float], width: float, title: str) -> tuple[Any, Any]:
    """A figure as wide as asked for, its height fitting the view, without pyplot's global state."""
    figures = import_extra("matplotlib.figure", "plot")
    ratio = (view[3] - view[2]) / (view[1] - view[0])
    height = float(np.clip(width * ratio, 0.08 * width, 1.6 * width))
    figure = figures.Figure(figsize=(width, height + 1.3), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    axes.set(xlim=view[:2], ylim=view[2:], xlabel="x", ylabel="y")
    if title:
        axes.set_title(title)
    return figure, axes


def _draw_nodes(axes: Any, points: Array) -> None:
    size = float(np.clip(80.0 / np.sqrt(max(len(points), 1)), 1.0, 4.0))
    axes.plot(points[:, 0], points[:, 1], ".", color="black", markersize=size, markeredgewidth=0.0, zorder=5)


def _draw_blocks(axes: Any, mesh: QuadMesh, structure: BlockStructure | None) -> list[Array]:
    """Block edges; for a mesh without blocks its boundary."""
    collections = import_extra("matplotlib.collections", "plot")
    lines = list(side_outlines(mesh, boundary_sides(mesh))) if structure is None else block_outlines(mesh, structure)
    axes.add_collection(collections.LineCollection(lines, colors="black", linewidths=0.9, capstyle="round", zorder=4))
    return lines
