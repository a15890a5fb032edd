"""The points where two isolines cross."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.strip import RELATIVE_STEP, Function, gradient_of, own_gradient, values_of
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["crossing_of_level_sets"]

_ITERATIONS = 60
_PARALLEL = 1e-6  # sine of the angle between isolines below which they touch rather than cross
_NAME = "crossing of level sets"


def crossing_of_level_sets(
    functions: tuple[Function, Function],
    point: Array,
    *,
    levels: tuple[float, float] = (0.0, 0.0),
    reach: float | None = None,
) -> Array:
    """Move a point to where two isolines cross, by Newton's method.

    Parameters
    ----------
    functions : pair of callables
        Points (n, 2) to values (n,); gradients are their methods ``gradient``, else central differences.
    point : ndarray, shape (2,)
        Close to the crossing.
    levels : (float, float)
    reach : float, optional
        How far the point may move; default: as far as it takes.

    Returns
    -------
    ndarray, shape (2,)
        On both isolines to round-off.

    Raises
    ------
    CurveError
        If there is no crossing within reach, or the isolines touch without crossing.
    """
    start = np.asarray(point, dtype=float)
    if start.shape != (2,) or not np.isfinite(start).all():
        raise CurveError(f"{_NAME}: the point is {start.tolist()}; expected two finite coordinates.")
    size, limit = (1.0, np.inf) if reach is None else (reach, reach)
    x, last = start.copy(), np.inf
    floor = 4.0 * np.finfo(float).eps * max(float(np.abs(start).max()), size)
    for _ in range(_ITERATIONS):
        values, slopes = _linearised(functions, levels, x, size)
        lengths = np.hypot(slopes[:, 0], slopes[:, 1])
        if abs(np.linalg.det(slopes)) <= _PARALLEL * lengths.prod():
            raise CurveError(
                f"{_NAME}: at ({x[0]:.6g}, {x[1]:.6g}) the isolines are parallel; expected a crossing near "
                f"({start[0]:.6g}, {start[1]:.6g}). Start closer to one."
            )
        step = -np.linalg.solve(slopes, values)
        length = float(np.hypot(*step))
        x = x + step * min(1.0, limit / length if length > 0.0 else 1.0)
        if not np.hypot(*(x - start)) <= limit:
            break
        if length <= floor or (length <= 1e4 * floor and length >= 0.5 * last):
            return np.asarray(x)
        last = length
    within = "" if reach is None else f" within {reach:.6g} of it"
    raise CurveError(
        f"{_NAME}: none found{within} from ({start[0]:.6g}, {start[1]:.6g}). Start closer to it, or check the levels."
    )


def _linearised(
    functions: tuple[Function, Function], levels: tuple[float, float], x: Array, size: float
) -> tuple[Array, Array]:
    """Values less levels (2,) and gradients (2, 2) of both functions."""
    at, step = x[None, :], RELATIVE_STEP * size
    values = [values_of(f, at, _NAME)[0] - level for f, level in zip(functions, levels, strict=True)]
    slopes = [gradient_of(f, own_gradient(f, None), at, step, _NAME)[0] for f in functions]
    return np.array(values), np.array(slopes)
