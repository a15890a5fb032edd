"""Drawings of meshes and blocks; curved elements are drawn curved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError
from hoblock.extras import import_extra
from hoblock.layout import layout
from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.quality import equiangular_skewness, jacobian_ratio, scaled_jacobian
from hoblock.reference import gauss_lobatto, lagrange

Array = NDArray[np.float64]

__all__ = ["block_outlines", "element_outlines", "plot_mesh"]

# Measure, its label and colour map. What is invalid is drawn red in all of them.
_MEASURES: dict[str, tuple[Callable[[QuadMesh], Array], str, str]] = {
    "jacobian_ratio": (jacobian_ratio, "Jacobian ratio", "viridis"),
    "scaled_jacobian": (scaled_jacobian, "scaled Jacobian", "viridis"),
    "skewness": (equiangular_skewness, "equiangular skewness", "viridis_r"),
}
_GROUP_COLOURS = ("#dce9f5", "#f8dfc6", "#ddf0da", "#eadcf2", "#f7f3c4", "#e4e4e4")
_INVALID = "#e00000"
_SUFFIXES = (".pdf", ".png", ".svg")


def element_outlines(mesh: QuadMesh, samples: int | None = None) -> Array:
    """Closed outlines of all elements as polygons.

    Parameters
    ----------
    mesh : QuadMesh
    samples : int, optional
        Straight pieces a side; default 1 for order 1 and 4p above.

    Returns
    -------
    ndarray, shape (e, 4 samples, 2)
        Counter-clockwise.
    """
    values = _side_basis(mesh.order, samples)
    sides = side_nodes(mesh.order)
    walk = np.stack([sides[0], sides[1], sides[2][::-1], sides[3][::-1]])
    nodes = mesh.points[mesh.cells[:, walk]]  # (e, 4, p + 1, 2)
    return np.asarray((values[:-1] @ nodes).reshape(len(mesh.cells), -1, 2))


def block_outlines(mesh: QuadMesh, structure: BlockStructure, samples: int | None = None) -> list[Array]:
    """Block edges as polylines (k, 2), one for each edge of the structure that the mesh was made from."""
    plan = layout(structure, mesh.order)
    values = _side_basis(mesh.order, samples)
    lines = []
    for edge in range(len(structure.topology.edges)):
        nodes = mesh.points[plan.nodes_of_edge(edge)]
        elements = nodes[np.arange(0, len(nodes) - 1, mesh.order)[:, None] + np.arange(mesh.order + 1)]
        lines.append(np.concatenate([(values[:-1] @ elements).reshape(-1, 2), nodes[-1:]]))
    return lines


def _side_basis(order: int, samples: int | None) -> Array:
    count = (1 if order == 1 else 4 * order) if samples is None else samples
    return lagrange(gauss_lobatto(order), np.linspace(-1.0, 1.0, count + 1))


def plot_mesh(
    mesh: QuadMesh,
    path: str | Path,
    *,
    structure: BlockStructure | None = None,
    color: str | None = "scaled_jacobian",
    vertex_names: bool = False,
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
    color : {"scaled_jacobian", "jacobian_ratio", "skewness"}, optional
        Measure that colours the elements; invalid elements are red. None colours the groups of elements.
    vertex_names : bool
        Write the names of the block vertices; needs ``structure``.
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
    MissingExtraError
        If matplotlib is not installed.
    """
    path = Path(path)
    if path.suffix.lower() not in _SUFFIXES:
        raise MeshFileError(f"{path}: suffix is {path.suffix!r}; expected one of {', '.join(_SUFFIXES)}.")
    if color is not None and color not in _MEASURES:
        raise ValueError(f"plot_mesh: color is {color!r}; expected None or one of {', '.join(map(repr, _MEASURES))}.")
    if vertex_names and structure is None:
        raise ValueError("plot_mesh: vertex_names needs structure.")
    figure, axes = _canvas(mesh, width, title)
    _draw_elements(figure, axes, mesh, color)
    if structure is not None:
        _draw_blocks(axes, mesh, structure, vertex_names)
    # Without dates the same mesh gives the same file.
    metadata = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}[path.suffix.lower()]
    figure.savefig(path, dpi=dpi, metadata=metadata, bbox_inches="tight", pad_inches=0.1)


def _canvas(mesh: QuadMesh, width: float, title: str) -> tuple[Any, Any]:
    """A figure as wide as asked for, its height fitting the mesh, without pyplot's global state."""
    figures = import_extra("matplotlib.figure", "plot")
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    size = np.maximum(high - low, 1e-300)
    height = float(np.clip(width * size[1] / size[0], 0.2 * width, 1.6 * width))
    figure = figures.Figure(figsize=(width, height + 1.3), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    margin = 0.02 * float(size.max())
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin), xlabel="x", ylabel="y")
    if title:
        axes.set_title(title)
    return figure, axes


def _draw_elements(figure: Any, axes: Any, mesh: QuadMesh, color: str | None) -> None:
    collections = import_extra("matplotlib.collections", "plot")
    outlines = element_outlines(mesh)
    style = {"edgecolors": "black", "linewidths": 0.3}
    if color is None:
        axes.add_collection(collections.PolyCollection(outlines, facecolors=_group_colours(mesh), **style))
        handles = _group_handles(mesh)
        if len(handles) > 1:
            figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 6), frameon=False)
        return
    measure, label, name = _MEASURES[color]
    values = measure(mesh)
    invalid = scaled_jacobian(mesh) <= 0.0
    colours = import_extra("matplotlib", "plot").colormaps[name]
    patches = collections.PolyCollection(outlines[~invalid], array=values[~invalid], cmap=colours, **style)
    patches.set_clim(0.0, 1.0)
    axes.add_collection(patches)
    axes.add_collection(collections.PolyCollection(outlines[invalid], facecolors=_INVALID, zorder=3, **style))
    what = f"{label}, {int(invalid.sum())} invalid (red)" if invalid.any() else label
    lowest, highest = float(values.min()), float(values.max())
    figure.colorbar(
        patches,
        ax=axes,
        orientation="horizontal",
        shrink=0.5,
        aspect=40,
        pad=0.02,
        label=f"{what}: {lowest:.3g} to {highest:.3g}",
    )


def _group_colours(mesh: QuadMesh) -> list[str]:
    colours = ["#ffffff"] * len(mesh.cells)
    for k, members in enumerate(mesh.cell_groups.values()):
        for element in members:
            colours[element] = _GROUP_COLOURS[k % len(_GROUP_COLOURS)]
    return colours


def _group_handles(mesh: QuadMesh) -> list[Any]:
    patches = import_extra("matplotlib.patches", "plot")
    return [
        patches.Patch(facecolor=_GROUP_COLOURS[k % len(_GROUP_COLOURS)], edgecolor="black", linewidth=0.3, label=name)
        for k, name in enumerate(mesh.cell_groups)
    ]


def _draw_blocks(axes: Any, mesh: QuadMesh, structure: BlockStructure, vertex_names: bool) -> None:
    collections = import_extra("matplotlib.collections", "plot")
    lines = block_outlines(mesh, structure)
    axes.add_collection(collections.LineCollection(lines, colors="black", linewidths=1.1, capstyle="round", zorder=4))
    if not vertex_names:
        return
    for name, (x, y) in zip(structure.topology.vertex_names, structure.vertices, strict=True):
        box = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}
        axes.annotate(name, (x, y), ha="center", va="center", fontsize=5, bbox=box, zorder=5, parse_math=False)
