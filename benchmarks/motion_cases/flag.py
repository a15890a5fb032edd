"""TH: the flag behind the cylinder of Turek and Hron (2006), falling as a cantilever; lengths in m."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hoblock import Arc, BlockStructure, Curve
from motion_cases.cantilever import Cantilever
from motion_cases.case import Motion, MotionCase
from motion_cases.grid_lines import GridLines, Quad, Vertices
from motion_cases.rectangle import Rectangle

Array = NDArray[np.float64]

__all__ = ["FLAG", "LAYOUTS", "MOTIONS", "drop", "fallen", "flag_case"]

CENTER, RADIUS, HALF = (0.2, 0.2), 0.05, 0.01
CLAMP = CENTER[0] + float(np.sqrt(RADIUS**2 - HALF**2))  # 0.2489898, where the flag's sides leave the cylinder
BODY, BOX = Rectangle(CLAMP, 0.19, 0.6, 0.21), Rectangle(0.0, 0.0, 2.5, 0.41)
FLAG = Cantilever((CLAMP, 0.2), 0.6 - CLAMP)
ARCS = (("S45", "S135"), ("S135", "S225"), ("S225", "S315"), ("S315", "D"), ("U", "S45"))


def fallen(points: Array, s: float) -> Array:
    """Points of the flag bent downwards with the slope amplitude -s."""
    return FLAG.bent(points, -s)


def drop(s: float) -> float:
    """How far the flag's end has come down, in mm."""
    return -1000.0 * FLAG.deflection(-s)


def _height(x: float, y: float) -> float:
    return {0.19: 0.16, 0.21: 0.25}.get(y, y) if x >= 0.8 else y


LINES = GridLines((0.0, 0.1, 0.3, 0.4, 0.5, 0.6, 0.8, 1.2, 2.5), (0.0, 0.1, 0.19, 0.21, 0.3, 0.41), _height)


def _upstream() -> list[Quad]:
    """Blocks left of x = 0.3, among them the ring around the cylinder."""
    name = LINES.name
    lines = (0.0, 0.1, 0.3, 0.41)
    inlet = [(name(0.0, a), name(0.1, a), name(0.1, b), name(0.0, b)) for a, b in pairwise(lines)]
    walls = [(name(0.1, a), name(0.3, a), name(0.3, b), name(0.1, b)) for a, b in ((0.0, 0.1), (0.3, 0.41))]
    ring = [
        (name(0.1, 0.1), "S225", "S135", name(0.1, 0.3)),
        (name(0.1, 0.3), "S135", "S45", name(0.3, 0.3)),
        ("S225", name(0.1, 0.1), name(0.3, 0.1), "S315"),
        ("S45", "U", name(0.3, 0.21), name(0.3, 0.3)),
        ("D", "S315", name(0.3, 0.1), name(0.3, 0.19)),
    ]
    return inlet + walls + ring


def _vertices() -> Vertices:
    circle = {
        f"S{a}": (CENTER[0] + RADIUS * np.cos(np.radians(a)), CENTER[1] + RADIUS * np.sin(np.radians(a)))
        for a in (45, 135, 225, 315)
    }
    return circle | {"U": (CLAMP, BODY.top), "D": (CLAMP, BODY.bottom)} | LINES.vertices()


def _channel(elements: int) -> BlockStructure:
    quads = _upstream() + LINES.quads(lambda x, y: x < 0.3 or (x < 0.6 and 0.19 < y < 0.21))
    used = {name for quad in quads for name in quad}
    vertices = {name: position for name, position in _vertices().items() if name in used}
    curves: dict[tuple[str | int, str | int], Curve]
    curves = {(a, b): Arc.from_center(CENTER, vertices[a], vertices[b]) for a, b in ARCS}
    return BlockStructure.build(vertices, quads, counts=elements, curves=curves)


LAYOUTS: dict[str, Callable[[int], BlockStructure]] = {"b3": _channel}
MOTIONS: dict[str, tuple[Motion, float, str]] = {"TH": (fallen, 1.0, "slope amplitude A")}


def flag_case(test: str, layout: str, elements: int) -> MotionCase:
    """Case of the flag, 0.02 thick, from the cylinder about (0.2, 0.2) to x = 0.6, in the channel 2.5 × 0.41."""
    return MotionCase.between(BODY, BOX, LAYOUTS[layout](elements), (test, layout), MOTIONS[test], drop)
