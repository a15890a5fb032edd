"""Which ends of an edge have the small elements."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import GradingError

__all__ = ["Ends", "check_ends", "opposite", "steps_from_ends"]

Ends = Literal["first", "second", "both"]
"""At the first vertex of an edge, at the second, or at both."""


def check_ends(ends: str, kind: str) -> None:
    """Raise a GradingError if ``ends`` is none of the three."""
    if ends not in ("first", "second", "both"):
        raise GradingError(f"{kind}: ends is {ends!r}; expected 'first', 'second' or 'both'.")


def opposite(ends: Ends) -> Ends:
    """Return the same ends for somebody who walks the other way."""
    swapped: dict[Ends, Ends] = {"first": "second", "second": "first", "both": "both"}
    return swapped[ends]


def steps_from_ends(count: int, sides: int) -> NDArray[np.int64]:
    """Steps of each element from the first one, or for two sides from the nearer end, shape (count,)."""
    steps = np.arange(count, dtype=np.int64)
    return steps if sides == 1 else np.minimum(steps, steps[::-1])
