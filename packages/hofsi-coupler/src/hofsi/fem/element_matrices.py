"""Element matrices in batches that stay in the processor's cache while they are made and used."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["ElementMatrices", "MatrixMaker", "TracedMatrices", "batches", "maker", "origin_of"]

_BATCH = 1 << 20
"""Bytes of the matrices in a batch: half a MiB to two take the least time, all at once twice as much."""

MatrixMaker: TypeAlias = Callable[[slice], Array]
"""Some elements → their matrices, shape (m, k, k)."""

ElementMatrices: TypeAlias = "Array | MatrixMaker"
"""All matrices, shape (e, k, k), or what makes those of some elements."""


def batches(count: int, width: int) -> Iterator[slice]:
    """Divide elements, with matrices of ``width`` rows, into batches."""
    size = max(1, _BATCH // (8 * width * width))
    return (slice(start, min(count, start + size)) for start in range(0, count, size))


def maker(A: ElementMatrices) -> MatrixMaker:
    """Return what makes some of the matrices."""
    return A if callable(A) else A.__getitem__


@dataclass(frozen=True, eq=False)
class TracedMatrices:
    """What makes element matrices, and what they are made from: who keeps something of them can have it made again.

    Attributes
    ----------
    make : callable
    origin : object
    """

    make: MatrixMaker
    origin: object

    def __call__(self, elements: slice) -> Array:
        """Make the matrices of some elements."""
        return self.make(elements)


def origin_of(A: ElementMatrices) -> object:
    """Return what matrices are made from; None if they do not say."""
    return A.origin if isinstance(A, TracedMatrices) else None
