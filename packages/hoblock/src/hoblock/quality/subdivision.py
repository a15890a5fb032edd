"""Adaptive subdivision of elements whose det J the first pass leaves open: a branch-and-bound search for its minimum.

A piece is evaluated from the element's own nodes at every level, so that rounding errors do not pile up. It is settled
when its bound is positive or not below a value that det J certainly takes; the rest is cut in four.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.quality.bound_tables import UNIT, bounders, point_tables
from hoblock.quality.bounds import coefficient_error

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Search", "search"]

_CHUNK_NODES = 65536
"""Nodes of the pieces that are evaluated together."""
_HOPEFUL_PIECES = 512
"""Open pieces kept of an element that may be valid; more than ever met, but for elements of no width."""
_DOUBTFUL_PIECES = 16
"""Open pieces kept of an element with a sample that rounding cannot tell from zero: it can only turn out invalid."""


@dataclass(frozen=True, eq=False)
class Search:
    """What the search has found for each element, each of shape (k,).

    Attributes
    ----------
    lower : ndarray
        Certified lower bound of det J.
    reached : ndarray
        A value that is certainly not below the minimum of det J: its smallest sample plus the error of that.
    """

    lower: Array
    reached: Array


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Squares of side 2^(1 - level) of some elements: the element, and the place along ξ and η."""

    owner: Index
    a: Index
    b: Index

    def select(self, some: Index | NDArray[np.bool_]) -> _Pieces:
        return _Pieces(self.owner[some], self.a[some], self.b[some])

    def cut(self) -> _Pieces:
        owner = np.repeat(self.owner, 4)
        a, b = np.repeat(2 * self.a, 4), np.repeat(2 * self.b, 4)
        quarter = np.tile(np.arange(4), len(self.owner))
        return _Pieces(owner, a + quarter % 2, b + quarter // 2)


def search(x: Array, order: int, subdivisions: int, *, until_negative: bool = True) -> Search:
    """Search for the minimum of det J of scaled elements.

    Parameters
    ----------
    x : ndarray, shape (2, (p + 1)², k)
        As in `hoblock.quality.coordinates`.
    order : int
    subdivisions : int
        How often a piece is cut in four at most.
    until_negative : bool
        Leave an element alone once a sample of det J is certainly not positive; else sharpen its bound.
    """
    count = x.shape[2]
    nodes = np.ascontiguousarray(x.transpose(2, 0, 1)).reshape(count, 2, order + 1, order + 1)
    everything = np.arange(count)
    pieces = _Pieces(everything, np.zeros_like(everything), np.zeros_like(everything))
    settled = np.full(count, np.inf)  # smallest bound of the pieces that are not looked at any more
    reached, bound = np.full(count, np.inf), np.full(count, -np.inf)
    for level in range(subdivisions + 1):
        low, noise, doubtful = _evaluate(nodes, order, level, pieces, reached)
        bound = settled.copy()
        np.minimum.at(bound, pieces.owner, low)
        still = (low <= 0.0) & (low < reached[pieces.owner])
        if until_negative:
            still &= reached[pieces.owner] > 0.0
        still &= (low < -2.0 * noise) | ~doubtful[pieces.owner]  # nothing negative is found below rounding errors
        still &= _among_the_lowest(pieces.owner, low, np.where(doubtful, _DOUBTFUL_PIECES, _HOPEFUL_PIECES))
        np.minimum.at(settled, pieces.owner[~still], low[~still])
        if not still.any():
            break
        pieces = pieces.select(still).cut()
    return Search(bound, reached)


def _among_the_lowest(owner: Index, low: Array, limits: Index) -> NDArray[np.bool_]:
    """Whether a piece is among the lowest of its element, as many as that element's limit (k,)."""
    sequence = np.lexsort((low, owner))
    sorted_owner = owner[sequence]
    rank = np.arange(len(owner)) - np.searchsorted(sorted_owner, sorted_owner)
    result = np.empty(len(owner), dtype=bool)
    result[sequence] = rank < limits[sorted_owner]
    return result


def _evaluate(
    nodes: Array, order: int, level: int, pieces: _Pieces, reached: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Lower bounds of all pieces, their rounding errors, and which elements have samples near zero.

    Lowers ``reached`` in place.
    """
    low, noise = np.empty(len(pieces.owner)), np.empty(len(pieces.owner))
    doubtful = np.zeros(len(nodes), dtype=bool)
    step = max(1, _CHUNK_NODES // (order + 1) ** 2)
    for start in range(0, len(low), step):
        part = slice(start, min(start + step, len(low)))
        some = pieces.select(np.arange(part.start, part.stop))
        low[part], noise[part], highest, lowest = _bound(nodes, order, level, some)
        np.minimum.at(reached, some.owner, highest)
        doubtful[some.owner[lowest <= 0.0]] = True
    return low, noise, doubtful


def _bound(nodes: Array, order: int, level: int, pieces: _Pieces) -> tuple[Array, Array, Array, Array]:
    """Lower bound of each piece, its rounding error, and the smallest sample plus and minus the error of samples."""
    tables, m = point_tables(order, level), 2 * order
    N_a, D_a, N_b, D_b = tables.N[pieces.a], tables.D[pieces.a], tables.N[pieces.b], tables.D[pieces.b]
    x = nodes[pieces.owner]
    by_xi = N_b[:, None] @ (x @ D_a.transpose(0, 2, 1)[:, None])
    by_eta = D_b[:, None] @ (x @ N_a.transpose(0, 2, 1)[:, None])
    det_J = by_xi[:, 0] * by_eta[:, 1] - by_xi[:, 1] * by_eta[:, 0]
    margin = tables.kappa * tables.N_sum.max() * tables.D_sum.max()
    factor = 2.0 * (tables.kappa + 2.0 * UNIT)
    g_xi, g_eta = (factor * (np.abs(values).max(axis=(1, 2, 3)) + margin)[:, None] for values in (by_xi, by_eta))
    along_xi = tables.N_sum[pieces.a], tables.D_sum[pieces.a]
    along_eta = g_xi * tables.D_sum[pieces.b], g_eta * tables.N_sum[pieces.b]
    error = along_eta[0][:, :, None] * along_xi[0][:, None, :] + along_eta[1][:, :, None] * along_xi[1][:, None, :]
    highest, lowest = (det_J + error).min(axis=(1, 2)), (det_J - error).min(axis=(1, 2))
    values = np.ascontiguousarray(det_J[:, :m, :m].transpose(1, 2, 0))
    inner_xi, inner_eta = ((first[:, :m], second[:, :m]) for first, second in (along_xi, along_eta))
    low, noise = np.full(len(det_J), -np.inf), np.zeros(len(det_J))
    for bounder in bounders(order):
        lower, upper = bounder.extremes(values)
        rounding = coefficient_error(bounder, inner_xi, inner_eta)
        rounding += bounder.gamma * np.maximum(np.abs(lower), np.abs(upper))
        better = lower - rounding > low
        low, noise = np.where(better, lower - rounding, low), np.where(better, rounding, noise)
    return low, noise, highest, lowest
