"""Where three channels meet: the vertices that share out the angles, found by minimising an energy of corners."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Quad = tuple[str, str, str, str]

__all__ = ["balanced"]

_SOFT = 0.1
"""Sines of corner angles below this no longer weigh more as strongly, so that a corner turned over can return."""

_DIGITS = 3
"""Digits kept of the unknowns: the layout shall be the same on every machine, whatever its rounding."""

_SIZES = 0.1
"""Weight of edge lengths beside angles."""


def balanced(
    positions: Callable[[Array], Mapping[str, Array]],
    start: Array,
    quads: Sequence[Quad],
    tangents: Callable[[Array], Mapping[tuple[str, str], Array]],
    free: Sequence[str],
    size: float,
) -> Array:
    """Unknowns of a layout for which its blocks have good corners.

    Parameters
    ----------
    positions : callable
        Vertices by name as a function of the unknowns.
    start : ndarray, shape (n,)
        Unknowns to begin with, of order 1.
    quads : sequence of Quad
        Blocks, counter-clockwise.
    tangents : callable
        Directions of curved edges at their first vertex, for edges given as (first, second), of the unknowns.
    free : sequence of str
        Vertices whose edges count with their lengths.
    size : float
        Length these edges should have.

    Returns
    -------
    ndarray, shape (n,)
        A local minimum of Σ 1/sin²(corner angle) + 0.1 Σ ln²(length/size).
    """
    from scipy.optimize import minimize

    corners = [(quad[k], quad[(k + 1) % 4], quad[k - 1]) for quad in quads for k in range(4)]
    edges = sorted({tuple(sorted((a, b))) for a, b, _ in corners if a in free or b in free})

    def energy(unknowns: Array) -> float:
        x, curved = positions(unknowns), tangents(unknowns)
        e = np.array([curved.get((a, b), x[b] - x[a]) for a, b, _ in corners])
        f = np.array([curved.get((a, c), x[c] - x[a]) for a, _, c in corners])
        sine = (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]) / (np.hypot(*e.T) * np.hypot(*f.T) + 1e-300)
        soft = 0.5 * (sine + np.sqrt(sine**2 + _SOFT**2))
        lengths = np.array([np.hypot(*(x[b] - x[a])) for a, b in edges]) / size
        return float(np.sum(soft**-2.0) + _SIZES * np.sum(np.log(lengths + 1e-300) ** 2))

    found = minimize(energy, start, method="BFGS", options={"gtol": 1e-5}).x
    return np.asarray(np.round(found, _DIGITS))
