"""Block layouts that several tests mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc, Parametric
from hoblock.grading import Cubic, Exponential, Quadratic, Uniform


class Bump(Parametric):
    """A chord with a sine bump to its left."""

    def __init__(self, first, second, height):
        first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
        normal = np.array([first[1] - second[1], second[0] - first[0]])

        def function(t):
            t = np.asarray(t)[:, None]
            return (1.0 - t) * first + t * second + height * np.sin(np.pi * t) * normal

        super().__init__(function)


@dataclass(frozen=True)
class Layouts:
    """Ways to make block structures."""

    valences = ("grid", "disc", "star", "annulus")

    @staticmethod
    def bump(first, second, height):
        return Bump(first, second, height)

    @staticmethod
    def square(counts=1, **options):
        vertices = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}
        return BlockStructure.build(vertices, {"body": [("a", "b", "c", "d")]}, counts=counts, **options)

    @staticmethod
    def wide(**options):
        """4 × 4 blocks of 40 × 40 elements."""
        x, y = np.meshgrid(np.arange(5.0), np.arange(5.0))
        quads = [(5 * j + i, 5 * j + i + 1, 5 * j + i + 6, 5 * j + i + 5) for j in range(4) for i in range(4)]
        return BlockStructure.build(np.stack([x.ravel(), y.ravel()], axis=-1), quads, counts=40, **options)

    @staticmethod
    def quads(kind):
        """Vertices (n, 2) and quads of a coarse layout; vertices of valence 4, 3, 5 and again 4 inside."""
        if kind == "grid":
            x, y = np.meshgrid(np.linspace(0, 3, 4), np.linspace(0, 2, 3))
            quads = [(k, k + 1, k + 5, k + 4) for row in range(2) for k in range(4 * row, 4 * row + 3)]
            return np.stack([x.ravel(), y.ravel()], axis=-1), quads
        if kind == "disc":
            corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / np.sqrt(2.0)
            ring = [(k, 4 + k, 4 + (k + 1) % 4, (k + 1) % 4) for k in range(4)]
            return np.concatenate([0.5 * corners, corners]), [(0, 1, 2, 3), *ring]
        if kind == "star":
            angle = 2.0 * np.pi / 10.0 * np.arange(10)
            radius = np.where(np.arange(10) % 2, 1.4, 1.0)
            vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
            quads = [(0, 1 + k, 2 + k, 1 + (k + 2) % 10) for k in range(0, 10, 2)]
            return np.concatenate([np.zeros((1, 2)), vertices]), quads
        angle = 2.0 * np.pi / 5.0 * np.arange(5)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        return np.concatenate([circle, 2.0 * circle]), [(k, 5 + k, 5 + (k + 1) % 5, (k + 1) % 5) for k in range(5)]

    @staticmethod
    def annulus(sectors=4, counts=1, inner=1.0, outer=2.0):
        angle = 2.0 * np.pi / sectors * np.arange(sectors)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        vertices = np.concatenate([inner * circle, outer * circle])
        following = [(k + 1) % sectors for k in range(sectors)]
        quads = [(k, sectors + k, sectors + j, j) for k, j in enumerate(following)]
        rings = {
            (shift + k, shift + j): Arc.from_center((0.0, 0.0), vertices[shift + k], vertices[shift + j])
            for shift in (0, sectors)
            for k, j in enumerate(following)
        }
        names = {
            "inner": [(k, j) for k, j in enumerate(following)],
            "outer": [(sectors + k, sectors + j) for k, j in enumerate(following)],
        }
        return BlockStructure.build(vertices, quads, counts=counts, curves=rings, edges=names)

    @staticmethod
    def random(kind, rng, *, graded=True, curved=True):
        """A layout with shuffled vertices, rotated quads, and random counts, gradings and curves of its edges."""
        vertices, quads = Layouts.quads(kind)
        vertices = vertices + 0.05 * rng.uniform(-1.0, 1.0, vertices.shape)
        number = rng.permutation(len(vertices))
        shuffled = np.empty_like(vertices)
        shuffled[number] = vertices
        quads = np.array([np.roll(number[list(quad)], rng.integers(4)) for quad in rng.permutation(quads)])
        chains = BlockStructure.build(shuffled, quads).topology
        counts, gradings, curves = {}, {}, {}
        kinds = (Uniform(), Quadratic(0.4), Cubic(0.5), Exponential(1.1))
        for chain in np.unique(chains.chains):
            edge = rng.permutation(chains.edges[np.flatnonzero(chains.chains == chain)[0]])
            counts[tuple(map(int, edge))] = int(rng.integers(1, 4))
        for pair in chains.edges:
            first, second = map(int, rng.permutation(pair))
            if graded:
                gradings[first, second] = kinds[rng.integers(len(kinds))]
            if curved and rng.random() < 0.5:
                curves[first, second] = Bump(shuffled[first], shuffled[second], rng.uniform(-0.08, 0.08))
        return BlockStructure.build(shuffled, quads, counts=counts, gradings=gradings, curves=curves)


@pytest.fixture(scope="session")
def layouts():
    return Layouts


@pytest.fixture
def rng():
    return np.random.default_rng(7301)
