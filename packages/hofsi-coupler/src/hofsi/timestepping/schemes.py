"""Coefficients of backward differences and of extrapolation, for variable steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["bdf_weights", "extrapolation_weights"]


def bdf_weights(steps: Sequence[float]) -> Array:
    """Weights of the backward difference formula at the new time.

    Parameters
    ----------
    steps : sequence of float
        Step sizes, newest first: one for BDF1, two for BDF2.

    Returns
    -------
    ndarray, shape (len(steps) + 1,)
        Weights c of f'(t_{n+1}) ≈ c[0] f_{n+1} + c[1] f_n + …

    References
    ----------
    Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, Springer 1993, Section III.5.
    """
    times = np.concatenate(([0.0], -np.cumsum(steps)))
    return _derivative_of_interpolation(times)


def _derivative_of_interpolation(times: Array) -> Array:
    """Weights of the derivative at times[0] of the polynomial through all times."""
    scale = abs(times[1])
    scaled = times / scale
    powers = np.vander(scaled, increasing=True).T
    right = np.zeros(len(times))
    right[1] = 1.0
    return np.asarray(np.linalg.solve(powers, right) / scale)


def extrapolation_weights(steps: Sequence[float], order: int) -> Array:
    """Weights that extrapolate a field to the new time by a polynomial of the given order.

    Parameters
    ----------
    steps : sequence of float
        Step sizes, newest (the one to be made) first; ``order + 1`` of them are used.
    order : int
        0 repeats the last value, 1 is linear, and so on.

    Returns
    -------
    ndarray, shape (order + 1,)
        Weights of f_n, f_{n-1}, …
    """
    if len(steps) < order + 1:
        raise ValueError(f"extrapolation of order {order} needs {order + 1} steps; got {len(steps)}.")
    times = -np.cumsum(steps[: order + 1]) / steps[0]
    powers = np.vander(times, increasing=True).T
    right = np.zeros(order + 1)
    right[0] = 1.0
    return np.asarray(np.linalg.solve(powers, right))
