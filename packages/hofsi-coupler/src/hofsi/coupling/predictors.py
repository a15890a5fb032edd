"""Predicted interface displacement at the new time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hofsi.timestepping.schemes import extrapolation_weights

Array = NDArray[np.float64]

__all__ = ["predict"]


def predict(history: Sequence[Array], steps: Sequence[float], order: int, velocity: Array | None = None) -> Array:
    """Extrapolate by a polynomial through the last values.

    Parameters
    ----------
    history : sequence of ndarray
        Values at the ends of the last steps, newest first.
    steps : sequence of float
        Sizes of the step to be made and of those before it.
    order : int
        Wanted order; fewer values give a lower one.
    velocity : ndarray, optional
        At the start of the step; makes order 1 of a single value.
    """
    if velocity is not None and len(history) == 1 and order > 0:
        return history[0] + steps[0] * velocity
    order = min(order, len(history) - 1, len(steps) - 1)
    weights = extrapolation_weights(steps, order)
    return np.asarray(np.tensordot(weights, np.stack(history[: order + 1]), axes=1))
