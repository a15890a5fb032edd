"""A plate in a box, as in the mesh-motion tests."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from hoblock.blocks import BlockStructure

X, Y = np.linspace(-1.0, 1.0, 9), np.array([-1.0, -0.4, -0.01, 0.01, 0.4, 1.0])


@dataclass(frozen=True)
class Plate:
    """Blocks around a plate 1 × 0.02, its edges and the vertices on them."""

    structure: BlockStructure
    edges: np.ndarray

    @property
    def driven(self) -> np.ndarray:
        return np.unique(self.structure.topology.edges[self.edges])

    @staticmethod
    def build(counts=2, x=X, y=Y, **options) -> Plate:
        blocks = [
            (f"{i},{j}", f"{i + 1},{j}", f"{i + 1},{j + 1}", f"{i},{j + 1}")
            for i in range(len(x) - 1)
            for j in range(len(y) - 1)
            if not (abs(y[j] + y[j + 1]) < 1e-9 and -0.5 <= x[i] < 0.5)
        ]
        used = {name for block in blocks for name in block}
        vertices = {f"{i},{j}": (x[i], y[j]) for i in range(len(x)) for j in range(len(y)) if f"{i},{j}" in used}
        structure = BlockStructure.build(vertices, blocks, counts=counts, **options)
        ends = structure.vertices[structure.topology.edges]
        near = (np.abs(ends) <= [0.5 + 1e-9, 0.01 + 1e-9]).all(axis=(1, 2))
        return Plate(structure, np.flatnonzero(near & (structure.topology.blocks_per_edge == 1)))


def bent(points, degrees):
    a = np.radians(degrees)
    if a == 0.0:
        return points.copy()
    R, (X, Y) = 1.0 / a, points.T
    down = R - R * np.sin(0.5 * a) / (0.5 * a)
    return np.stack([(R - Y) * np.sin(a * X), R - (R - Y) * np.cos(a * X) - down], axis=-1)


@pytest.fixture(scope="session", name="plate")
def _plate():
    return Plate.build()


@pytest.fixture(scope="session", name="make_plate")
def _make_plate():
    return Plate.build


@pytest.fixture(scope="session", name="bend")
def _bend():
    return bent
