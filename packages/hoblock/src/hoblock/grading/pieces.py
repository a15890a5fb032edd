"""Element corners where a curve is not smooth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.grading.grading import EdgeShape, Grading
from hoblock.grading.listed import Listed
from hoblock.grading.paper import Uniform

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Pieces"]

_TIE = 1e-6  # relative difference of two lengths that count as equal, so that rounding decides nothing


@dataclass(frozen=True)
class Pieces:
    """Corners exactly at the breaks of a piecewise curve, such as a polyline or a spline, so that no element has one.

    Inside a piece the elements have equal *parameter* lengths; on a polyline these are equal arc lengths. A curve
    without breaks is one piece.

    Attributes
    ----------
    counts : tuple of int, optional
        Elements of each piece, from the first vertex. If missing, the elements of the edge are shared out by arc
        length: every piece gets one, then each further one goes where the elements are largest. On a curve whose
        pieces change their lengths as it moves, an element may so change its piece; given counts never do.
    """

    counts: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        if self.counts is None:
            return
        counts = tuple(self.counts)
        if not counts or not all(_is_count(count) for count in counts):
            raise GradingError(f"pieces: counts are {counts!r}; expected whole numbers of at least 1, one a piece.")
        object.__setattr__(self, "counts", tuple(int(count) for count in counts))

    def resolved(self, shape: EdgeShape, count: int) -> Grading:
        """Return the grading of an edge of some shape with ``count`` elements.

        Raises
        ------
        GradingError
            If there are fewer elements than pieces, or the given counts do not fit.
        """
        bounds = np.concatenate(([0.0], np.asarray(shape.breaks, dtype=float), [1.0]))
        pieces = len(bounds) - 1
        if self.counts is not None:
            counts = self._given(pieces, count)
        elif pieces > count:
            raise GradingError(
                f"pieces: the curve has {pieces} pieces, the edge {_elements(count)}; take at least {pieces} elements, "
                "or another grading."
            )
        elif pieces == 1:
            return Uniform()
        else:
            counts = _shared_out(count, _lengths(shape, bounds))
        pieces_of = zip(bounds[:-1], bounds[1:], counts, strict=True)
        inner = [first + (last - first) * np.arange(n) / n for first, last, n in pieces_of]
        return Listed((*np.concatenate(inner).tolist(), 1.0))

    def _given(self, pieces: int, count: int) -> Index:
        counts = np.array(self.counts, dtype=np.int64)
        if len(counts) != pieces or counts.sum() != count:
            given = f"{len(counts)} pieces and {_elements(int(counts.sum()))}"
            raise GradingError(
                f"pieces: counts {tuple(counts.tolist())} are for {given}; the curve has {pieces} pieces, the edge "
                f"{_elements(count)}. Change either, or leave the counts out."
            )
        return counts


def _is_count(value: object) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and int(value) >= 1


def _elements(count: int) -> str:
    return f"{count} element" + "s" * (count != 1)


def _lengths(shape: EdgeShape, bounds: Array) -> Array:
    """Arc lengths of the pieces: the shape's map from lengths to parameters, inverted by bisection."""
    low, high = np.zeros(len(bounds) - 2), np.full(len(bounds) - 2, shape.length)
    for _ in range(40):  # 1e-12 of the length: far below what counts as a tie
        middle = (low + high) / 2.0
        below = shape.parameters(middle) < bounds[1:-1]
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.diff(np.concatenate(([0.0], high, [shape.length])))


def _shared_out(count: int, lengths: Array) -> Index:
    """Share elements out over pieces so that the largest element is as small as possible."""
    counts = np.ones(len(lengths), dtype=np.int64)
    for _ in range(count - len(lengths)):
        sizes = lengths / counts
        counts[np.argmax(sizes >= (1.0 - _TIE) * sizes.max())] += 1
    return counts
