"""Heights of the elements across a boundary layer, functions of plain numbers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hoblock.grading.ends import steps_from_ends

Array = NDArray[np.float64]

__all__ = ["capped_heights", "constant_growth", "elements_needed", "grown_heights", "layer_elements"]


def constant_growth(first: float, steps: NDArray[np.int64], total: float) -> float:
    """Return q > 0 with Σ first q^steps = total.

    Newton's method for the logarithm of the sum as a function of log q: increasing and convex, so that it converges
    from anywhere, and never overflows. There must be a step that is not 0, and those that are must leave something.
    """
    x = 0.0
    goal = math.log(total / first)
    for _ in range(500):
        exponents = x * steps
        largest = exponents.max()
        terms = np.exp(exponents - largest)
        change = (largest + math.log(terms.sum()) - goal) * terms.sum() / float(terms @ steps)
        x -= change
        if abs(change) <= 1e-15 * max(1.0, abs(x)):
            break
    return math.exp(x)


def grown_heights(first: float, growth: float, steps: NDArray[np.int64], most: float) -> Array:
    """Return first growth^steps, not above ``most`` or far above it (what is beyond may be infinite)."""
    logs = np.minimum(steps * math.log(growth), math.log(2.0 * most / first))
    return np.asarray(first * np.exp(logs))


def capped_heights(first: float, growth: float, steps: NDArray[np.int64], total: float) -> Array | None:
    """Heights that grow until the remaining elements, all of one height, are no larger than the next would be.

    These are min(first growth^steps, u), with the u that makes them add up to the total. Where the first is larger
    than the even height they shrink by 1/growth down to u in the same way. None if no u does.
    """
    shrinking = first * len(steps) > total
    heights = grown_heights(first, 1.0 / growth if shrinking else growth, steps, total)
    ordered = np.sort(heights)[::-1] if shrinking else np.sort(heights)
    before = np.concatenate(([0.0], np.cumsum(ordered)[:-1]))
    rest = (total - before) / np.arange(len(steps), 0, -1)
    slack = 1e-13 * total
    fits = rest >= ordered - slack if shrinking else rest <= ordered + slack
    if not fits.any():
        return None
    even = float(rest[np.argmax(fits)])
    return np.maximum(heights, even) if shrinking else np.minimum(heights, even)


def layer_elements(first: float, growth: float, thickness: float) -> int:
    """Return the smallest number of growing elements that reach a thickness."""
    ratio = thickness / first * (1.0 - 1e-12)
    number = ratio if growth == 1.0 else math.log1p(ratio * (growth - 1.0)) / math.log(growth)
    return max(1, math.ceil(number))


def elements_needed(first: float, growth: float, sides: int, total: float) -> int:
    """Return the smallest number of elements, growing from one side or both, that reach a total."""
    count = sides * layer_elements(first, growth, total / sides)
    while count > 1:
        fewer = grown_heights(first, growth, steps_from_ends(count - 1, sides), total)
        if float(fewer.sum()) < total:
            break
        count -= 1
    return count
