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
Index = NDArray[np.int64]

__all__ = ["closest_parameters", "cut_at"]

_SAMPLES, _SAMPLES_OF_PART = 1024, 64
"""Samples of the whole curve, so that hairpins show, and of each smooth part at least."""
_AT_ONCE = 1 << 20
"""Distances from samples computed at a time: bounds the memory, 16 MB."""
_SECTIONS = 80
"""Golden sections that bring a bracket down to round-off."""
_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def closest_parameters(curve: Curve, points: ArrayLike) -> tuple[Array, Array]:
    """Parameters of the places on a curve that are closest to points, and their distances.

    Samples of the curve tell where; golden sections on both sides of the best samples find the minimum. Distances are
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
    count = max(_SAMPLES // (len(ends) - 1), _SAMPLES_OF_PART)
    grid = np.unique(np.concatenate([np.linspace(a, b, count + 1) for a, b in pairwise(ends)]))
    which, sample = _candidates(np.asarray(curve(grid)), points)
    places = points[which]

    def distance(t: Array) -> Array:
        return np.asarray(np.hypot(*(np.asarray(curve(t)) - places).T))

    before, after = grid[np.maximum(sample - 1, 0)], grid[np.minimum(sample + 1, len(grid) - 1)]
    brackets = (before, grid[sample]), (grid[sample], after)
    t = np.concatenate([grid[sample], *(_golden_sections(distance, low, high) for low, high in brackets)])
    found, which = np.concatenate([distance(part) for part in np.split(t, 3)]), np.tile(which, 3)
    order = np.lexsort((found, which))
    best = order[np.searchsorted(which[order], np.arange(len(points)))]
    return t[best], found[best]


def _candidates(samples: Array, points: Array) -> tuple[Index, Index]:
    """Pairs of a point and a sample of the curve near which the closest place may be, at least one a point.

    The curve comes nearer between samples by no more than about their distance; all minima that are less than that
    behind the smallest one stay in play, since another branch of the curve may be sampled more luckily.
    """
    steps = np.hypot(*np.diff(samples, axis=0).T)
    reach = np.maximum(np.append(steps, 0.0), np.append(0.0, steps))
    found: list[tuple[Index, Index]] = []
    for start in range(0, len(points), max(1, _AT_ONCE // len(samples))):
        part = points[start : start + max(1, _AT_ONCE // len(samples)), None] - samples[None]
        distance = np.hypot(part[..., 0], part[..., 1])
        padded = np.pad(distance, ((0, 0), (1, 1)), constant_values=np.inf)
        minimum = (distance <= padded[:, :-2]) & (distance <= padded[:, 2:])
        k, sample = np.nonzero(minimum & (distance - reach <= distance.min(axis=1, keepdims=True)))
        found.append((start + k, sample))
    return (
        np.concatenate([k for k, _ in found] or [np.zeros(0, dtype=np.int64)]),
        np.concatenate([sample for _, sample in found] or [np.zeros(0, dtype=np.int64)]),
    )


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
