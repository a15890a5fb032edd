"""The points of an isoline that are nearest to given ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.strip import RELATIVE_STEP, Function, gradient_of, own_gradient, ratio, values_of
from hoblock.errors import CurveError

Array = NDArray[np.float64]

__all__ = ["nearest_on_level_set"]

_ITERATIONS = 100
_SLID = 1e-13  # last step along the isoline, relative to the size of things
_LOST = 1e-6  # steps longer than this that do not get shorter lead nowhere; shorter ones are the gradient's error


def nearest_on_level_set(
    function: Function,
    points: Array,
    *,
    level: float = 0.0,
    reach: float | None = None,
    gradient: Function | None = None,
) -> Array:
    """Move points onto an isoline: to the nearest place on it, where the way is along the gradient.

    Parameters
    ----------
    function : callable
        φ, points (n, 2) to values (n,).
    points : ndarray, shape (n, 2)
        Close enough that the isoline is not bent much between them and it.
    level : float
    reach : float, optional
        How far a point may move; default: as far as it takes.
    gradient : callable, optional
        Points (n, 2) to gradients (n, 2); default as for `LevelSet`.

    Returns
    -------
    ndarray, shape (n, 2)
        On the isoline to round-off.

    Raises
    ------
    CurveError
        If there is no such place within reach of a point.

    References
    ----------
    Chopp, SIAM J. Sci. Comput. 23 (2001) 230–244, Section 2, doi:10.1137/S106482750037617X: steps towards the tangent
    of the isoline and along it, in turns.
    """
    start = np.array(points, dtype=float)
    if start.ndim != 2 or start.shape[1] != 2 or not np.isfinite(start).all():
        raise CurveError(f"level set: points have shape {start.shape}; expected finite coordinates (n, 2).")
    if not len(start):
        return start
    size = reach if reach is not None else float(np.ptp(start, axis=0).max()) or 1.0
    projection = _Projection(
        function, own_gradient(function, gradient), level, size, np.inf if reach is None else reach
    )
    along_gradient = projection.onto(start, start)
    nearest = projection.onto(projection.nearer(start, along_gradient), start)
    nearer = np.hypot(*(nearest - start).T) < np.hypot(*(along_gradient - start).T)
    return np.where(nearer[:, None], nearest, along_gradient)


@dataclass(frozen=True, eq=False)
class _Projection:
    """Steps onto an isoline; ``size`` is the length that finite differences are measured by."""

    function: Function
    gradient: Function | None
    level: float
    size: float
    reach: float

    def step(self, x: Array) -> tuple[Array, Array, Array]:
        """Newton's step along the gradient, the unit gradient, and φ - level at points."""
        value = values_of(self.function, x, "nearest point on a level set") - self.level
        g = gradient_of(self.function, self.gradient, x, RELATIVE_STEP * self.size, "nearest point on a level set")
        length = np.hypot(g[:, 0], g[:, 1])
        normal = ratio(g, length[:, None], 0.0)
        return -ratio(value, length, 0.0)[:, None] * normal, normal, value

    def onto(self, x: Array, start: Array) -> Array:
        """Newton's method along the gradient until it stands still."""
        x, smallest = x.copy(), np.full(len(x), np.inf)
        active = np.arange(len(x))
        for _ in range(_ITERATIONS):
            if not active.size:
                return x
            step, normal, value = self.step(x[active])
            length = np.hypot(step[:, 0], step[:, 1])
            flat = ~normal.any(axis=1) & (value != 0.0)
            x[active] += step * np.where(length > self.reach, self.reach / np.maximum(length, 1e-300), 1.0)[:, None]
            away = np.hypot(*(x[active] - start[active]).T) > self.reach
            if (flat | away).any():
                self._fail(start[active[flat | away][0]], float(value[flat | away][0]))
            floor = 4.0 * np.finfo(float).eps * np.maximum(np.abs(x[active]).max(axis=1), self.size)
            settled = (length <= floor) | ((length <= 1e4 * floor) & (length >= 0.5 * smallest[active]))
            smallest[active] = np.minimum(smallest[active], length)
            active = active[~settled]
        self._fail(start[active[0]], float(self.step(x[active[:1]])[2][0]))

    def nearer(self, start: Array, x: Array) -> Array:
        """Slide towards the nearest places; a point whose steps do not get shorter goes back to where it began."""
        y, last = x.copy(), np.full(len(x), np.inf)
        active = np.arange(len(x))
        for _ in range(_ITERATIONS):
            if not active.size:
                break
            step, normal, _ = self.step(y[active])
            missing = start[active] - y[active]
            step += missing - (missing * normal).sum(axis=1, keepdims=True) * normal
            length = np.hypot(step[:, 0], step[:, 1])
            stalled, settled = length > 0.9 * last[active], length <= _SLID * self.size
            lost = stalled & (length > _LOST * self.size)
            y[active] = np.where(lost[:, None], x[active], y[active] + step)
            last[active] = length
            active = active[~(stalled | settled)]
        return y

    def _fail(self, point: Array, value: float) -> NoReturn:
        unlimited = np.isinf(self.reach)
        within = "" if unlimited else f" within {self.reach:.6g} of it"
        larger = "" if unlimited else ", take a larger reach"
        raise CurveError(
            f"nearest point on a level set: none found{within} from ({point[0]:.6g}, {point[1]:.6g}); the function "
            f"less its level was {value:.3g} at last. Start closer to the isoline{larger} or check the level."
        )
