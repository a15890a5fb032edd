"""The constants of the error bounds, verified by exact arithmetic."""

from fractions import Fraction

import numpy as np
import pytest

from hoblock.quality import bound_tables
from hoblock.quality.bound_tables import UNIT, bounders, legendre_from_values, point_tables
from hoblock.reference import gauss_legendre, gauss_lobatto

ORDERS = [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 16, 24, 32]
BITS = 400


def fixed(x):
    return int(Fraction(float(x)) * (1 << BITS))


def times(a, b):
    return (a * b) >> BITS


def exact_basis(nodes, x):
    """Lagrange basis and its derivatives at one point, to about 100 digits."""
    values, derivatives = [], []
    for i, a in enumerate(nodes):
        denominator = product = 1 << BITS
        derivative = 0
        for j, b in enumerate(nodes):
            if j != i:
                denominator = times(denominator, a - b)
                derivative = times(derivative, x - b) + product
                product = times(product, x - b)
        values.append((product << BITS) // denominator)
        derivatives.append((derivative << BITS) // denominator)
    return values, derivatives


def row_error(row, exact):
    total = sum(map(abs, exact))
    return sum(abs(fixed(a) - b) for a, b in zip(row, exact, strict=True)) / total


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("level", [0, 1, 6])
def test_errors_of_basis_tables_are_below_their_constant(order, level):
    tables = point_tables(order, level)
    nodes = [fixed(x) for x in gauss_lobatto(order)]
    for interval in {0, 2**level // 2, 2**level - 1}:
        for k, x in enumerate(tables.points[interval][:: max(1, order // 4)]):
            row = k * max(1, order // 4)
            values, derivatives = exact_basis(nodes, fixed(x))
            assert row_error(tables.N[interval, row], values) <= bound_tables._TABLE_ERROR * UNIT
            assert row_error(tables.D[interval, row], derivatives) <= bound_tables._TABLE_ERROR * UNIT
            assert sum(map(abs, derivatives)) / (1 << BITS) <= tables.D_sum[interval, row]


@pytest.mark.parametrize("order", ORDERS[:-2])
def test_error_of_the_legendre_transform_is_below_its_constant(order):
    T = legendre_from_values(order)
    m = len(T)
    values = []
    for x in gauss_legendre(m)[0]:
        x = fixed(x)
        P = [1 << BITS, x]
        for j in range(1, m):
            P.append(((2 * j + 1) * times(x, P[j]) - j * P[j - 1]) // (j + 1))
        values.append(P[:m])
    rows = [[fixed(t) for t in row] for row in T]
    residual = max(
        sum(abs(sum(times(row[k], values[k][i]) for k in range(m)) - (i == j) * (1 << BITS)) for i in range(m))
        for j, row in enumerate(rows)
    )
    assert residual / (1 << BITS) <= bound_tables._LEGENDRE_ERROR * m**2 * UNIT


@pytest.mark.parametrize("order", ORDERS)
def test_bounders_bound_polynomials_with_strong_high_modes(order, rng):
    m = 2 * order
    points, _ = gauss_legendre(m)
    coefficients = rng.standard_normal((m, m, 5)) / (1.0 + np.arange(m))[:, None, None]
    values = np.stack(
        [np.polynomial.legendre.leggrid2d(points, points, coefficients[..., k]) for k in range(5)], axis=-1
    )
    fine = np.linspace(-1.0, 1.0, 101)
    sampled = [np.polynomial.legendre.leggrid2d(fine, fine, coefficients[..., k]) for k in range(5)]
    for bounder in bounders(order):
        lower, upper = bounder.extremes(values)
        allowed = bounder.gamma * np.maximum(np.abs(lower), np.abs(upper))
        for k in range(5):
            assert lower[k] - allowed[k] <= sampled[k].min()
            assert upper[k] + allowed[k] >= sampled[k].max()
