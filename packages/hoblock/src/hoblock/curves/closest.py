"""Closest points on curves, and curves cut at points that lie on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.curves.curve import Curve, breaks_of
from hoblock.curves.piece import piece
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["closest_parameters", "cut_at"]

_SAMPLES = 64
"""Samples of each smooth part of the curve."""
_AT_ONCE = 1 << 20
"""Distances from samples computed at a time: bounds the memory, 16 MB."""
_SECTIONS = 80
"""Golden sections that bring a bracket down to round-off."""
_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def closest_parameters(curve: Curve, points: ArrayLike) -> tuple[Array, Array]:
    """Parameters of the places on a curve that are closest to points, and their distances.

    Samples of the curve tell where; golden sections on both sides of the best sample find the minimum. Distances are
    accurate to round-off, and so are parameters of points on the curve; those of points off it to about 1e-8.

    Parameters
    ----------
    curve : Curve
    points : array_like, shape (k, 2)

    Returns
    -------
    t, distance : ndarray, shape (k,)

    Raises
    ------
    CurveError
        If a point is not finite.
    """
    points = np.array(points, dtype=float).reshape(-1, 2)
    if not np.isfinite(points).all():
        bad = int(np.argmin(np.isfinite(points).all(axis=1)))
        raise CurveError(f"closest place on a curve: points[{bad}] is {points[bad].tolist()}; expected finite numbers.")
    ends = np.concatenate(([0.0], breaks_of(curve), [1.0]))
    grid = np.unique(np.concatenate([np.linspace(a, b, _SAMPLES + 1) for a, b in pairwise(ends)]))
    best = _best_samples(np.asarray(curve(grid)), points)

    def distance(t: Array) -> Array:
        return np.asarray(np.hypot(*(np.asarray(curve(t)) - points).T))

    before, after = grid[np.maximum(best - 1, 0)], grid[np.minimum(best + 1, len(grid) - 1)]
    brackets = (before, grid[best]), (grid[best], after)
    candidates = np.stack([grid[best], *(_golden_sections(distance, low, high) for low, high in brackets)])
    found = np.stack([distance(t) for t in candidates])
    choice = found.argmin(axis=0)[None]
    return np.take_along_axis(candidates, choice, axis=0)[0], np.take_along_axis(found, choice, axis=0)[0]


def _best_samples(samples: Array, points: Array) -> NDArray[np.int64]:
    """Return the number of the sample that is closest to each point."""
    best = np.empty(len(points), dtype=np.int64)
    step = max(1, _AT_ONCE // len(samples))
    for start in range(0, len(points), step):
        part = points[start : start + step, None] - samples[None]
        best[start : start + step] = np.einsum("pnd,pnd->pn", part, part).argmin(axis=1)
    return best


def _golden_sections(distance: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Return the places of the smallest distances in brackets, each with one minimum."""
    for _ in range(_SECTIONS):
        first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        nearer = distance(first) < distance(second)
        low, high = np.where(nearer, low, first), np.where(nearer, second, high)
    return 0.5 * (low + high)


def cut_at(curve: Curve, points: ArrayLike, *, tolerance: float, names: Sequence[str] = ()) -> tuple[Curve, ...]:
    """Cut a curve at points that lie on it.

    Parameters
    ----------
    curve : Curve
    points : array_like, shape (k, 2)
        In the order of the curve, without its ends.
    tolerance : float
        How far a point may be off the curve.
    names : sequence of str
        Of the points, for messages.

    Returns
    -------
    tuple of Curve
        The k + 1 parts.

    Raises
    ------
    CurveError
        If a point is off the curve, or they follow each other in another order.
    """
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    names = list(names) or [f"points[{k}]" for k in range(len(points))]
    t, distances = closest_parameters(curve, points)
    for k, gap in enumerate(distances):
        if not gap <= tolerance:
            x, y = np.asarray(curve(t[k : k + 1]))[0]
            raise CurveError(
                f"'{names[k]}' at ({points[k, 0]:.10g}, {points[k, 1]:.10g}) is {gap:.2g} off the curve, whose closest "
                f"point is ({x:.17g}, {y:.17g}); must lie on it within {tolerance:.1g}. Move it there, or let "
                "it be moved (project = true in a scene)."
            )
    parameters = np.concatenate(([0.0], t, [1.0]))
    if not (np.diff(parameters) > 0.0).all():
        raise CurveError(
            f"the curve passes {', '.join(names)} at t = {', '.join(f'{one:.4g}' for one in t)}; expected ascending "
            "parameters between 0 and 1. Check the order of the path and the direction of the curve."
        )
    return tuple(piece(curve, float(a), float(b)) for a, b in pairwise(parameters))
