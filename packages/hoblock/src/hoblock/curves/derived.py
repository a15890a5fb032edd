"""Curves made from curves: walked from the other end, or with ends that have moved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.arc_length import ArcLength
from hoblock.curves.curve import Curve, CuttableCurve, breaks_of
from hoblock.curves.nodal import NodalCurve

Array = NDArray[np.float64]

__all__ = ["Displaced", "Reversed", "reverse", "with_ends"]


@dataclass(frozen=True)
class Reversed:
    """A curve walked from the other end."""

    curve: Curve

    @property
    def breaks(self) -> Array:
        """Parameters where the curve is not smooth."""
        return 1.0 - breaks_of(self.curve)[::-1]

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        return self.curve(1.0 - np.asarray(t, dtype=float))


def reverse(curve: Curve) -> Curve:
    """Return the curve walked from the other end; a nodal curve stays one."""
    if isinstance(curve, NodalCurve):
        return NodalCurve(curve.points[::-1], curve.order)
    return curve.curve if isinstance(curve, Reversed) else Reversed(curve)


def with_ends(curve: Curve, shifts: tuple[Array, Array], ends: tuple[Array, Array]) -> Curve:
    """Return a curve for an edge whose vertices have moved.

    A curve that can be ``cut`` anew between other ends (an arc whose new ends lie on its circle) is, so that a vertex
    can slide along it. Any other curve keeps its shape, with the displacement of the ends blended linearly along it.
    A curve by arc length is one afterwards.

    Parameters
    ----------
    curve : Curve
    shifts : pair of ndarray, shape (2,)
        Displacements of the ends.
    ends : pair of ndarray, shape (2,)
        New positions of the ends.
    """
    if isinstance(curve, ArcLength):
        return ArcLength(with_ends(curve.curve, shifts, ends))
    if isinstance(curve, Reversed) and isinstance(curve.curve, ArcLength):
        return Reversed(with_ends(curve.curve, shifts[::-1], ends[::-1]))
    first, second = shifts
    if isinstance(curve, Displaced):  # keep one level of blending, however often the structure moves
        first, second = first + np.array(curve.first), second + np.array(curve.second)
        curve = curve.curve
    inner = curve.curve if isinstance(curve, Reversed) else curve
    if isinstance(inner, CuttableCurve):
        cut = inner.cut(*(ends if inner is curve else ends[::-1]))
        if cut is not None:
            return cut if inner is curve else Reversed(cut)
    return Displaced(curve, (float(first[0]), float(first[1])), (float(second[0]), float(second[1])))


@dataclass(frozen=True)
class Displaced:
    """A curve whose ends have moved: the displacement of the ends is blended linearly along it."""

    curve: Curve
    first: tuple[float, float]
    second: tuple[float, float]

    @property
    def breaks(self) -> Array:
        """Parameters where the curve is not smooth."""
        return breaks_of(self.curve)

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t``."""
        t = np.asarray(t, dtype=float)[:, None]
        return np.asarray(self.curve(t[:, 0]) + (1.0 - t) * np.array(self.first) + t * np.array(self.second))
