"""Regions bounded by level sets: area and perimeter against exact values, for every order."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import LevelSet, nearest_on_level_set
from hoblock.fields import GridField
from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.quality import certify, element_areas
from hoblock.reference import gauss_legendre, gauss_lobatto, lagrange_derivative

pytestmark = pytest.mark.verification

SIZE, SECTORS, HEIGHT = 2.0, 8, 0.7
COUNTS = (1, 2, 4, 8, 16, 32)
FLOOR = 1e-13


def superellipse(points: np.ndarray) -> np.ndarray:
    return points[:, 0] ** 4 + (points[:, 1] / HEIGHT) ** 4 - 1.0


def values(points: np.ndarray) -> np.ndarray:
    """A function with the same isoline that no spline represents exactly."""
    f = superellipse(points)
    return f / (f + 3.0)


HOLE = 4.0 * HEIGHT * math.gamma(1.25) ** 2 / math.gamma(1.5)


def exact_perimeter() -> float:
    """Gauss quadrature of the polar form, analytic and periodic, where the trapezoidal rule converges geometrically."""
    angle = 2.0 * np.pi * np.arange(4000) / 4000
    c, s = np.cos(angle), np.sin(angle)
    f, df = c**4 + (s / HEIGHT) ** 4, -4.0 * c**3 * s + 4.0 * s**3 * c / HEIGHT**4
    r, dr = f**-0.25, -0.25 * f**-1.25 * df
    return float(np.hypot(r, dr).mean() * 2.0 * np.pi)


def with_hole(function, order: int, count: int) -> QuadMesh:
    angle = 2.0 * np.pi * np.arange(SECTORS) / SECTORS + np.pi / 4.0
    rays = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inner = nearest_on_level_set(function, 0.85 * rays)
    vertices = np.concatenate([inner, SIZE * rays / np.abs(rays).max(axis=1, keepdims=True)])
    pairs = [(k, (k + 1) % SECTORS) for k in range(SECTORS)]
    structure = BlockStructure.build(
        vertices,
        [(a, SECTORS + a, SECTORS + b, b) for a, b in pairs],
        counts=count,
        curves={(a, b): LevelSet(function, inner[a], inner[b]) for a, b in pairs},
        edges={"hole": pairs},
    )
    mesh = generate(structure, order)
    assert certify(mesh).valid
    return mesh


def perimeter(mesh: QuadMesh) -> float:
    sides = mesh.edge_groups["hole"]
    nodes = mesh.points[mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]]]
    x, w = gauss_legendre(4 * mesh.order + 8)
    tangents = lagrange_derivative(gauss_lobatto(mesh.order), x) @ nodes
    return float((np.hypot(tangents[..., 0], tangents[..., 1]) @ w).sum())


def hole_area(mesh: QuadMesh) -> float:
    return 4.0 * SIZE**2 - float(element_areas(mesh).sum())


def observed_order(numbers: tuple[int, ...], errors: list[float]) -> float:
    """Over the whole way from the first error to round-off, or to the last one."""
    end = next((k for k, error in enumerate(errors) if error <= FLOOR), len(errors) - 1)
    assert end > 0, errors
    return float(np.log(errors[0] / max(errors[end], FLOOR)) / np.log(numbers[end] / numbers[0]))


@pytest.mark.parametrize("order", range(1, 9))
def test_area_and_perimeter_converge_to_round_off(order: int) -> None:
    length = exact_perimeter()
    errors = []
    for count in COUNTS:
        mesh = with_hole(superellipse, order, count)
        errors.append((abs(hole_area(mesh) / HOLE - 1.0), abs(perimeter(mesh) / length - 1.0)))
    for kind in zip(*errors, strict=True):
        assert observed_order(COUNTS, list(kind)) >= order + 0.9, kind
        assert min(kind) < (FLOOR if order >= 4 else 1e-3), kind


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_gridded_values_reach_the_order_of_their_spline(degree: int) -> None:
    errors = []
    numbers = (20, 40, 80, 160)
    for number in numbers:
        x, y = np.linspace(-1.6, 1.5, number + 1), np.linspace(-1.55, 1.5, number + 1)
        points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        field = GridField(x, y, values(points.reshape(-1, 2)).reshape(number + 1, number + 1), degree)
        errors.append(abs(hole_area(with_hole(field, 8, 16)) / HOLE - 1.0))
    assert observed_order(numbers, errors) >= degree + 0.5, errors
