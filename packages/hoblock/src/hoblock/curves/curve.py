"""What every curve offers: a map t ∈ [0, 1] → (n, 2), the geometry of a block edge."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["Curve", "CuttableCurve", "PiecewiseCurve", "breaks_of"]


class Curve(Protocol):
    """Geometry of a block edge, from its first vertex at t = 0 to its second at t = 1."""

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t`` of shape (n,), returned with shape (n, 2)."""
        ...


@runtime_checkable
class CuttableCurve(Curve, Protocol):
    """A curve that is a part of something longer, such as a circle, on which its ends can slide."""

    def cut(self, first: Array, second: Array) -> Curve | None:
        """Return the part between ends near the present ones, or None if they do not lie on it."""
        ...


@runtime_checkable
class PiecewiseCurve(Curve, Protocol):
    """A curve that is smooth in pieces only."""

    @property
    def breaks(self) -> Array:
        """Parameters strictly between 0 and 1, ascending, where the curve is less smooth than in between."""
        ...


def breaks_of(curve: Curve | None) -> Array:
    """Breaks of a curve; none of one that does not tell or of a straight edge."""
    return np.asarray(curve.breaks, dtype=float) if isinstance(curve, PiecewiseCurve) else np.zeros(0)
