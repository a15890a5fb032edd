"""A part of a curve, as a split edge has it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.arc import Arc
from hoblock.curves.curve import Curve, CuttableCurve, breaks_of
from hoblock.curves.derived import Displaced, Reversed, reverse
from hoblock.curves.ellipse import Ellipse
from hoblock.curves.nodal import NodalCurve
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["Piece", "piece"]

_BETWEEN = 1e-9
"""Distance in elements within which a place is that between two elements."""


@dataclass(frozen=True)
class Piece:
    """The part of a curve between two of its parameters; a part of a part is one of the whole.

    Parameters
    ----------
    curve : Curve
    start, stop : float
        Parameters of the whole at the ends of the part, 0 <= start < stop <= 1.
    """

    curve: Curve
    start: float
    stop: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.start < self.stop <= 1.0:
            raise CurveError(
                f"piece of a curve: from {self.start:g} to {self.stop:g}; expected 0 <= start < stop <= 1. "
                "Reverse the curve to walk it backwards."
            )
        if isinstance(self.curve, Piece):
            whole = self.curve
            start, stop = (float(whole.inside(np.array([t]))[0]) for t in (self.start, self.stop))
            for name, value in (("curve", whole.curve), ("start", start), ("stop", stop)):
                object.__setattr__(self, name, value)

    def inside(self, t: Array) -> Array:
        """Parameters of the whole curve at parameters of the part; its ends are exact."""
        return np.asarray((1.0 - t) * self.start + t * self.stop)

    @property
    def breaks(self) -> Array:
        """Parameters of the part where the curve is not smooth."""
        t = (breaks_of(self.curve) - self.start) / (self.stop - self.start)
        return np.asarray(t[(t > 1e-12) & (t < 1.0 - 1e-12)])

    def cut(self, first: Array, second: Array) -> Curve | None:
        """Return a part of the whole between other ends, if the whole can be cut so."""
        own = piece(self.curve, self.start, self.stop)
        curve = self.curve if isinstance(own, Piece) else own  # angles are sought near those of the part
        return curve.cut(first, second) if isinstance(curve, CuttableCurve) else None

    def __call__(self, t: Array) -> Array:
        """Points at the parameters ``t`` of the part."""
        return self.curve(self.inside(np.asarray(t, dtype=float)))


def piece(curve: Curve, start: float, stop: float) -> Curve:
    """Return the part of a curve between two parameters, of the curve's own kind where that is simple.

    So it is for arcs, ellipses, whole elements of nodal curves, and these reversed or with displaced ends.

    Raises
    ------
    CurveError
        If the parameters are not ascending in [0, 1].
    """
    part = Piece(curve, start, stop)
    whole, start, stop = part.curve, part.start, part.stop
    if (start, stop) == (0.0, 1.0):
        return whole
    match whole:
        case Arc(center, radius, angle, opening):
            return Arc(center, radius, angle + start * opening, (stop - start) * opening)
        case Ellipse(center, radii, rotation, angle, opening):
            return Ellipse(center, radii, rotation, angle + start * opening, (stop - start) * opening)
        case NodalCurve():
            return _nodal_piece(whole, start, stop) or part
        case Reversed(inner):
            return reverse(piece(inner, 1.0 - stop, 1.0 - start))
        case Displaced(inner, first, second):
            a, b = np.array(first), np.array(second)
            ends = ((1.0 - t) * a + t * b for t in (start, stop))
            return Displaced(piece(inner, start, stop), *((float(x), float(y)) for x, y in ends))
    return part


def _nodal_piece(curve: NodalCurve, start: float, stop: float) -> NodalCurve | None:
    """Nodes of whole elements, None if the ends are not between elements."""
    first, last = round(start * curve.count), round(stop * curve.count)
    if max(abs(first - start * curve.count), abs(last - stop * curve.count)) >= _BETWEEN or first >= last:
        return None
    return NodalCurve(curve.points[first * curve.order : last * curve.order + 1], curve.order)
