"""A mesh-motion test: a block structure and a body that moves in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure
from motion_cases.rectangle import Rectangle

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Motion = Callable[[Array, float], Array]

__all__ = ["Motion", "MotionCase"]


@dataclass(frozen=True, eq=False)
class MotionCase:
    """A block structure and the motion of the body in it, as a function of one parameter s.

    Attributes
    ----------
    test, layout : str
        Names of the motion and of the blocks, as in ``motion_cases.CASES``.
    structure : BlockStructure
        The reference, s = 0.
    edges : ndarray of int
        Driven edges: those of the body that moves.
    motion : callable
        Positions of points of the body, shape (n, 2), from those in the reference and s.
    end : float
        Last s.
    unit : str
        Of s: "gap" (length of a shift), "degrees", "fraction" or "slope amplitude A".
    sliding : ndarray of int
        Vertices on the sides of the outer box without its corners; a mover may let them slide along their side.
    deflection : callable, optional
        Vertical deflection of the tip at s, for bodies that have one.
    """

    test: str
    layout: str
    structure: BlockStructure
    edges: Index
    motion: Motion
    end: float
    unit: str
    sliding: Index
    deflection: Callable[[float], float] | None = None

    def __post_init__(self) -> None:
        for name in ("edges", "sliding"):
            numbers = np.array(getattr(self, name), dtype=np.int64)
            numbers.setflags(write=False)
            object.__setattr__(self, name, numbers)

    @staticmethod
    def between(
        body: Rectangle,
        box: Rectangle,
        structure: BlockStructure,
        names: tuple[str, str],
        motion: tuple[Motion, float, str],
        deflection: Callable[[float], float] | None = None,
    ) -> MotionCase:
        """Case of a structure between a body and a box, from test and layout, and from motion, end and unit."""
        (test, layout), (moved, end, unit) = names, motion
        edges, sliding = body.edges(structure), box.side_vertices(structure)
        return MotionCase(test, layout, structure, edges, moved, end, unit, sliding, deflection)

    @cached_property
    def driven(self) -> Index:
        """Vertices on the driven edges, ascending."""
        vertices = np.unique(self.structure.topology.edges[self.edges])
        vertices.setflags(write=False)
        return vertices

    def steps(self, count: int = 60) -> Array:
        """Parameters of equal steps to the end, without 0.

        Raises
        ------
        ValueError
            If there are none.
        """
        if count < 1:
            raise ValueError(f"steps: count is {count}; expected at least 1.")
        return np.linspace(0.0, self.end, count + 1)[1:]

    def tip(self, s: float) -> float:
        """Vertical deflection of the tip: WR upwards in cm, TH downwards in mm.

        Raises
        ------
        ValueError
            If the body has no tip.
        """
        if self.deflection is None:
            raise ValueError(f"tip: the body of {self.test} has no tip; expected one of the tests WR and TH.")
        return self.deflection(s)
