"""The transfinite map of a block (the paper's Section 3), batched over blocks of equal size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

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


@dataclass(frozen=True)
class TransfiniteWeights:
    """Blending of the inner nodes of a batch of blocks of equal size.

    If opposite edges share their parameters, ``u`` is (b, m) and ``v`` is (b, n) and the map is a product of rank four;
    otherwise both are (b, n, m), one weight a node.
    """

    u: Array
    v: Array

    @staticmethod
    def from_parameters(bottom: Array, top: Array, left: Array, right: Array) -> TransfiniteWeights:
        """Make the weights of the inner nodes from the parameters of all edge nodes (see `reference_positions`)."""
        if np.array_equal(bottom, top) and np.array_equal(left, right):
            return TransfiniteWeights(bottom[:, 1:-1].copy(), left[:, 1:-1].copy())
        u, v = reference_positions(bottom, top, left, right)
        return TransfiniteWeights(u[:, 1:-1, 1:-1].copy(), v[:, 1:-1, 1:-1].copy())

    def select(self, blocks: NDArray[np.int64]) -> TransfiniteWeights:
        """Weights of some blocks of the batch."""
        return TransfiniteWeights(self.u[blocks], self.v[blocks])


def interior_points(weights: TransfiniteWeights, bottom: Array, top: Array, left: Array, right: Array) -> Array:
    """Inner nodes of a batch of blocks from the nodes on their edges.

    Parameters
    ----------
    weights : TransfiniteWeights
    bottom, top : ndarray, shape (b, m + 2, 2)
        Nodes of the edges v = 0 and v = 1, corners included, by index.
    left, right : ndarray, shape (b, n + 2, 2)

    Returns
    -------
    ndarray, shape (b, n, m, 2)

    References
    ----------
    Gordon & Hall, Int. J. Numer. Meth. Engng 7 (1973) 461–477, doi:10.1002/nme.1620070405.
    """
    form = _product if weights.u.ndim == 2 else _sum
    return form(weights, bottom, top, left, right)


def _product(weights: TransfiniteWeights, bottom: Array, top: Array, left: Array, right: Array) -> Array:
    """Rank-four form of the map: a matrix product for each coordinate."""
    u, v = weights.u, weights.v
    points = np.empty((len(u), v.shape[1], u.shape[1], 2))
    rows = np.empty((len(u), v.shape[1], 4))
    columns = np.empty((len(u), 4, u.shape[1]))
    rows[:, :, 0], rows[:, :, 1] = 1.0 - v, v
    columns[:, 2], columns[:, 3] = 1.0 - u, u
    for d in range(2):
        columns[:, 0], columns[:, 1] = bottom[:, 1:-1, d], top[:, 1:-1, d]
        for k, edge in ((2, left), (3, right)):
            rows[:, :, k] = edge[:, 1:-1, d] - (1.0 - v) * edge[:, :1, d] - v * edge[:, -1:, d]
        points[..., d] = rows @ columns
    return points


def _sum(weights: TransfiniteWeights, bottom: Array, top: Array, left: Array, right: Array) -> Array:
    """The map with one weight a node, in pieces that stay in the processor's cache."""
    count, rows, columns = weights.u.shape
    points = np.empty((count, rows, columns, 2))
    height = max(1, min(rows, _CACHED_NODES // max(1, columns)))
    depth = max(1, _CACHED_NODES // max(1, height * columns))
    for k in range(0, count, depth):
        blocks = slice(k, k + depth)
        edges = [edge[blocks] for edge in (bottom, top, left, right)]
        for j in range(0, rows, height):
            here = slice(j, j + height)
            u, v = weights.u[blocks, here], weights.v[blocks, here]
            for d in range(2):
                points[blocks, here, :, d] = _piece(u, v, here, *(edge[..., d] for edge in edges))
    return points


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
