"""Arrays that are used again: fresh ones of this size cost more in page faults than the work on them (measured)."""

from __future__ import annotations

import threading
from math import prod

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["scratch"]

_KEPT = threading.local()
_LARGEST = 1 << 20
"""Numbers in an array that is kept; larger ones are fresh each time."""


def scratch(name: str, shape: tuple[int, ...]) -> Array:
    """Return an uninitialised array, the memory of the last one of that name in this thread if it is large enough."""
    size = prod(shape)
    if size > _LARGEST:
        return np.empty(shape)
    kept: Array | None = getattr(_KEPT, name, None)
    if kept is None or kept.size < size:
        kept = np.empty(size)
        setattr(_KEPT, name, kept)
    return kept[:size].reshape(shape)
