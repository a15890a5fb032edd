"""Single elements of every kind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from hoblock.mesh import QuadMesh
from hoblock.reference import gauss_lobatto


@dataclass(frozen=True)
class Elements:
    """Ways to make meshes of elements that share no nodes."""

    @staticmethod
    def grid(nodes):
        return np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2)

    @staticmethod
    def of(coordinates, order):
        """A mesh of elements with given coordinates (e, n, 2)."""
        coordinates = np.asarray(coordinates, dtype=float)
        count, n = coordinates.shape[:2]
        return QuadMesh(coordinates.reshape(-1, 2), np.arange(count * n).reshape(count, n), order, {}, {})

    @staticmethod
    def mapped(function, order):
        """One element with nodes at function(ξ, η)."""
        xi, eta = Elements.grid(gauss_lobatto(order)).T
        return Elements.of(np.stack(function(xi, eta), axis=-1)[None], order)

    @staticmethod
    def bilinear(corners, order=1):
        a, b, c, d = np.array(corners, dtype=float)

        def function(xi, eta):
            N = ((1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta))
            return sum(n[..., None] * x / 4 for n, x in zip(N, (a, b, c, d), strict=True)).T

        return Elements.mapped(function, order)

    @staticmethod
    def perturbed(rng, order, amplitude, count=40):
        """Elements with random nodes around those of the square."""
        square = Elements.grid(gauss_lobatto(order))
        return Elements.of(square + amplitude / order * rng.standard_normal((count, len(square), 2)), order)


@pytest.fixture(scope="session")
def elements():
    return Elements


@pytest.fixture
def rng():
    return np.random.default_rng(7301)
