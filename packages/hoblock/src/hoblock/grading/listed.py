"""Gradings that list the corners of the elements."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError
from hoblock.grading.grading import EdgeShape

Array = NDArray[np.float64]

__all__ = ["Listed"]


@dataclass(frozen=True)
class Listed:
    """Element corners one by one, for an edge with as many elements.

    Between the corners the map is linear. An edge with another number of elements is an error where its nodes are
    placed, by `element_corners`.

    Attributes
    ----------
    positions : tuple of float
        One more than there are elements: ascending from 0 to 1, as parameters of the edge.
    """

    positions: tuple[float, ...]

    def __post_init__(self) -> None:
        corners = _numbers(self.positions, "positions")
        object.__setattr__(self, "positions", tuple(corners.tolist()))
        if len(corners) < 2 or corners[0] != 0.0 or corners[-1] != 1.0:
            raise GradingError(
                f"listed grading: the positions are {_shown(corners)}; expected them to begin with 0 and to end with "
                "1. List every corner, those at the vertices too."
            )
        if not np.all(np.diff(corners) > 0.0):
            k = int(np.argmin(np.diff(corners) > 0.0))
            raise GradingError(
                f"listed grading: position {k + 1} is {corners[k + 1]:.17g} after {corners[k]:.17g}; expected strictly "
                "ascending positions. Sort them and remove doubles."
            )

    @staticmethod
    def of_sizes(sizes: Iterable[float]) -> Listed:
        """Return the grading with elements in the ratio of the given sizes, which need not add up to 1.

        Raises
        ------
        GradingError
            If there are none, or one is not positive.
        """
        given = _numbers(sizes, "sizes")
        if not len(given) or not np.all(given > 0.0):
            raise GradingError(
                f"listed grading: the sizes are {_shown(given)}; expected at least one, all of them positive."
            )
        ends = np.cumsum(given)
        return Listed((0.0, *(ends[:-1] / ends[-1]).tolist(), 1.0))

    @staticmethod
    def at_lengths(shape: EdgeShape, lengths: Array) -> Listed:
        """Return the grading with inner corners at given arc lengths from the first end of an edge.

        Parameters
        ----------
        shape : EdgeShape
        lengths : ndarray, shape (n - 1,)
            Ascending, strictly between 0 and the edge's length.

        Raises
        ------
        GradingError
            If an element is so short that rounding swallows it.
        """
        inner = np.asarray(lengths, dtype=float)
        corners = np.concatenate(([0.0], np.asarray(shape.parameters(inner)), [1.0]))
        if not np.all(np.diff(corners) > 0.0):
            k = int(np.argmin(np.diff(corners) > 0.0))
            size = np.diff(inner, prepend=0.0, append=shape.length)[k]
            raise GradingError(
                f"element {k} of {len(inner) + 1} would have the length {size:.3g} on an edge of length "
                f"{shape.length:.6g}, which rounding swallows. Take larger sizes, a weaker growth or fewer elements."
            )
        return Listed(tuple(corners.tolist()))

    @property
    def count(self) -> int:
        """Number of elements."""
        return len(self.positions) - 1

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``."""
        return np.asarray(np.interp(s, np.linspace(0.0, 1.0, self.count + 1), self.positions))

    def __str__(self) -> str:
        return f"the listed grading of {self.count} elements"


def _numbers(values: Iterable[float], what: str) -> Array:
    try:
        numbers = np.array(tuple(values), dtype=float)
    except (TypeError, ValueError) as error:
        raise GradingError(f"listed grading: {what} are {values!r}; expected a sequence of numbers.") from error
    if numbers.ndim != 1 or not np.all(np.isfinite(numbers)):
        raise GradingError(f"listed grading: {what} are {_shown(numbers)}; expected a sequence of finite numbers.")
    return numbers


def _shown(numbers: Array) -> str:
    return np.array2string(numbers, separator=", ", threshold=6, edgeitems=2, precision=6)
