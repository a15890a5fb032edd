"""Rings of blocks from a body to a box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from hoblock import BlockStructure
from motion_cases.rectangle import Rectangle

__all__ = ["OGrid"]


@dataclass(frozen=True)
class OGrid:
    """Blocks between a body and a box whose sides are cut at equal fractions and joined.

    Attributes
    ----------
    body, box : Rectangle
    long : int
        Blocks along the body's bottom and top; left and right have one.
    rings : tuple of float
        Where the lines around the body lie between it (0) and the box (1).
    """

    body: Rectangle
    box: Rectangle
    long: int
    rings: tuple[float, ...] = (0.2, 0.5)

    def structure(self, elements: int) -> BlockStructure:
        """Blocks as a structure; 'body0', 'ring1_0', 'box0' are at lower left corners, the rest counter-clockwise."""
        parts = (self.long, 1, self.long, 1)
        body, box = self.body.cut(parts), self.box.cut(parts)
        fractions = (0.0, *self.rings, 1.0)
        labels = ["body", *(f"ring{r}_" for r in range(1, len(fractions) - 1)), "box"]
        vertices = {
            f"{label}{k}": tuple((1.0 - r) * body[k] + r * box[k])
            for label, r in zip(labels, fractions, strict=True)
            for k in range(len(body))
        }
        return BlockStructure.build(vertices, self._quads(labels, len(body)), counts=elements)

    @staticmethod
    def _quads(labels: Sequence[str], around: int) -> list[tuple[str, str, str, str]]:
        return [
            (f"{inner}{k}", f"{outer}{k}", f"{outer}{m}", f"{inner}{m}")
            for inner, outer in pairwise(labels)
            for k, m in ((k, (k + 1) % around) for k in range(around))
        ]
