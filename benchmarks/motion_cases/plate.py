"""T3: a thin plate that is shifted, turned and bent (Stein, Tezduyar, Benney, J. Appl. Mech. 70 (2003) 58–63)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure
from motion_cases.case import Motion, MotionCase
from motion_cases.grid_lines import GridLines
from motion_cases.o_grid import OGrid
from motion_cases.rectangle import Rectangle
from motion_cases.rotation import rotated

Array = NDArray[np.float64]

__all__ = ["LAYOUTS", "MOTIONS", "bent", "plate_case", "shifted"]

BODY, BOX = Rectangle.centered(1.0, 0.02), Rectangle.centered(2.0, 2.0)


def shifted(points: Array, s: float) -> Array:
    """Points moved up by s; the gap to the box is 0.99."""
    return np.asarray(points + np.array([0.0, s]))


def bent(points: Array, degrees: float) -> Array:
    """Plate bent to an arc of that angle; its middle line keeps its length and its mean height."""
    if degrees == 0.0:
        return points.copy()
    a = np.radians(degrees)
    R, X, Y = 1.0 / a, points[..., 0], points[..., 1]
    down = R - R * np.sin(0.5 * a) / (0.5 * a)
    return np.stack([(R - Y) * np.sin(a * X), R - (R - Y) * np.cos(a * X) - down], axis=-1)


def _cross(elements: int) -> BlockStructure:
    lines = GridLines((-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0), (-1.0, -0.4, -0.01, 0.01, 0.4, 1.0))
    return lines.structure(lambda x, y: abs(x) < 0.5 and abs(y) < 0.01, elements)


LAYOUTS: dict[str, Callable[[int], BlockStructure]] = {"cross4x": _cross, "O10r3": OGrid(BODY, BOX, 4).structure}
MOTIONS: dict[str, tuple[Motion, float, str]] = {
    "T3a": (shifted, 0.99, "gap"),
    "T3b": (rotated, 180.0, "degrees"),
    "T3c": (bent, 270.0, "degrees"),
}


def plate_case(test: str, layout: str, elements: int) -> MotionCase:
    """Case of the plate, 1 × 0.02, in the middle of [-1, 1]²."""
    return MotionCase.between(BODY, BOX, LAYOUTS[layout](elements), (test, layout), MOTIONS[test])
