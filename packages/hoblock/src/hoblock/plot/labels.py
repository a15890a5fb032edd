"""Texts in a drawing, placed so that none covers another."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.mesh import QuadMesh

Array = NDArray[np.float64]

__all__ = ["Labels"]

_OFFSET = 4.5  # points from a vertex to the middle of its name, beyond half the name's size


class Labels:
    """Texts of a drawing in the order of their importance; what would cover an earlier one is left out.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    """

    def __init__(self, axes: Any) -> None:
        self.axes = axes
        self._texts: list[Any] = []

    def _add(self, text: str, place: Array, direction: Array, colour: str, size: float) -> None:
        """Write a text beside a place, in a direction (of length one, or zero for on it)."""
        width, height = 0.62 * size * len(text), 1.1 * size
        reach = _OFFSET + 0.5 * (abs(direction[0]) * width + abs(direction[1]) * height)
        shift = reach * direction if direction.any() else np.zeros(2)
        self._texts.append(
            self.axes.annotate(
                text,
                tuple(place),
                xytext=tuple(shift),
                textcoords="offset points",
                ha="center",
                va="center",
                fontsize=size,
                color=colour,
                bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.7},
                zorder=7,
                parse_math=False,
                annotation_clip=True,
            )
        )

    def _size(self, places: Array) -> float:
        """Size of the letters in points, smaller for many texts in view."""
        limits = np.array([self.axes.get_xlim(), self.axes.get_ylim()])
        inside = ((places >= limits[:, 0]) & (places <= limits[:, 1])).all(axis=1)
        return float(np.clip(10.0 - 0.05 * np.count_nonzero(inside), 5.5, 9.0))

    def vertex_names(self, structure: BlockStructure, lines: list[Array]) -> None:
        """Write the names of the block vertices, each into the widest gap between its edges."""
        topology = structure.topology
        directions: list[list[float]] = [[] for _ in structure.vertices]
        for (first, second), line in zip(topology.edges, lines, strict=True):
            for vertex, chord in ((first, line[1] - line[0]), (second, line[-2] - line[-1])):
                directions[vertex].append(float(np.arctan2(chord[1], chord[0])))
        size = self._size(structure.vertices)
        for name, place, angles in zip(topology.vertex_names, structure.vertices, directions, strict=True):
            self._add(name, place, _widest_gap(angles), "black", size)

    def counts(self, structure: BlockStructure, lines: list[Array]) -> None:
        """Write the number of elements on every block edge, at its middle."""
        size = self._size(np.array([line[len(line) // 2] for line in lines]))
        for count, line in zip(structure.topology.counts, lines, strict=True):
            lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(line, axis=0).T)))
            middle = np.array([np.interp(0.5 * lengths[-1], lengths, line[:, d]) for d in range(2)])
            self._add(str(count), middle, np.zeros(2), "#0b4fa8", size)

    def element_numbers(self, mesh: QuadMesh, seen: Any) -> None:
        """Write the numbers of the elements that are in view, at their middles."""
        size = 0.8 * self._size(mesh.points[mesh.corners[:, 0]])
        for element in np.flatnonzero(seen):
            self._add(str(element), mesh.points[mesh.corners[element]].mean(axis=0), np.zeros(2), "#555555", size)

    def settle(self, figure: Any) -> int:
        """Remove the texts that would cover an earlier one or leave the axes; return how many were covered."""
        if not self._texts:
            return 0
        figure.draw_without_rendering()
        frame = self.axes.get_window_extent()
        low, high = np.array([frame.x0, frame.y0]), np.array([frame.x1, frame.y1])
        boxes = np.empty((len(self._texts), 4))
        kept = covered = 0
        for text in self._texts:
            at = self.axes.transData.transform(text.xy)
            if (at < low - 1).any() or (at > high + 1).any():
                text.remove()
                continue
            box = text.get_window_extent()
            known = boxes[:kept]
            hit = (known[:, 0] < box.x1) & (box.x0 < known[:, 1]) & (known[:, 2] < box.y1) & (box.y0 < known[:, 3])
            if hit.any():
                text.remove()
                covered += 1
                continue
            boxes[kept] = box.x0, box.x1, box.y0, box.y1
            kept += 1
        self._texts = []
        return covered


def _widest_gap(angles: list[float]) -> Array:
    """Direction in the middle of the widest gap between some directions."""
    around = np.sort(np.array(angles))
    gaps = np.diff(np.append(around, around[0] + 2 * np.pi))
    widest = int(gaps.argmax())
    middle = around[widest] + 0.5 * gaps[widest]
    return np.array([np.cos(middle), np.sin(middle)])
