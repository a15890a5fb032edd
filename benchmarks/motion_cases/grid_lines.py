"""Layouts given by lines through a whole box; blocks within a body are left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

from hoblock import BlockStructure

Vertices = dict[str, tuple[float, float]]
Quad = tuple[str, str, str, str]

__all__ = ["GridLines", "Quad", "Vertices"]


def _straight(x: float, y: float) -> float:
    return y


@dataclass(frozen=True)
class GridLines:
    """Lines of constant x, and lines from left to right whose height may depend on x.

    Attributes
    ----------
    x, y : tuple of float
        Ascending; y as the lines are called.
    height : callable
        Where the line called y crosses x: thin strips beside a body fan out away from it. Straight by default.
    """

    x: tuple[float, ...]
    y: tuple[float, ...]
    height: Callable[[float, float], float] = _straight

    def name(self, x: float, y: float) -> str:
        """Name of the crossing of two lines: 'x3y2' is on the fourth line of x and the third of y."""
        return f"x{self.x.index(x)}y{self.y.index(y)}"

    def vertices(self) -> Vertices:
        """All crossings."""
        return {self.name(x, y): (x, self.height(x, y)) for x in self.x for y in self.y}

    def quads(self, solid: Callable[[float, float], bool]) -> list[Quad]:
        """Blocks, row by row, but those whose centre (of the lines as they are called) is solid."""
        return [
            (self.name(x0, y0), self.name(x1, y0), self.name(x1, y1), self.name(x0, y1))
            for y0, y1 in pairwise(self.y)
            for x0, x1 in pairwise(self.x)
            if not solid(0.5 * (x0 + x1), 0.5 * (y0 + y1))
        ]

    def structure(self, solid: Callable[[float, float], bool], elements: int) -> BlockStructure:
        """Blocks and crossings as a structure; every crossing has to be at a block."""
        return BlockStructure.build(self.vertices(), self.quads(solid), counts=elements)
