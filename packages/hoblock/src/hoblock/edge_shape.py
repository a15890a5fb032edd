"""The shape of a block edge as a grading sees it: its length, its breaks, places by arc length."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hoblock.curves import Curve, NodalCurve, PiecewiseCurve
from hoblock.curves.arc_length import LengthTable, length_table

Array = NDArray[np.float64]

__all__ = ["CurvedShape", "StraightShape", "edge_shape"]


class StraightShape:
    """A straight edge."""

    breaks: Array = np.zeros(0)

    def __init__(self, first: Array, second: Array) -> None:
        self.length = float(np.hypot(*(second - first)))

    def parameters(self, lengths: Array) -> Array:
        """Parameters of the places at given arc lengths from the first end."""
        return np.asarray(lengths / self.length)


class CurvedShape:
    """An edge with a curve; measured only if a grading asks."""

    def __init__(self, curve: Curve) -> None:
        self._curve = curve

    @cached_property
    def _table(self) -> LengthTable:
        return length_table(self._curve)

    @property
    def length(self) -> float:
        """Arc length."""
        return self._table.length

    @property
    def breaks(self) -> Array:
        """Parameters where the curve is not smooth."""
        return self._curve.breaks if isinstance(self._curve, PiecewiseCurve) else np.zeros(0)

    def parameters(self, lengths: Array) -> Array:
        """Parameters of the places at given arc lengths from the first end.

        The nodes of a nodal curve are taken as they are; its parameters are fractions of its length.
        """
        if isinstance(self._curve, NodalCurve):
            return np.asarray(lengths / self.length)
        return self._table.parameters(lengths)


def edge_shape(first: Array, second: Array, curve: Curve | None) -> StraightShape | CurvedShape:
    """Return the shape of an edge between two places, with a curve or straight."""
    return StraightShape(first, second) if curve is None else CurvedShape(curve)
