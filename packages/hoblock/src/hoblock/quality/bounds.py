"""Certified bounds of det J of every element in one pass."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from hoblock.quality.bound_tables import UNIT, Bounder, bounders, point_tables
from hoblock.quality.coordinates import ElementCoordinates
from hoblock.quality.scratch import scratch

Array = NDArray[np.float64]

__all__ = ["coefficient_error", "in_mesh_units", "scaled_bounds"]


def _det_values(x: Array, order: int) -> tuple[Array, Array, Array]:
    """det J of scaled elements at their 2p × 2p Gauss points, shape (2p, 2p, k), and the largest |x_ξ| and |x_η| (k,).

    One direction after the other, each as a matrix product over all elements. The values are overwritten by the next
    call of the thread.
    """
    tables = point_tables(order, 0)
    m, n, k = 2 * order, order + 1, x.shape[2]
    along_xi = scratch("along xi", (2, n, 2 * m, k))
    np.matmul(_stacked(order), x.reshape(2, n, n, k), out=along_xi)  # values, then derivatives
    flat = along_xi.reshape(2, n, 2 * m * k)
    by_xi, by_eta = scratch("by xi", (2, m, m * k)), scratch("by eta", (2, m, m * k))
    np.matmul(tables.D[0, :m], flat[:, :, : m * k], out=by_eta)
    np.matmul(tables.N[0, :m], flat[:, :, m * k :], out=by_xi)
    largest = [_largest(tangents.reshape(-1, k)) for tangents in (by_xi, by_eta)]
    det_J = by_xi[0]
    det_J *= by_eta[1]
    by_eta[0] *= by_xi[1]
    det_J -= by_eta[0]
    return np.asarray(det_J.reshape(m, m, k)), largest[0], largest[1]


def _largest(values: Array) -> Array:
    return np.asarray(np.maximum(values.max(axis=0), -values.min(axis=0)))


@cache
def _stacked(order: int) -> Array:
    tables = point_tables(order, 0)
    return np.concatenate([tables.N[0, : 2 * order], tables.D[0, : 2 * order]])


def coefficient_error(bounder: Bounder, along_xi: tuple[Array, Array], along_eta: tuple[Array, Array]) -> Array:
    """Error of bounds from errors of values that are a sum of two products of one factor along each direction."""
    (a, a_rest), (b, b_rest) = bounder.amplified(along_xi[0]), bounder.amplified(along_eta[0])
    (c, c_rest), (d, d_rest) = bounder.amplified(along_xi[1]), bounder.amplified(along_eta[1])
    return np.asarray(a * b + a_rest * b_rest + c * d + c_rest * d_rest)


@cache
def _first_pass_errors(order: int) -> tuple[float, float]:
    """Error of the bounds of the first pass for each unit of |x_ξ| or |x_η|, and what to add to that size."""
    tables, m = point_tables(order, 0), 2 * order
    N, D, nothing = tables.N_sum[0, :m], tables.D_sum[0, :m], np.zeros(m)
    each = 2.0 * (tables.kappa + 2.0 * UNIT) * coefficient_error(bounders(order)[0], (N, nothing), (D, nothing))
    return float(each), float(tables.kappa * N.max() * D.max())


def scaled_bounds(x: Array, order: int) -> tuple[Array, Array]:
    """Certified bounds of det J of scaled elements (2, (p + 1)², k), each of shape (k,)."""
    bounder = bounders(order)[0]
    values, g_xi, g_eta = _det_values(x, order)
    lower, upper = bounder.extremes(values)
    each, margin = _first_pass_errors(order)
    error = each * (g_xi + g_eta + 2.0 * margin) + bounder.gamma * np.maximum(np.abs(lower), np.abs(upper))
    return lower - error, upper + error


def in_mesh_units(coordinates: ElementCoordinates, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Bounds in units of the mesh: 0 for elements without width or height, -∞ and ∞ for such that are not finite."""
    lower, upper = coordinates.unscaled(lower), coordinates.unscaled(upper)
    if coordinates.flat.any() or not coordinates.finite.all():
        lower[coordinates.flat] = upper[coordinates.flat] = 0.0
        lower[~coordinates.finite], upper[~coordinates.finite] = -np.inf, np.inf
    return lower, upper
