"""T4: a block that turns and travels (de Boer, van der Schoot, Bijl, Comput. Struct. 85 (2007) 784–795)."""

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

__all__ = ["LAYOUTS", "MOTIONS", "block_case", "travelled"]

BODY, BOX = Rectangle.centered(5.0, 1.0), Rectangle.centered(25.0, 25.0)


def travelled(points: Array, s: float) -> Array:
    """Points turned by 60° s about the block's centre, then shifted by (-10, -10) s."""
    return rotated(points, 60.0 * s) + s * np.array([-10.0, -10.0])


def _cross(elements: int) -> BlockStructure:
    lines = GridLines((-12.5, -6.0, -2.5, 2.5, 6.0, 12.5), (-12.5, -4.0, -0.5, 0.5, 4.0, 12.5))
    return lines.structure(lambda x, y: abs(x) < 2.5 and abs(y) < 0.5, elements)


LAYOUTS: dict[str, Callable[[int], BlockStructure]] = {
    "cross24": _cross,
    "O4r3": OGrid(BODY, BOX, 1).structure,
    "O10r3": OGrid(BODY, BOX, 4).structure,
}
MOTIONS: dict[str, tuple[Motion, float, str]] = {
    "T4a": (travelled, 1.0, "fraction"),
    "T4b": (rotated, 360.0, "degrees"),
}


def block_case(test: str, layout: str, elements: int) -> MotionCase:
    """Case of the block, 5 × 1, in the middle of [-12.5, 12.5]²."""
    return MotionCase.between(BODY, BOX, LAYOUTS[layout](elements), (test, layout), MOTIONS[test])
