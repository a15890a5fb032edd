"""Block layouts and motions that both movers are tested on."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import NodalCurve
from hoblock.errors import MoverError
from hoblock.generate import generate, regenerate
from hoblock.grading import Exponential
from hoblock.layout import layout
from hoblock.mesh import QuadMesh
from hoblock.quality import invalid_elements

Motion = Callable[[np.ndarray, float], np.ndarray]


@dataclass(frozen=True)
class Layout:
    """A block structure, its interface edges and the vertices they drive."""

    structure: BlockStructure
    edges: np.ndarray

    @property
    def driven(self) -> np.ndarray:
        return np.unique(self.structure.topology.edges[self.edges])


class Run:
    """Moves a layout step by step, as a simulation would: interface nodes by formula, vertices by a mover."""

    def __init__(self, case: Layout, mover, motion: Motion, order: int = 4) -> None:
        self.case, self.mover, self.motion, self.order = case, mover, motion, order
        self.mesh = generate(case.structure, order)
        plan = layout(case.structure, order)
        self.curves = {int(e): self.mesh.points[plan.nodes_of_edge(int(e))] for e in case.edges}
        self.vertices = case.structure.vertices

    def driven_at(self, s: float) -> np.ndarray:
        return self.motion(self.case.structure.vertices[self.mover.driven], s)

    def to(self, s: float) -> np.ndarray:
        """Move the vertices to the position s of the body and keep them as the current state."""
        self.vertices = self.mover.move(self.vertices, self.driven_at(s))
        return self.vertices

    def mesh_at(self, s: float) -> QuadMesh:
        curves = {e: NodalCurve(self.motion(points, s), self.order) for e, points in self.curves.items()}
        return regenerate(self.mesh, self.case.structure.moved(self.vertices, curves))

    def valid_at(self, s: float) -> bool:
        return not invalid_elements(self.mesh_at(s))

    def reach(self, end: float, steps: int = 60) -> float:
        """Last s with a valid mesh when s rises in equal steps."""
        last = 0.0
        for s in np.linspace(0.0, end, steps + 1)[1:]:
            try:
                self.to(s)
            except MoverError:
                break
            if not self.valid_at(s):
                break
            last = float(s)
        return last


def grid(
    x: Iterable[float],
    y: Iterable[float],
    solid: Callable[[float, float], bool],
    count: int,
    warp: Callable[[float, float], tuple[float, float]] = lambda x, y: (x, y),
) -> BlockStructure:
    """Blocks between grid lines, without those whose centre is solid."""
    x, y = list(x), list(y)
    names = {(i, j): f"{i}_{j}" for i in range(len(x)) for j in range(len(y))}
    blocks = [
        [names[i, j], names[i + 1, j], names[i + 1, j + 1], names[i, j + 1]]
        for i in range(len(x) - 1)
        for j in range(len(y) - 1)
        if not solid(0.5 * (x[i] + x[i + 1]), 0.5 * (y[j] + y[j + 1]))
    ]
    used = {name for block in blocks for name in block}
    vertices = {name: warp(x[i], y[j]) for (i, j), name in names.items() if name in used}
    return BlockStructure.build(vertices, blocks, counts=count)


def edges_inside(structure: BlockStructure, inside: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Boundary edges both of whose ends and middle are in a region."""
    ends = structure.vertices[structure.topology.edges]
    points = np.concatenate([ends, ends.mean(axis=1, keepdims=True)], axis=1)
    hit = np.all([inside(points[:, k]) for k in range(3)], axis=0)
    return np.flatnonzero((structure.topology.blocks_per_edge == 1) & hit)


def plate_in_box() -> Layout:
    """Plate 1 × 0.02 in the middle of [-1, 1]², lines through the box (36 blocks, 18 free vertices)."""
    structure = grid(
        np.linspace(-1.0, 1.0, 9), [-1, -0.4, -0.01, 0.01, 0.4, 1], lambda x, y: abs(x) < 0.5 and abs(y) < 0.01, 4
    )
    return Layout(structure, edges_inside(structure, lambda p: (np.abs(p) < [0.5 + 1e-9, 0.01 + 1e-9]).all(axis=1)))


def translation(points: np.ndarray, s: float) -> np.ndarray:
    return points + np.array([0.0, s])


def rotation(points: np.ndarray, degrees: float) -> np.ndarray:
    a = np.radians(degrees)
    return points @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])


def bending(points: np.ndarray, degrees: float) -> np.ndarray:
    """The plate bent to an arc of that angle without stretch, its mean height kept."""
    a = np.radians(degrees)
    if a == 0.0:
        return points.copy()
    R, X, Y = 1.0 / a, points[:, 0], points[:, 1]
    shift = R - R * np.sin(0.5 * a) / (0.5 * a)
    return np.stack([(R - Y) * np.sin(a * X), R - (R - Y) * np.cos(a * X) - shift], axis=-1)


BETA, SIGMA = 1.875104, 0.7340955


def cantilever(points: np.ndarray, amplitude: float) -> np.ndarray:
    """The Wall–Ramm flap from (5.5, 6), length 4, bent with the slope of the first clamped–free mode, unstretched."""
    gauss, weight = np.polynomial.legendre.leggauss(24)
    xi = (points[:, 0] - 5.5) / 4.0

    def slope(z):
        b = BETA * z
        return amplitude * BETA * (np.sinh(b) + np.sin(b) - SIGMA * (np.cosh(b) - np.cos(b)))

    along = slope(0.5 * xi[:, None] * (gauss + 1.0))
    x, y = (2.0 * xi * (f(along) @ weight) for f in (np.cos, np.sin))
    e, theta = points[:, 1] - 6.0, slope(xi)
    return np.stack([5.5 + x - e * np.sin(theta), 6.0 + y + e * np.cos(theta)], axis=-1)


_CYLINDER = {
    "T0": (5.5, 6.03),
    "c1": (5.5, 6.5),
    "c2": (4.5, 6.5),
    "c3": (4.5, 5.5),
    "c4": (5.5, 5.5),
    "B0": (5.5, 5.97),
}
_COLUMNS = dict(
    zip(
        ("a", "d", "m0", "m1", "m2", "m3", "m4", "m5", "r0", "r1", "r2", "r3"),
        (3.5, 5.95, 6.75, 7.05, 7.45, 8.0, 8.75, 9.65, 10.8, 12.5, 15.0, 19.5),
        strict=True,
    )
)


def wall_ramm() -> Layout:
    """The Wall–Ramm flap behind a square (52 fluid blocks, 28 free vertices)."""
    vertices = dict(_CYLINDER)
    for k, x in enumerate((6.1, 6.9, 7.7, 8.6, 9.5), start=1):
        vertices[f"T{k}"], vertices[f"B{k}"] = (x, 6.03), (x, 5.97)
    for name, x in _COLUMNS.items():
        for row, y in (("B", 0.0), ("b", 4.4), ("t", 7.6), ("T", 12.0)):
            vertices[name + row] = (x, y)
    for k, y in enumerate((0.0, 4.4, 7.6, 12.0)):
        vertices[f"i{k}"] = (0.0, y)
    for k, (x, half) in enumerate(((10.8, 0.25), (12.5, 0.4), (15.0, 0.5), (19.5, 0.5))):
        vertices[f"q{k}b"], vertices[f"q{k}t"] = (x, 6.0 - half), (x, 6.0 + half)
    text = """i0 aB ab i1/i1 ab at i2/i2 at aT i3/ab c3 c2 at/c2 c1 dt at/c1 T0 m0t dt/ab db c4 c3/db m0b B0 c4
        T5 q0t r0t m5t/B5 q0b q0t T5/m5b r0b q0b B5"""
    blocks = [block.split() for block in text.replace("\n", "/").split("/")]
    names = list(_COLUMNS)
    for p, q in pairwise(names):
        blocks += [[p + "t", q + "t", q + "T", p + "T"], [p + "B", q + "B", q + "b", p + "b"]]
    for k in range(5):
        blocks += [[f"T{k}", f"T{k + 1}", f"m{k + 1}t", f"m{k}t"], [f"m{k}b", f"m{k + 1}b", f"B{k + 1}", f"B{k}"]]
    for k in range(3):
        blocks += [
            [f"q{k}t", f"q{k + 1}t", f"r{k + 1}t", f"r{k}t"],
            [f"q{k}b", f"q{k + 1}b", f"q{k + 1}t", f"q{k}t"],
            [f"r{k}b", f"r{k + 1}b", f"q{k + 1}b", f"q{k}b"],
        ]
    half = {
        ("T0", "m0t"): 3,
        ("at", "aT"): 3,
        ("c1", "c2"): 2,
        ("T0", "c1"): 2,
        ("i1", "ab"): 2,
        ("c2", "c3"): 2,
        ("T0", "T1"): 2,
        ("T1", "T2"): 1,
        ("T2", "T3"): 1,
        ("T3", "T4"): 2,
        ("T4", "T5"): 2,
        ("B5", "T5"): 1,
        ("T5", "q0t"): 3,
        ("q0t", "q1t"): 3,
        ("q1t", "q2t"): 3,
        ("q2t", "q3t"): 3,
    }
    graded = {(f"T{k}", f"m{k}t"): 1.5 for k in range(6)} | {
        ("c1", "dt"): 1.5,
        ("c2", "at"): 1.5,
        ("T5", "T4"): 1.6,
        ("T5", "q0t"): 1.6,
        ("q0t", "r0t"): 1.2,
    }
    mirror = str.maketrans("tbTB", "btBT")

    def other(name: str) -> str:
        return {"c1": "c4", "c2": "c3", "c3": "c2", "c4": "c1", "i1": "i2"}.get(name, name.translate(mirror))

    counts = half | {(other(a), other(b)): n for (a, b), n in half.items()}
    gradings = {pair: Exponential(a) for pair, a in graded.items()}
    gradings |= {(other(p), other(q)): grading for (p, q), grading in gradings.items()}
    structure = BlockStructure.build(vertices, blocks, counts=counts, gradings=gradings)
    return Layout(
        structure,
        edges_inside(
            structure, lambda p: (p[:, 0] > 5.5 - 1e-9) & (p[:, 0] < 9.5 + 1e-9) & (np.abs(p[:, 1] - 6.0) < 0.03 + 1e-9)
        ),
    )


@pytest.fixture(scope="session", name="plate_in_box")
def _plate_in_box() -> Layout:
    return plate_in_box()


@pytest.fixture(scope="session", name="wall_ramm")
def _wall_ramm() -> Layout:
    return wall_ramm()


@pytest.fixture(scope="session", name="rig")
def _rig() -> Callable[..., Run]:
    motions = {"translation": translation, "rotation": rotation, "bending": bending, "cantilever": cantilever}

    def make(case: Layout, mover, motion: str) -> Run:
        return Run(case, mover, motions[motion])

    return make
