"""The transfinite map of a block (the paper's Section 3), batched over blocks of equal size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["TransfiniteWeights", "interior_points", "reference_positions"]

_CACHED_NODES = 8192


def reference_positions(bottom: Array, top: Array, left: Array, right: Array) -> tuple[Array, Array]:
    """Positions (u, v) of a block's nodes when opposite edges are graded differently.

    A node lies where the straight lines between equal indices on opposite reference edges intersect.

    Parameters
    ----------
    bottom, top : ndarray, shape (b, m)
        Parameters of the nodes of the edges v = 0 and v = 1.
    left, right : ndarray, shape (b, n)
        Parameters of the nodes of the edges u = 0 and u = 1.

    Returns
    -------
    u, v : ndarray, shape (b, n, m)
    """
    u0, du = bottom[:, None, :], (top - bottom)[:, None, :]
    v0, dv = left[:, :, None], (right - left)[:, :, None]
    u = (u0 + du * v0) / (1.0 - du * dv)
    return u, v0 + dv * u


@dataclass(frozen=True, eq=False)
class TransfiniteWeights:
    """Blending of the inner nodes of a batch of blocks of equal size.

    Attributes
    ----------
    bottom, top : ndarray, shape (b, m)
        Parameters of the inner nodes of the edges v = 0 and v = 1.
    left, right : ndarray, shape (b, n)
        Parameters of the inner nodes of the edges u = 0 and u = 1.
    inner : pair of ndarray, shape (b, n, m), or None
        u and v of each node, where both pairs of opposite edges differ. Otherwise the map is a product of low rank.
    """

    bottom: Array
    top: Array
    left: Array
    right: Array
    inner: tuple[Array, Array] | None

    @staticmethod
    def from_parameters(bottom: Array, top: Array, left: Array, right: Array) -> TransfiniteWeights:
        """Make the weights of the inner nodes from the parameters of all edge nodes (see `reference_positions`)."""
        b, t, le, r = (side[:, 1:-1].copy() for side in (bottom, top, left, right))
        product = np.array_equal(b, t) or np.array_equal(le, r)
        return TransfiniteWeights(b, t, le, r, None if product else reference_positions(b, t, le, r))

    def select(self, blocks: Index) -> TransfiniteWeights:
        """Weights of some blocks of the batch."""
        inner = None if self.inner is None else (self.inner[0][blocks], self.inner[1][blocks])
        return TransfiniteWeights(self.bottom[blocks], self.top[blocks], self.left[blocks], self.right[blocks], inner)


def interior_points(
    weights: TransfiniteWeights, bottom: Array, top: Array, left: Array, right: Array, out: Array | None = None
) -> Array:
    """Inner nodes of a batch of blocks from the nodes on their edges.

    Parameters
    ----------
    weights : TransfiniteWeights
    bottom, top : ndarray, shape (b, m + 2, 2)
        Nodes of the edges v = 0 and v = 1, corners included, by index.
    left, right : ndarray, shape (b, n + 2, 2)
    out : ndarray, shape (b, n, m, 2), optional
        C-contiguous array for the result.

    Returns
    -------
    ndarray, shape (b, n, m, 2)

    References
    ----------
    Gordon & Hall, Int. J. Numer. Meth. Engng 7 (1973) 461–477, doi:10.1002/nme.1620070405.
    """
    count, n, m = len(bottom), weights.left.shape[1], weights.bottom.shape[1]
    points = np.empty((count, n, m, 2)) if out is None else out
    if weights.inner is not None:
        _sum(*weights.inner, (bottom, top, left, right), points)
        return points
    factors = _factors_common_v if np.array_equal(weights.left, weights.right) else _factors_common_u
    rows, columns = factors(weights, bottom, top, left, right)
    np.matmul(rows, columns.reshape(count, -1, 2 * m), out=points.reshape(count, n, 2 * m))
    return points


def _factors_common_v(
    weights: TransfiniteWeights, bottom: Array, top: Array, left: Array, right: Array
) -> tuple[Array, Array]:
    """Factors (b, n, k) and (b, k, m, 2) of the map where the nodes of a row have one v; k = 6, or 8 if u varies in it.

    X = (1-v) B + v T + L̂ + (u₀ + v Δu)(R̂ - L̂), where L̂ and R̂ are the offsets of the sides from their chords.
    """
    v, u, du = weights.left, weights.bottom, weights.top - weights.bottom
    sheared = bool(du.any())
    terms = 3 if sheared else 2
    rows = np.empty((*v.shape, 2 + 2 * terms))
    columns = np.zeros((len(u), 2 + 2 * terms, u.shape[1], 2))
    rows[..., 0], rows[..., 1] = 1.0 - v, v
    columns[:, 0], columns[:, 1] = bottom[:, 1:-1], top[:, 1:-1]
    for d in range(2):
        first, second = _offsets(left[..., d], v), _offsets(right[..., d], v)
        k = 2 + d * terms
        rows[..., k], rows[..., k + 1] = first, second - first
        columns[:, k, :, d], columns[:, k + 1, :, d] = 1.0, u
        if sheared:
            rows[..., k + 2] = v * rows[..., k + 1]
            columns[:, k + 2, :, d] = du
    return rows, columns


def _factors_common_u(
    weights: TransfiniteWeights, bottom: Array, top: Array, left: Array, right: Array
) -> tuple[Array, Array]:
    """Factors (b, n, 7) and (b, 7, m, 2) where the nodes of a column have one u but a row has no common v.

    X = (1-u) L + u R + B̂ + (v₀ + u Δv)(T̂ - B̂), where B̂ and T̂ are the offsets of the sides from their chords.
    """
    u, v = weights.bottom, weights.left
    rows = np.empty((*v.shape, 7))
    columns = np.zeros((len(u), 7, u.shape[1], 2))
    rows[..., 4], rows[..., 5], rows[..., 6] = 1.0, v, weights.right - v
    for d in range(2):
        rows[..., 2 * d], rows[..., 2 * d + 1] = left[:, 1:-1, d], right[:, 1:-1, d]
        columns[:, 2 * d, :, d], columns[:, 2 * d + 1, :, d] = 1.0 - u, u
        first, second = _offsets(bottom[..., d], u), _offsets(top[..., d], u)
        columns[:, 4, :, d], columns[:, 5, :, d] = first, second - first
        columns[:, 6, :, d] = u * columns[:, 5, :, d]
    return rows, columns


def _offsets(side: Array, t: Array) -> Array:
    """One coordinate of the inner nodes of a side, less its chord."""
    return np.asarray(side[:, 1:-1] - (1.0 - t) * side[:, :1] - t * side[:, -1:])


def _sum(u: Array, v: Array, sides: tuple[Array, Array, Array, Array], points: Array) -> None:
    """Write the map with one weight a node, in pieces that stay in the processor's cache."""
    count, rows, columns = u.shape
    height = max(1, min(rows, _CACHED_NODES // max(1, columns)))
    depth = max(1, _CACHED_NODES // max(1, height * columns))
    for k in range(0, count, depth):
        blocks = slice(k, k + depth)
        edges = [edge[blocks] for edge in sides]
        for j in range(0, rows, height):
            here = slice(j, j + height)
            for d in range(2):
                coordinate = (edge[..., d] for edge in edges)
                points[blocks, here, :, d] = _piece(u[blocks, here], v[blocks, here], here, *coordinate)


def _piece(u: Array, v: Array, rows: slice, bottom: Array, top: Array, left: Array, right: Array) -> Array:
    """One coordinate of some rows: B + L - a + v (T - B - (d - a)) + u (R - L - (b - a) - v (a - b + c - d))."""
    a, b, c, d = bottom[:, :1], bottom[:, -1:], top[:, -1:], top[:, :1]
    B, T = bottom[:, 1:-1], top[:, 1:-1]
    L, R = left[:, 1:-1][:, rows], right[:, 1:-1][:, rows]
    points = v * (b - a - c + d)[:, :, None]
    points += (R - L - (b - a))[:, :, None]
    points *= u
    points += v * (T - B - (d - a))[:, None, :]
    points += B[:, None, :]
    points += (L - a)[:, :, None]
    return np.asarray(points)
