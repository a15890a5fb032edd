"""Lines across a block, between two opposite edges of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.curve import Curve, breaks_of
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Between"]

_SAME = 1e-12
"""Breaks of two curves that are closer in t are one."""


@dataclass(frozen=True, eq=False)
class Between:
    """The line at a fraction of the way from one edge of a block to the opposite one, as the transfinite map has it.

    x(t) = (1-t) a + t b + (1-f) D₁(t) + f D₂(t), where a and b are its ends, which lie on the other two edges, and D₁
    and D₂ the offsets of the two edges from their chords. A block cut along it keeps its mesh: the map reproduces
    itself on parts of a block.

    Parameters
    ----------
    first, second : Curve or None
        The two edges, in the same direction; None if straight.
    fraction : float
        f, from 0 at the first to 1 at the second.
    ends : pair of (float, float)
        a and b.

    References
    ----------
    Gordon & Hall, Int. J. Numer. Meth. Engng 7 (1973) 461–477, doi:10.1002/nme.1620070405.
    """

    first: Curve | None
    second: Curve | None
    fraction: float
    ends: tuple[tuple[float, float], tuple[float, float]]

    def __post_init__(self) -> None:
        ends = np.array(self.ends, dtype=float)
        if ends.shape != (2, 2) or not np.isfinite(ends).all():
            raise CurveError(f"line between curves: ends are {self.ends}; expected two points of finite coordinates.")
        if not 0.0 <= self.fraction <= 1.0:
            raise CurveError(f"line between curves: fraction is {self.fraction}; expected one from 0 to 1.")

    @property
    def breaks(self) -> Array:
        """Parameters where one of the edges is not smooth."""
        found = np.union1d(breaks_of(self.first), breaks_of(self.second))
        return found[np.diff(found, prepend=0.0) > _SAME]

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        t = np.asarray(t, dtype=float)
        a, b = np.array(self.ends, dtype=float)
        points = (1.0 - t)[:, None] * a + t[:, None] * b
        for curve, weight in ((self.first, 1.0 - self.fraction), (self.second, self.fraction)):
            if curve is not None and weight:
                points += weight * _offsets(curve, t)
        return np.asarray(points)


def _offsets(curve: Curve, t: Array) -> Array:
    """Points of a curve, less those of its chord."""
    first, second = np.asarray(curve(np.array([0.0, 1.0])), dtype=float)
    return np.asarray(curve(t) - (1.0 - t)[:, None] * first - t[:, None] * second)
