"""What every grading offers: a strictly increasing map of [0, 1] onto itself."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["EdgeGrading", "EdgeShape", "Grading"]


class Grading(Protocol):
    """A strictly increasing map of [0, 1] onto [0, 1]; hashable, so that layouts can be shared."""

    def __call__(self, s: Array) -> Array:
        """Positions of the parameters ``s``, same shape."""
        ...

    def __hash__(self) -> int:
        """Equal gradings have equal hashes."""
        ...


class EdgeShape(Protocol):
    """What a grading may ask about the geometry of its edge."""

    @property
    def length(self) -> float:
        """Arc length."""
        ...

    @property
    def breaks(self) -> Array:
        """Parameters strictly between 0 and 1, ascending, where the edge's curve is not smooth."""
        ...

    def parameters(self, lengths: Array) -> Array:
        """Parameters in [0, 1] of the places at given arc lengths from the first end, same shape."""
        ...


@runtime_checkable
class EdgeGrading(Protocol):
    """A grading that depends on the edge it is on: on its length, or on the number of elements.

    It is resolved anew for every position of the edge, so that lengths it prescribes are kept when the edge moves.
    """

    def resolved(self, shape: EdgeShape, count: int) -> Grading:
        """Return the grading of an edge of some shape with ``count`` elements.

        Raises
        ------
        GradingError
            If it does not fit.
        """
        ...

    def __hash__(self) -> int:
        """Equal gradings have equal hashes."""
        ...
