"""Meshes with distorted, curved elements."""

from __future__ import annotations

import numpy as np
import pytest

from hoblock import BlockStructure, generate


def bent(points):
    """Map of the plane that bends straight lines; one to one on the unit square."""
    x, y = points.T
    return np.stack([x + 0.08 * np.sin(2.1 * y + 0.3) * (1 + x), y + 0.1 * x**2 - 0.06 * np.cos(1.7 * x) * y], axis=-1)


@pytest.fixture(scope="session")
def distorted():
    """A function (order, columns, rows) -> mesh of the bent unit square with all four sides named."""

    def make(order, columns=3, rows=2):
        vertices = {"a": (0.0, 0.0), "b": (1.0, 0.0), "c": (1.0, 1.0), "d": (0.0, 1.0)}
        edges = {"bottom": [("a", "b")], "right": [("b", "c")], "top": [("c", "d")], "left": [("d", "a")]}
        counts = {("a", "b"): columns, ("b", "c"): rows}
        structure = BlockStructure.build(vertices, {"solid": [("a", "b", "c", "d")]}, counts=counts, edges=edges)
        mesh = generate(structure, order)
        return mesh.with_points(bent(mesh.points))

    return make
