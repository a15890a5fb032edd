"""The isoline that leads from one end of a chord to the other: its branch, followed by continuity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from hoblock.curves.roots import bracketed_newton
from hoblock.curves.strip import Strip
from hoblock.errors import CurveError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

__all__ = ["STEEPEST", "Branch", "follow"]

STEEPEST = 20.0  # slope of the isoline against the chord from which it is no function of the chord's parameter
_COLUMNS = 32  # search lines at first, closer towards the ends, where isolines are steepest
_ROWS = 64  # samples on each, besides those near the place where a root is expected
_SPLIT = 8  # parts of an interval that is too wide to tell branches apart
_NARROWEST = 1e-6  # interval that is not split any more
_ROUNDS = 200
_SAFE = 0.25  # of the distance to the next root: deviation from a straight continuation that is still unambiguous
_AT_END = 1e-6  # offset of the branch at its ends
_REGULAR = (
    1e-6  # slope and value at a root, relative to the sampled ones beside it: less is a multiple root, more a jump
)
_EVEN = np.linspace(-1.0, 1.0, _ROWS)
_NEAR = np.concatenate([-np.geomspace(1.0, 1e-7, 25), np.geomspace(1e-7, 1.0, 25)])


@dataclass(frozen=True, eq=False)
class _Column:
    """All roots on one search line, ascending in s: positions, slopes ds/dt of the isolines, φ rising, simple roots."""

    t: float
    s: Array
    slope: Array
    rising: Mask
    regular: Mask


@dataclass(frozen=True, eq=False)
class Branch:
    """One isoline as a function s(t), known at some t, from which any other is found by Newton's method.

    Attributes
    ----------
    strip : Strip
    t, s, slope : ndarray, shape (m,)
        Known points of the branch, ascending in t, and ds/dt there.
    room : ndarray, shape (m - 1,)
        How far other roots are, at least, in each interval.
    rising : bool
        Whether φ increases with s across the branch.
    """

    strip: Strip
    t: Array
    s: Array
    slope: Array
    room: Array
    rising: bool

    def offsets(self, t: Array) -> Array:
        """The branch at any parameters in [0, 1], converged to round-off, shape (n,).

        Raises
        ------
        CurveError
            If the function changes too wildly between the known points.
        """
        k = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        guess, doubt = self._hermite(t, k)
        low, high = self._brackets(t, guess, doubt, self.room[k])
        sign = 1.0 if self.rising else -1.0

        def oriented(active: NDArray[np.int64], s: Array) -> tuple[Array, Array]:
            value, slope = self.strip.value_and_slope(t[active], s)
            return sign * value, sign * slope

        return bracketed_newton(oriented, low, high, guess, 4.0 * self.strip.rounding)

    def _hermite(self, t: Array, k: NDArray[np.int64]) -> tuple[Array, Array]:
        """Cubic Hermite interpolation in the intervals k, and a measure of its error."""
        h = self.t[k + 1] - self.t[k]
        r = (t - self.t[k]) / h
        rise, start, stop = self.s[k + 1] - self.s[k], self.slope[k] * h, self.slope[k + 1] * h
        curve = self.s[k] + r * (start + r * (3.0 * rise - 2.0 * start - stop + r * (start + stop - 2.0 * rise)))
        return np.asarray(curve), np.abs(rise - 0.5 * (start + stop)) * r * (1.0 - r)

    def _brackets(self, t: Array, guess: Array, doubt: Array, room: Array) -> tuple[Array, Array]:
        """Brackets about the guesses that hold the branch and no other root."""
        width = np.minimum(doubt + 64.0 * self.strip.rounding + 1e-9, 0.5 * room)
        sign = 1.0 if self.rising else -1.0
        left = np.arange(len(t))
        while left.size:
            a, b = guess[left] - width[left], guess[left] + width[left]
            below, above = self.strip.values(np.tile(t[left], 2), np.concatenate([a, b])).reshape(2, -1)
            missed = (sign * below > 0.0) | (sign * above < 0.0)
            lost = missed & (width[left] >= 0.5 * room[left])
            if lost.any():
                worst = float(t[left][lost][0])
                raise CurveError(
                    f"{self.strip.name}: the isoline cannot be followed at t = {worst:.6g}, near "
                    f"{_place(self.strip, worst, float(guess[left][lost][0]))}: the function changes too quickly "
                    "there. Split the edge with more vertices on the isoline, or use a smoother function."
                )
            left = left[missed]
            width[left] = np.minimum(8.0 * width[left], 0.5 * room[left])
        return guess - width, guess + width


def follow(strip: Strip, reach: float) -> Branch:
    """Follow the isoline from (0, 0) to (1, 0), which must both lie on it.

    On search lines across the chord all roots are found; the branch goes on from one line to the next with the root
    at which φ grows in the same direction and that lies where the slopes on both lines lead. Where other roots are too
    close to be sure, lines are put between. The way from the second end must be the same.

    Parameters
    ----------
    strip : Strip
    reach : float
        How far the search lines go on both sides, in chord lengths.

    Raises
    ------
    CurveError
        If there is no such branch, more than one could be meant, it turns back over the chord, or the function is not
        regular there.
    """
    t = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, _COLUMNS + 1))
    columns = _columns(strip, reach, t, np.zeros(len(t)))
    for which, column in (("first", columns[0]), ("second", columns[-1])):
        if np.abs(column.s).min(initial=np.inf) > _AT_END:
            raise CurveError(
                f"{strip.name}: the function does not change its sign across the isoline at the {which} vertex; "
                "expected one that is positive on one side and negative on the other."
            )
    for _ in range(_ROUNDS):
        path = _walk(columns, reach)
        if len(path) == len(columns):
            break
        before, after = columns[len(path) - 1], columns[len(path)]
        if after.t - before.t < _NARROWEST:
            _fail(strip, reach, before, path[-1], after)
        t = np.linspace(before.t, after.t, _SPLIT + 1)[1:]
        expected = before.s[path[-1]] + np.clip(before.slope[path[-1]], -STEEPEST, STEEPEST) * (t - before.t)
        columns[len(path) : len(path) + 1] = _columns(strip, reach, t, expected)
    else:
        _fail(strip, reach, before, path[-1], after)
    _check(strip, columns, path)
    back = _walk([_mirrored(column) for column in reversed(columns)], reach)[::-1]
    if back != path:
        _fail_between_branches(strip, columns, path)
    return _branch(strip, columns, path, reach)


def _columns(strip: Strip, reach: float, t: Array, near: Array) -> list[_Column]:
    """All roots on the search lines at some t that their samples tell apart; these are dense at ``near``."""
    dense = near[:, None] + _NEAR * reach
    s = np.concatenate([np.tile(_EVEN * reach, (len(t), 1)), dense], axis=1)
    s = np.sort(np.clip(s, -reach, reach), axis=1)
    table = strip.values(np.repeat(t, s.shape[1]), s.ravel()).reshape(s.shape)
    column, row = np.nonzero((table[:, 1:] >= 0.0) != (table[:, :-1] >= 0.0))
    below, above = table[column, row], table[column, row + 1]
    low, high = s[column, row], s[column, row + 1]
    at, sign = t[column], np.where(above > below, 1.0, -1.0)

    def oriented(active: NDArray[np.int64], s: Array) -> tuple[Array, Array]:
        value, slope = strip.value_and_slope(at[active], s)
        return sign[active] * value, sign[active] * slope

    start = low + (high - low) * (below / (below - above))
    roots = bracketed_newton(oriented, low, high, start, 4.0 * strip.rounding)
    along, across = strip.derivatives(at, roots)
    regular = _regular(strip, reach, at, roots, sign * across) & (
        np.abs(strip.values(at, roots)) <= _REGULAR * np.abs(table).max(axis=1, initial=0.0)[column]
    )
    slope = np.where(across != 0.0, -along / np.where(across != 0.0, across, 1.0), np.inf)
    parts = (roots, slope, sign > 0.0, regular)
    return [_Column(float(t[k]), *(part[column == k] for part in parts)) for k in range(len(t))]


def _regular(strip: Strip, reach: float, t: Array, s: Array, slope: Array) -> Mask:
    """Whether the slope across a root is in proportion to the values beside it."""
    beside = np.clip(np.concatenate([s - reach / _ROWS, s + reach / _ROWS]), -reach, reach)
    change = np.abs(strip.values(np.tile(t, 2), beside)).reshape(2, len(s)).max(axis=0, initial=0.0)
    return np.asarray(slope * reach / _ROWS > _REGULAR * change)


def _mirrored(column: _Column) -> _Column:
    return _Column(-column.t, column.s, -column.slope, column.rising, column.regular)


def _walk(columns: Sequence[_Column], reach: float) -> list[int]:
    """Number of the branch's root on each search line, from the root nearest to the chord, as far as it is clear."""
    if not columns[0].s.size:
        return []
    path = [int(np.argmin(np.abs(columns[0].s)))]
    for before, after in pairwise(columns):
        k = _next(before, path[-1], after, reach)
        if k is None:
            break
        path.append(k)
    return path


def _next(before: _Column, i: int, after: _Column, reach: float) -> int | None:
    """The root on the next search line that continues root i, or None if that is not clear."""
    if not after.s.size or not np.isfinite(before.slope[i]):
        return None
    continued = before.s[i] + 0.5 * (after.t - before.t) * (before.slope[i] + after.slope)
    deviation = np.where(after.rising == before.rising[i], np.abs(after.s - continued), np.inf)
    k = int(np.argmin(deviation))
    return k if deviation[k] <= _SAFE * min(_room(before, i, reach), _room(after, k, reach)) else None


def _room(column: _Column, k: int, reach: float) -> float:
    """Distance from a root to the next one on its search line."""
    others = np.delete(column.s, k)
    return float(np.abs(others - column.s[k]).min()) if others.size else reach


def _branch(strip: Strip, columns: Sequence[_Column], path: Sequence[int], reach: float) -> Branch:
    steps = list(zip(columns, path, strict=True))
    room = np.array([_room(column, k, reach) for column, k in steps])
    t, s, slope = np.array([(column.t, column.s[k], column.slope[k]) for column, k in steps]).T
    return Branch(strip, t, s, slope, np.minimum(room[1:], room[:-1]), bool(columns[0].rising[path[0]]))


def _check(strip: Strip, columns: Sequence[_Column], path: Sequence[int]) -> None:
    """Only simple roots, and nowhere along the search lines."""
    for column, k in zip(columns, path, strict=True):
        where = f"at t = {column.t:.6g}, {_place(strip, column.t, float(column.s[k]))}"
        if not column.regular[k]:
            raise CurveError(
                f"{strip.name}: the function jumps or its gradient vanishes on the isoline {where}; expected a simple "
                "root. Use a function that crosses the level with a slope, or a vertex at the place."
            )
        if abs(column.slope[k]) > STEEPEST:
            raise CurveError(_turning(strip, where))


def _turning(strip: Strip, where: str) -> str:
    return (
        f"{strip.name}: the isoline runs along the chord's normal {where}, so it is no function of the position along "
        "the chord. Split the edge with more vertices on the isoline."
    )


def _fail(strip: Strip, reach: float, before: _Column, i: int, after: _Column) -> NoReturn:
    """Say why the branch does not go on."""
    s, slope = float(before.s[i]), float(before.slope[i])
    where = f"at t = {before.t:.6g}, {_place(strip, before.t, s)}"
    same = after.s[after.rising == before.rising[i]]
    if not abs(slope) <= 0.5 * STEEPEST and reach - abs(s) > 1e-3 * reach:
        raise CurveError(_turning(strip, where))
    if same.size and reach - abs(s) > 1e-3 * reach:
        places = ", ".join(_place(strip, after.t, float(one)) for one in after.s[:4])
        raise CurveError(
            f"{strip.name}: {len(after.s)} roots within reach at t = {after.t:.6g}, {places}, and it is not clear "
            f"which of them continues the isoline {where}; expected one. Choose a smaller reach (it is {reach:g} of "
            "the chord), or split the edge with more vertices on the isoline."
        )
    if reach - abs(s) > 1e-3 * reach:
        raise CurveError(
            f"{strip.name}: the isoline ends or meets another one {where}; expected one isoline from vertex to vertex. "
            "Put a vertex at the place, or remedy the function there."
        )
    base = strip.points(np.array([after.t]), np.zeros(1))[0]
    samples = strip.values(np.full(_ROWS, after.t), np.linspace(-reach, reach, _ROWS))
    raise CurveError(
        f"{strip.name}: no root at t = {after.t:.6g}, where the search starts at ({base[0]:.6g}, {base[1]:.6g}); the "
        f"function less its level runs from {samples.min():.3g} to {samples.max():.3g} within {reach:g} of the chord "
        f"to both sides, and the isoline was last seen {where}. Choose a larger reach, or split the edge with more "
        "vertices on the isoline."
    )


def _fail_between_branches(strip: Strip, columns: Sequence[_Column], path: Sequence[int]) -> NoReturn:
    end = _place(strip, 1.0, float(columns[-1].s[path[-1]]))
    raise CurveError(
        f"{strip.name}: the isoline that starts at the first vertex arrives at {end}, not at the second vertex; the "
        "two lie on different branches. Choose vertices on the same branch."
    )


def _place(strip: Strip, t: float, s: float) -> str:
    x, y = strip.points(np.array([t]), np.array([s]))[0]
    return f"({x:.6g}, {y:.6g})"
