"""Arc length along curves: how long they are, and where a given length ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from hoblock.curves.curve import Curve, CuttableCurve, breaks_of
from hoblock.errors import CurveError
from hoblock.reference import differentiation_matrix, gauss_legendre, gauss_lobatto, lagrange, legendre_from_gauss

Array = NDArray[np.float64]

__all__ = ["ArcLength", "LengthTable", "length_table"]

_ORDER = 16
"""Order of the polynomials that stand for the curve in a panel."""
_MOST_PANELS = 4096
"""How many panels may be open at a time: more means the same."""
_TAIL = 1e-11
"""Last coefficients of a panel's speed, relative to the length of the curve; in its halves, which are kept, they are
2^-17 of these."""
_SINGULAR = 45
"""How often a panel is halved to that end: more means that it holds a corner, or an end with endless speed."""
_DEEPEST = 50
"""How often a panel may be halved: more means that the curve has no length."""


@dataclass(frozen=True, eq=False)
class LengthTable:
    """Arc length of a curve as a function of its parameter, and back.

    Attributes
    ----------
    panels : ndarray, shape (k + 1,)
        Parameters between which the speed |dx/dt| is a polynomial to round-off.
    starts : ndarray, shape (k + 1,)
        Arc length at them; the last is the length of the curve.
    speeds : ndarray, shape (k, n)
        Legendre coefficients of the speed, by the panel's own coordinate in [-1, 1].
    """

    panels: Array
    starts: Array
    speeds: Array

    @property
    def length(self) -> float:
        """Length of the whole curve."""
        return float(self.starts[-1])

    def parameters(self, lengths: Array) -> Array:
        """Parameters of the places at given arc lengths from the first end, any shape; clipped to [0, 1].

        Newton's method, kept inside a shrinking bracket.
        """
        lengths = np.asarray(lengths, dtype=float)
        wanted = np.clip(lengths.ravel(), 0.0, self.length)
        panel = np.clip(np.searchsorted(self.starts, wanted, side="right") - 1, 0, len(self.speeds) - 1)
        half = 0.5 * np.diff(self.panels)[panel]
        speed = self.speeds[panel]
        passed = _antiderivative(speed)
        target = (wanted - self.starts[panel]) / half
        total = np.diff(self.starts)[panel] / half
        low, high = -np.ones_like(target), np.ones_like(target)
        x = 2.0 * target / total - 1.0
        for _ in range(60):
            error = _series(passed, x) - target
            low, high = np.where(error <= 0.0, x, low), np.where(error >= 0.0, x, high)
            slope = _series(speed, x)
            step = x - error / np.where(slope > 0.0, slope, 1.0)
            inside = (slope > 0.0) & (step >= low) & (step <= high)
            new = np.where(inside, step, 0.5 * (low + high))
            done = np.abs(new - x).max(initial=0.0) <= 4.0 * np.finfo(float).eps
            x = new
            if done:
                break
        found = 0.5 * (self.panels[panel] + self.panels[panel + 1]) + half * x
        found[wanted == 0.0], found[wanted == self.length] = 0.0, 1.0
        return found.reshape(lengths.shape)

    def lengths(self, t: Array) -> Array:
        """Arc lengths from the first end at parameters of any shape; clipped to [0, 1]."""
        t = np.asarray(t, dtype=float)
        inside = np.clip(t.ravel(), 0.0, 1.0)
        panel = np.clip(np.searchsorted(self.panels, inside, side="right") - 1, 0, len(self.speeds) - 1)
        half = 0.5 * np.diff(self.panels)[panel]
        x = (inside - self.panels[panel]) / half - 1.0
        passed = self.starts[panel] + half * _series(_antiderivative(self.speeds[panel]), x)
        return np.asarray(np.where(inside == 1.0, self.length, passed).reshape(t.shape))


def _series(coefficients: Array, x: Array) -> Array:
    """Legendre series, one a row, at one place each."""
    return np.asarray(np.einsum("kn,kn->k", legendre.legvander(x, coefficients.shape[1] - 1), coefficients))


def _antiderivative(coefficients: Array) -> Array:
    """Legendre coefficients of the integrals from -1."""
    return np.asarray(legendre.legint(coefficients, axis=1, lbnd=-1))


def length_table(curve: Curve) -> LengthTable:
    """Measure a curve; its derivative is that of polynomials through its points, so that none need be given.

    Parameters
    ----------
    curve : Curve
        Smooth, or smooth between its ``breaks``.

    Raises
    ------
    CurveError
        If the curve has no length, or an endless one.
    """
    ends = np.array([0.0, *breaks_of(curve), 1.0])
    left, right = ends[:-1], ends[1:]
    lengths, speeds = _measured(curve, left, right)
    total = float(lengths.sum())
    reach = float(np.abs(np.asarray(curve(ends))).max())  # digits that coordinates far from the origin do not have
    rounding = 32.0 * float(np.finfo(float).eps) * max(0.0, reach - total)
    done: list[tuple[Array, Array, Array, Array]] = []
    for depth in range(_DEEPEST):
        middle = 0.5 * (left + right)
        halves = np.stack([left, middle], axis=-1).ravel(), np.stack([middle, right], axis=-1).ravel()
        finer_lengths, finer_speeds = _measured(curve, *halves)
        error = np.abs(finer_lengths.reshape(-1, 2).sum(axis=1) - lengths)
        total = float(sum(kept[2].sum() for kept in done) + finer_lengths.sum())
        good = error <= 2e-15 * total + rounding
        if depth < _SINGULAR:
            good &= _resolved(speeds, right - left, total, reach)
        closed = np.repeat(good, 2)  # the halves are more accurate by far, and known
        done.append((halves[0][closed], halves[1][closed], finer_lengths[closed], finer_speeds[closed]))
        left, right = halves[0][~closed], halves[1][~closed]
        lengths, speeds = finer_lengths[~closed], finer_speeds[~closed]
        if not left.size or float(lengths.sum()) <= 1e-14 * total:
            done.append((left, right, lengths, speeds))
            break
        if len(left) > _MOST_PANELS:
            break
    if left.size and not float(lengths.sum()) <= 1e-14 * total:
        raise CurveError(
            f"curve: its length near t = {left[0]:g} does not settle; expected a curve that is smooth "
            "between its breaks. Split the edge where the curve has a corner."
        )
    lefts, rights, lengths, speeds = (np.concatenate([part[k] for part in done]) for k in range(4))
    order = np.argsort(lefts)
    starts = np.concatenate(([0.0], np.cumsum(lengths[order])))
    if not starts[-1] > 0.0:
        raise CurveError("curve: it has no length; expected two different ends.")
    return LengthTable(np.append(lefts[order], rights[order][-1]), starts, speeds[order])


def _resolved(speeds: Array, widths: Array, total: float, reach: float) -> NDArray[np.bool_]:
    """Whether the series of the speeds have come to an end; their integrals have much earlier.

    A quadrature rule of Gauss is exact to twice the degree at which the speed is. Differences of coordinates as large
    as ``reach`` leave noise that no halving removes.
    """
    noise = 4.0 * np.finfo(float).eps * _ORDER**2 * max(total, reach)
    return np.asarray(np.abs(speeds[:, -2:]).max(axis=1) * widths <= _TAIL * total + noise)


def _measured(curve: Curve, left: Array, right: Array) -> tuple[Array, Array]:
    """Lengths of panels, shape (k,), and the Legendre coefficients of the speed on them, shape (k, n)."""
    nodes = gauss_lobatto(_ORDER)
    half = 0.5 * (right - left)
    t = 0.5 * (left + right)[:, None] + half[:, None] * nodes
    t[:, 0], t[:, -1] = left, right
    points = np.asarray(curve(t.ravel()), dtype=float).reshape(*t.shape, 2)
    if not np.isfinite(points).all():
        raise CurveError("curve: not finite somewhere on its edge.")
    points = points - points[:, :1]  # digits of the offset from the origin are of no use
    gauss, weights = gauss_legendre(_ORDER + 1)
    D = lagrange(nodes, gauss) @ differentiation_matrix(nodes)
    velocity = np.einsum("gn,knd->kgd", D, points)
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    return speed @ weights, (speed @ legendre_from_gauss(_ORDER + 1).T) / half[:, None]


@dataclass(frozen=True)
class ArcLength:
    """A curve whose parameter is the fraction of its arc length."""

    curve: Curve

    @cached_property
    def _table(self) -> LengthTable:
        return length_table(self.curve)

    @property
    def breaks(self) -> Array:
        """Fractions of the length where the curve is not smooth."""
        breaks = breaks_of(self.curve)
        if not breaks.size:
            return breaks
        table = self._table
        return np.asarray(table.starts[np.searchsorted(table.panels, breaks)] / table.length)

    def cut(self, first: Array, second: Array) -> ArcLength | None:
        """Return the curve cut between other ends, by its own length, if it can be cut so."""
        cut = self.curve.cut(first, second) if isinstance(self.curve, CuttableCurve) else None
        return None if cut is None else ArcLength(cut)

    def __call__(self, t: Array) -> Array:
        """Points at the fractions ``t`` of the length."""
        t = np.asarray(t, dtype=float)
        return self.curve(self._table.parameters(t * self._table.length))
