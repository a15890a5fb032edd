"""Points that define a curve: checked once, when the curve is made."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["distinct_neighbours", "plane_points", "positive_weights"]


def plane_points(points: ArrayLike, kind: str, least: int) -> Array:
    """Return points as a read-only array (n, 2) of at least so many finite ones, or raise CurveError."""
    try:
        array = np.array(points, dtype=float)
    except (TypeError, ValueError):
        raise CurveError(f"{kind}: points are {points!r}; expected pairs of numbers, shape (n, 2).") from None
    if array.ndim != 2 or array.shape[1] != 2:
        raise CurveError(f"{kind}: points have shape {array.shape}; expected (n, 2).")
    if len(array) < least:
        raise CurveError(f"{kind}: {len(array)} points; expected at least {least}, both ends included.")
    finite = np.isfinite(array).all(axis=1)
    if not finite.all():
        bad = int(np.argmin(finite))
        raise CurveError(f"{kind}: points[{bad}] is {array[bad].tolist()}; expected finite coordinates.")
    array.setflags(write=False)
    return array


def distinct_neighbours(points: Array, kind: str) -> Array:
    """Return the distances between neighbouring points; equal neighbours are an error."""
    distances = np.hypot(*np.diff(points, axis=0).T)
    if not (distances > 0.0).all():
        k = int(np.argmin(distances))
        x, y = points[k]
        raise CurveError(f"{kind}: points[{k}] and points[{k + 1}] are both ({x:g}, {y:g}). Remove one of them.")
    return np.asarray(distances)


def positive_weights(weights: ArrayLike | None, count: int, kind: str) -> Array | None:
    """Return one positive weight a point as a read-only array, None for none, or raise CurveError."""
    if weights is None:
        return None
    array = np.array(weights, dtype=float)
    if array.shape != (count,):
        raise CurveError(f"{kind}: weights have shape {array.shape}; expected ({count},), one for each point.")
    if not (np.isfinite(array) & (array > 0.0)).all():
        k = int(np.argmin(np.isfinite(array) & (array > 0.0)))
        raise CurveError(f"{kind}: weights[{k}] is {array[k]:g}; expected a positive number.")
    array.setflags(write=False)
    return array
