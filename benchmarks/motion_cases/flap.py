"""WR: the flap behind a square of Wall and Ramm (1998), bent as a cantilever; lengths in cm."""

from __future__ import annotations

from collections.abc import Callable

from hoblock import BlockStructure
from motion_cases.cantilever import Cantilever
from motion_cases.case import Motion, MotionCase
from motion_cases.grid_lines import GridLines
from motion_cases.rectangle import Rectangle

__all__ = ["FLAP", "LAYOUTS", "MOTIONS", "flap_case"]

BODY, BOX = Rectangle(5.5, 5.97, 9.5, 6.03), Rectangle(0.0, 0.0, 19.5, 12.0)
FLAP = Cantilever((5.5, 6.0), 4.0)
X = (0.0, 3.0, 4.5, 5.5, 6.5, 7.5, 8.5, 9.5, 11.5, 19.5)
Y = (0.0, 3.5, 5.5, 5.97, 6.03, 6.5, 8.5, 12.0)


def _height(x: float, y: float) -> float:
    """Lines beside the flap fan out up- and downstream, those beside the square behind it."""
    if y in (5.97, 6.03) and (x < 3.5 or x > 11.0):
        half = 0.3 if x < 3.5 else 0.4
        return 6.0 - half if y < 6.0 else 6.0 + half
    if x > 5.6:
        return {5.5: 4.9, 6.5: 7.1}.get(y, y)
    return y


def _solid(x: float, y: float) -> bool:
    return (4.5 < x < 5.5 < y < 6.5) or (5.5 < x < 9.5 and 5.97 < y < 6.03)


def _lines(x: tuple[float, ...]) -> Callable[[int], BlockStructure]:
    return lambda elements: GridLines(x, Y, _height).structure(_solid, elements)


LAYOUTS: dict[str, Callable[[int], BlockStructure]] = {
    "f4": _lines(X),
    "f1": _lines(tuple(x for x in X if x not in (6.5, 7.5, 8.5))),
}
MOTIONS: dict[str, tuple[Motion, float, str]] = {"WR": (FLAP.bent, 1.2, "slope amplitude A")}


def flap_case(test: str, layout: str, elements: int) -> MotionCase:
    """Case of the flap, 4 × 0.06, behind the unit square about (5, 6) in a box 19.5 × 12."""
    names = test, layout
    return MotionCase.between(BODY, BOX, LAYOUTS[layout](elements), names, MOTIONS[test], FLAP.deflection)
