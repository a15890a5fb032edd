"""Tables that turn nodes into det J at points and these values into bounds, with the rounding errors of each step.

An element's coordinates are taken relative to one of its nodes and scaled to [-1, 1] (`hoblock.quality.coordinates`).
Let u be the unit round-off, N and D the values and derivatives of the Lagrange basis at the points (rows), and
n = p + 1. Then, with row sums |N|, |D| of absolute values,

* an entry of J, say x_ξ = N_η X D_ξᵀ at row r, column c, errs by at most κ |N|_r |D|_c, κ = (2n + 2t + 4) u, where
  t u is the relative error of the tables (verified by exact arithmetic in the tests for every order);
* det J, with |x_ξ|, |y_ξ| ≤ g_ξ and |x_η|, |y_η| ≤ g_η, errs by at most 2(κ + 2u)(g_ξ |D|_r |N|_c + g_η |N|_r |D|_c);
* a linear map A of values along each direction multiplies that by row sums of |A||N| and |A||D|, and adds its own
  rounding, at most `gamma` times the largest value of det J.

Second-order terms are covered by the factor `_SLACK`.

References
----------
Higham: Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, Section 3.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from hoblock.quality.scratch import scratch
from hoblock.reference import bernstein_from_legendre, gauss_legendre, gauss_lobatto, lagrange, lagrange_derivative

Array = NDArray[np.float64]

__all__ = ["Bounder", "PointTables", "UNIT", "bounders", "legendre_from_values", "point_tables"]

UNIT = 2.0**-53
"""Unit round-off of double precision."""
_TABLE_ERROR = 16.0
"""Error of a row of N or D in units of u times the row's absolute sum."""
_LEGENDRE_ERROR = 4.0
"""Row sums of |T V - I|, T the Legendre transform and V its inverse, are at most this times (2p)² u."""
_SLACK = 1.01
_DEGREES = (7, 11)
"""Degrees of Bernstein forms, whose round-off grows as 4^degree; a mode above the degree is at most its coefficient."""


def _frozen(array: Array) -> Array:
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class PointTables:
    """Values and derivatives of the basis at the points of each of the 2^level intervals of [-1, 1].

    Attributes
    ----------
    N, D : ndarray, shape (2^level, 2p + 2, p + 1)
        The points are the 2p Gauss points of the interval, then its ends.
    N_sum, D_sum : ndarray, shape (2^level, 2p + 2)
        Row sums of absolute values.
    kappa : float
        Relative error of the entries of J.
    points : ndarray, shape (2^level, 2p + 2)
    """

    N: Array
    D: Array
    N_sum: Array
    D_sum: Array
    kappa: float
    points: Array


@cache
def point_tables(order: int, level: int) -> PointTables:
    """Tables for elements cut ``level`` times."""
    gauss = np.concatenate([gauss_legendre(2 * order)[0], [-1.0, 1.0]])
    count = 2**level
    points = (gauss + (2.0 * np.arange(count)[:, None] + 1.0 - count)) / count
    nodes = gauss_lobatto(order)
    N = lagrange(nodes, points.ravel()).reshape(count, len(gauss), -1)
    D = lagrange_derivative(nodes, points.ravel()).reshape(count, len(gauss), -1)
    kappa = _SLACK * UNIT * (2 * (order + 1) + 2 * _TABLE_ERROR + 4)
    sums = [_frozen(_SLACK * np.abs(table).sum(axis=2)) for table in (N, D)]
    return PointTables(_frozen(N), _frozen(D), sums[0], sums[1], kappa, _frozen(points))


@cache
def legendre_from_values(order: int) -> Array:
    """Matrix from values at the 2p Gauss points to Legendre coefficients, more accurate than by the weights."""
    points, _ = gauss_legendre(2 * order)
    return _frozen(np.asarray(np.linalg.inv(legendre.legvander(points, len(points) - 1))))


@dataclass(frozen=True, eq=False)
class Bounder:
    """Bounds of a polynomial of degree 2p - 1 in each direction from its values at the Gauss points.

    Attributes
    ----------
    full : ndarray or None
        Values to Bernstein coefficients; None if only some modes pass through them.
    to_modes : ndarray, shape (2p, 2p)
        Values to Legendre coefficients.
    to_bernstein : ndarray, shape (degree + 1, degree + 1)
        Legendre to Bernstein coefficients.
    gamma : float
        Rounding error of the bounds relative to the largest absolute value of the polynomial.
    absolute : ndarray, shape (degree + 1 + 1, 2p)
        What errors of the values become, row by row: of the coefficients, and (last) of the sum of the higher modes.
    """

    full: Array | None
    to_modes: Array
    to_bernstein: Array
    gamma: float
    absolute: Array

    def extremes(self, values: Array) -> tuple[Array, Array]:
        """Bounds (k,) of polynomials (2p, 2p, k), without regard to rounding."""
        if self.full is not None:
            coefficients = _both("coefficients", self.full, values)
            return coefficients.min(axis=0), coefficients.max(axis=0)
        degree, m = len(self.to_bernstein) - 1, len(self.to_modes)
        modes = _both("modes", self.to_modes, values).reshape(m, m, -1)
        low = np.ascontiguousarray(modes[: degree + 1, : degree + 1])
        coefficients = _both("coefficients", self.to_bernstein, low)
        np.abs(modes, out=modes)
        rest = modes[degree + 1 :].reshape(-1, modes.shape[2]).sum(axis=0)
        rest += modes[: degree + 1, degree + 1 :].sum(axis=(0, 1))
        rest *= 1.0 + m**2 * 2.0 * UNIT
        return coefficients.min(axis=0) - rest, coefficients.max(axis=0) + rest

    def amplified(self, errors: Array) -> tuple[Array, Array]:
        """What errors (…, 2p) along one direction do to a coefficient and to the sum of the higher modes."""
        result = errors @ self.absolute.T
        return result[..., :-1].max(axis=-1), result[..., -1]


def _both(name: str, matrix: Array, values: Array) -> Array:
    """Apply a matrix along both directions of (m, m, k); the result as (q², k), in the scratch array of a name."""
    m, count = values.shape[1], values.shape[2]
    rows = len(matrix)
    first = scratch("first direction", (rows, m * count))
    np.matmul(matrix, values.reshape(m, -1), out=first)
    both = scratch(name, (rows, rows, count))
    np.matmul(matrix, first.reshape(rows, m, count), out=both)
    return both.reshape(-1, count)


@cache
def bounders(order: int) -> tuple[Bounder, ...]:
    """Bounders of an order; the first is the one for all elements, any may be tried where it does not decide."""
    degrees = {min(degree, 2 * order - 1) for degree in _DEGREES}
    return tuple(_bounder(order, degree) for degree in sorted(degrees, reverse=True))


def _bounder(order: int, degree: int) -> Bounder:
    m = 2 * order
    T, B = legendre_from_values(order), bernstein_from_legendre(degree)
    modes = np.abs(T)
    absolute = np.abs(B) @ modes[: degree + 1]
    rest = modes.sum(axis=0)
    rounding = 2.0 * (2 * m + degree + 6) * UNIT
    roots = np.sqrt(2.0 * np.arange(m) + 1.0)
    transform = 2.0 * _LEGENDRE_ERROR * m**2 * UNIT
    gamma = rounding * absolute.sum(axis=1).max() ** 2 + transform * (np.abs(B) @ roots[: degree + 1]).max() ** 2
    if degree < m - 1:
        gamma += rounding * rest.sum() ** 2 + transform * roots.sum() ** 2
    full = B @ T if degree == m - 1 else None
    return Bounder(full, T, B, float(_SLACK * gamma), _frozen(_SLACK * np.vstack([absolute, rest * (degree < m - 1)])))
