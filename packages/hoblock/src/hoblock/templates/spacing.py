"""Exponential gradings from what users know: sizes of elements and their growth."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from hoblock.grading import Exponential

__all__ = ["first_size", "graded_lines", "with_first_size"]

_STEEPEST = 45.0
"""Largest |a| asked of an exponential grading, a little less than it takes."""


def first_size(a: float, count: int) -> float:
    """Size of the first of ``count`` elements on an edge of length 1 with an exponential grading."""
    return float(Exponential(a)(np.array([1.0 / count]))[0])


def with_first_size(length: float, count: int, first: float) -> Exponential:
    """Return the exponential grading whose first element has a given size, as nearly as |a| <= 45 allows.

    Parameters
    ----------
    length : float
        Of the edge.
    count : int
        Elements on it.
    first : float
        Size of the first element; more than ``length/count`` makes the elements shrink.
    """
    if count == 1:
        return Exponential(0.0)
    target = first / length
    low, high = -_STEEPEST, _STEEPEST
    for _ in range(60):  # the first size falls with a
        middle = 0.5 * (low + high)
        low, high = (middle, high) if first_size(middle, count) > target else (low, middle)
    return Exponential(0.5 * (low + high))


def graded_lines(start: float, stop: float, blocks: int, a: float) -> list[float]:
    """Return positions of block lines such that a / blocks within each block gives one grading ``a`` over all."""
    positions = Exponential(a)(np.linspace(0.0, 1.0, blocks + 1))
    lines = [start + (stop - start) * float(s) for s in positions]
    lines[-1] = stop
    if any(second <= first for first, second in pairwise(lines)):
        raise ValueError("lines coincide")
    return lines
