"""Mesh and fields at one time, on the elements where they are."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure, QuadMesh
from hoblock.layout import layout
from hoblock.numbering import side_nodes
from hoblock.quality import scaled_jacobian
from hofsi.build import Problem
from hofsi.fem.resampling import lexicographic, resampled
from hofsi.plot.canvas import TITLE_SIZE, drawing, new_figure, save
from hofsi.records import StepRecord

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["plot_fields"]

_LONG = 11.0  # inches: the longer side of the drawn region
_FLAT = 0.55  # height over width below which the colour bar lies under the picture
_SOLID = "#b8bec6"


@dataclass(frozen=True, eq=False)
class _Body:
    """The fluid or the solid where it is drawn."""

    structure: BlockStructure
    mesh: QuadMesh

    @property
    def fineness(self) -> Array:
        """Points along an element's side: chords that look like curves."""
        return np.linspace(-1.0, 1.0, 2 * self.mesh.order + 1)

    def outlines(self) -> Array:
        """Boundary of each element, counter-clockwise, shape (e, k, 2)."""
        s = self.fineness
        around = side_nodes(len(s) - 1).copy()
        around[2:] = around[2:, ::-1]
        return resampled(self.mesh.coordinates, s)[:, around[:, :-1].ravel()]

    def block_edges(self) -> list[Array]:
        """Points along each block edge."""
        p, plan = self.mesh.order, layout(self.structure, self.mesh.order)
        lines = []
        for edge, count in enumerate(self.structure.topology.counts):
            nodes = plan.nodes_of_edge(edge)
            pieces = self.mesh.points[nodes[np.arange(count)[:, None] * p + np.arange(p + 1)]]  # (count, p + 1, 2)
            square = np.broadcast_to(pieces[:, None], (count, p + 1, p + 1, 2)).reshape(count, -1, 2)
            fine = resampled(square, self.fineness)[:, : len(self.fineness)]
            lines.append(fine.reshape(-1, 2))
        return lines

    def rim(self) -> list[Array]:
        """Block edges on the boundary of the body."""
        outer = self.structure.topology.blocks_per_edge == 1
        return [line for line, outside in zip(self.block_edges(), outer, strict=True) if outside]

    def triangulation(self) -> Any:
        """Every element cut into small triangles; elements share no points."""
        x, y = resampled(self.mesh.coordinates, self.fineness).reshape(-1, 2).T
        return drawing("tri").Triangulation(x, y, _triangles(len(self.mesh.cells), len(self.fineness)))


def plot_fields(problem: Problem, record: StepRecord, directory: Path) -> list[Path]:
    """Draw the mesh and the fields of one step.

    Parameters
    ----------
    problem : Problem
    record : StepRecord
    directory : Path
        Exists.

    Returns
    -------
    list of Path
        ``mesh.png``, then the fields.
    """
    fluid, solid = _bodies(problem, record)
    when = f"t = {record.time:.6g}" if record.dt else "steady"
    heading = f"{problem.case.title}\n" if problem.case.title else ""
    written = [_mesh(fluid, solid, f"{heading}mesh, {when}", directory / "mesh.png")]
    if fluid is not None and problem.fluid is not None and record.state.fluid is not None:
        state, space = record.state.fluid, problem.fluid.solver.space
        speed = np.linalg.norm(resampled(state.velocity[fluid.mesh.cells], fluid.fineness), axis=-1)
        written.append(
            _field(fluid, solid, speed, "viridis", f"{heading}speed of the fluid, {when}", directory / "velocity.png")
        )
        values = state.pressure[lexicographic(space.pressure_cells, fluid.mesh.order - 1)]
        written.append(
            _field(
                fluid,
                solid,
                resampled(values, fluid.fineness),
                "Spectral_r",
                f"{heading}pressure, {when}",
                directory / "pressure.png",
            )
        )
    elif solid is not None and record.state.solid is not None:
        d = resampled(record.state.solid.displacement[solid.mesh.cells], solid.fineness)
        written.append(
            _field(
                solid,
                None,
                np.linalg.norm(d, axis=-1),
                "viridis",
                f"{heading}magnitude of the displacement, {when}",
                directory / "displacement.png",
            )
        )
    return written


def _bodies(problem: Problem, record: StepRecord) -> tuple[_Body | None, _Body | None]:
    state = record.state
    fluid = solid = None
    if problem.fluid is not None and state.mesh is not None:
        fluid = _Body(problem.fluid.structure, state.mesh.mesh)
    if problem.solid is not None and state.solid is not None:
        mesh = problem.solid.mesh
        solid = _Body(problem.solid.structure, mesh.with_points(mesh.points + state.solid.displacement))
    return fluid, solid


def _triangles(elements: int, side: int) -> Index:
    """Two triangles for each small square of a grid side × side, for each element, shape (k, 3)."""
    first = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    lower = np.stack([first, first + 1, first + side + 1], axis=1)
    upper = np.stack([first, first + side + 1, first + side], axis=1)
    one = np.concatenate([lower, upper])
    return np.asarray((np.arange(elements)[:, None, None] * side**2 + one).reshape(-1, 3))


def _mesh(fluid: _Body | None, solid: _Body | None, title: str, path: Path) -> Path:
    canvas = _Canvas.around([body for body in (fluid, solid) if body is not None], title)
    if fluid is not None:
        quality = scaled_jacobian(fluid.mesh)
        elements = _polygons(fluid, array=quality, cmap="YlOrRd_r", clim=(min(0.0, float(quality.min())), 1.0))
        canvas.axes.add_collection(elements)
        canvas.colour_bar(elements, f"scaled Jacobian (worst {quality.min():.2f})")
        canvas.lines(fluid.block_edges(), 0.9)
    if solid is not None:
        canvas.axes.add_collection(_polygons(solid, facecolors=_SOLID))
        canvas.lines(solid.block_edges(), 0.9)
    return save(canvas.figure, path)


def _polygons(body: _Body, **style: Any) -> Any:
    return drawing("collections").PolyCollection(body.outlines(), edgecolors="0.3", linewidths=0.3, **style)


def _field(body: _Body, over: _Body | None, values: Array, colours: str, title: str, path: Path) -> Path:
    bodies = [body] if over is None else [body, over]
    canvas = _Canvas.around(bodies, title)
    low, high, extend = _limits(values)
    picture = canvas.axes.tripcolor(
        body.triangulation(), values.ravel(), shading="gouraud", cmap=colours, vmin=low, vmax=high, rasterized=True
    )
    canvas.lines(body.rim(), 0.7)
    if over is not None:
        polygons = _polygons(over, facecolors=_SOLID)
        polygons.set_edgecolor(_SOLID)
        canvas.axes.add_collection(polygons)
        canvas.lines(over.rim(), 0.7)
    canvas.colour_bar(picture, "", extend)
    return save(canvas.figure, path)


def _limits(values: Array) -> tuple[float, float, str]:
    """Range of colours: all values but a few extreme ones, as at corners, if these would take most of it."""
    low, high = float(values.min()), float(values.max())
    inner_low, inner_high = (float(q) for q in np.quantile(values, (0.002, 0.998)))
    cut_low, cut_high = inner_low - low > 0.25 * (high - low), high - inner_high > 0.25 * (high - low)
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    low, high = inner_low if cut_low else low, inner_high if cut_high else high
    if not high - low > 1e-12 * max(abs(low), abs(high)):  # a constant
        margin = 0.5 * (abs(low) or 1.0)
        low, high = low - margin, high + margin
    return low, high, extend[cut_low, cut_high]


@dataclass(frozen=True, eq=False)
class _Canvas:
    """A figure whose axes fit a region."""

    figure: Any
    axes: Any
    flat: bool

    @staticmethod
    def around(bodies: list[_Body], title: str) -> _Canvas:
        """Axes of equal scales, just large enough for all bodies."""
        outlines = np.concatenate([body.outlines().reshape(-1, 2) for body in bodies])
        low, high = outlines.min(axis=0), outlines.max(axis=0)
        size = high - low
        flat = bool(size[1] < _FLAT * size[0])
        scale = _LONG / size[0] if flat else 0.75 * _LONG / max(size)
        width, height = np.maximum(size * scale, 2.0 if flat else 3.5)
        figure = new_figure(width + (0.8 if flat else 2.0), height + (2.1 if flat else 1.4))
        axes = figure.add_subplot()
        axes.set_aspect("equal")
        margin = 0.01 * size.max()
        axes.set_xlim(low[0] - margin, high[0] + margin)
        axes.set_ylim(low[1] - margin, high[1] + margin)
        axes.set_title(title, fontsize=TITLE_SIZE, loc="left")
        axes.set_xlabel("x", fontsize=11)
        axes.set_ylabel("y", fontsize=11)
        axes.tick_params(labelsize=9)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        return _Canvas(figure, axes, flat)

    def lines(self, points: list[Array], width: float) -> None:
        """Draw black lines."""
        self.axes.add_collection(drawing("collections").LineCollection(points, colors="black", linewidths=width))

    def colour_bar(self, mappable: Any, label: str, extend: str = "neither") -> None:
        """Add a colour bar on the longer side of the picture."""
        below = {"orientation": "horizontal", "shrink": 0.6, "aspect": 50, "pad": 0.02}
        place = below if self.flat else {"shrink": 0.85}
        bar = self.figure.colorbar(mappable, ax=self.axes, extend=extend, **place)
        bar.ax.tick_params(labelsize=9)
        if label:
            bar.set_label(label, fontsize=10)
