"""A block structure in the making: vertices, blocks, names, counts, curves and gradings, collected piece by piece."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve
from hoblock.grading import Grading

Pair = tuple[str | int, str | int]

__all__ = ["Draft", "grid_name"]


def grid_name(i: int, j: int) -> str:
    """Name of the grid vertex in column i and row j: ``"p2_0"``."""
    return f"p{i}_{j}"


class Draft:
    """Collects the pieces of a block structure; `structure` builds and checks it."""

    def __init__(self) -> None:
        self.vertices: dict[str, tuple[float, float]] = {}
        self.blocks: dict[str, list[tuple[str, str, str, str]]] = {}
        self.names: dict[str, list[Pair]] = {}
        self.counts: dict[Pair, int] = {}
        self.curves: dict[Pair, Curve] = {}
        self.gradings: dict[Pair, Any] = {}

    def vertex(self, name: str, point: Sequence[float] | NDArray[np.float64]) -> None:
        """Place a vertex."""
        self.vertices[name] = (float(point[0]), float(point[1]))

    def block(self, group: str, a: str, b: str, c: str, d: str) -> None:
        """Add a block, counter-clockwise."""
        self.blocks.setdefault(group, []).append((a, b, c, d))

    def grid(
        self,
        group: str,
        x: Sequence[float],
        y: Sequence[float],
        keep: Callable[[int, int], bool] = lambda i, j: True,
        name: Callable[[int, int], str] = grid_name,
    ) -> None:
        """Add blocks between lines at ``x`` and ``y``, column by column; ``keep`` tells which (i, j) there are."""
        for i in range(len(x) - 1):
            for j in range(len(y) - 1):
                if keep(i, j):
                    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                    for m, n in corners:
                        self.vertices.setdefault(name(m, n), (float(x[m]), float(y[n])))
                    a, b, c, d = (name(m, n) for m, n in corners)
                    self.block(group, a, b, c, d)

    def call(self, name: str, *path: str) -> None:
        """Give a name to the edges along a path; called again, the name gets more edges."""
        self.names.setdefault(name, []).extend(pairwise(path))

    def count(self, elements: int, *path: str) -> None:
        """Set the number of elements on each edge along a path."""
        for pair in pairwise(path):
            self.counts[pair] = elements

    def grade(self, grading: Grading | Any, *pairs: Pair) -> None:
        """Set the grading of edges, each in the direction of its pair."""
        for pair in pairs:
            self.gradings[pair] = grading

    def curve(self, first: str, second: str, curve: Curve) -> None:
        """Set the geometry of an edge."""
        self.curves[first, second] = curve

    def structure(self) -> BlockStructure:
        """Build and check the structure."""
        return BlockStructure.build(
            self.vertices,
            self.blocks,
            counts=self.counts,
            edges=self.names,
            curves=self.curves,
            gradings=self.gradings,
        )
