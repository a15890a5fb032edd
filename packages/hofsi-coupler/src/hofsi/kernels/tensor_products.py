"""Element integrals of products of two basis functions, one direction of the square after the other.

Integrands c N_i N_j and N_i (c·∇N_j) on the reference square, where basis and quadrature are tensor products: with
Q points and p + 1 functions a direction, sums over ξ and then η take (p + 1)² Q² + (p + 1)⁴ Q multiplications an
element instead of (p + 1)⁴ Q².

Orszag, J. Comput. Phys. 37 (1980) 70–92, doi:10.1016/0021-9991(80)90005-4 (sum factorisation).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["ProductTables", "mass", "product_tables", "transport"]


@dataclass(frozen=True, eq=False)
class ProductTables:
    """Products of one-dimensional functions at Q points, and where pairs of local nodes find theirs.

    Attributes
    ----------
    values : ndarray, shape (Q, s)
        φ_i φ_j for i ≤ j, s = (p + 1)(p + 2)/2.
    slopes : ndarray, shape (Q, (p + 1)²)
        φ_i φ'_j.
    of_mass, along_xi, along_eta : ndarray, shape (n²,)
        Places of ∫ c N_i N_j, ∫ c N_i ∂_ξ N_j and ∫ c N_i ∂_η N_j among what the sums give, (i, j) row by row.
    """

    values: Array
    slopes: Array
    of_mass: Index
    along_xi: Index
    along_eta: Index


def product_tables(values: Array, slopes: Array, nodes: Index) -> ProductTables:
    """Make the tables.

    Parameters
    ----------
    values, slopes : ndarray, shape (Q, p + 1)
        φ and φ' at the points of one direction.
    nodes : ndarray, shape (n,)
        i + (p + 1) j of each local node, i along ξ.
    """
    n = values.shape[1]
    first, second = np.triu_indices(n)
    pair = np.empty((n, n), dtype=np.int64)
    pair[first, second] = pair[second, first] = np.arange(len(first))
    eta, xi = np.divmod(nodes, n)
    ordered = xi[:, None] * n + xi, eta[:, None] * n + eta
    same = pair[xi[:, None], xi], pair[eta[:, None], eta]
    s = len(first)
    return ProductTables(
        values[:, first] * values[:, second],
        (values[:, :, None] * slopes[:, None, :]).reshape(len(values), -1),
        (same[1] * s + same[0]).ravel(),
        (same[1] * n * n + ordered[0]).ravel(),
        (ordered[1] * s + same[0]).ravel(),
    )


def mass(tables: ProductTables, c: Array) -> Array:
    """∫ c N_i N_j over the reference square.

    Parameters
    ----------
    c : ndarray, shape (m, Q²)
        With the quadrature weights; ξ fastest.

    Returns
    -------
    ndarray, shape (m, n, n)
    """
    return _spread(_summed(c, tables.values, tables.values), tables.of_mass)


def transport(tables: ProductTables, c_xi: Array, c_eta: Array) -> Array:
    """∫ N_i (c_ξ ∂_ξ N_j + c_η ∂_η N_j) over the reference square; arguments and result as of `mass`."""
    result = _spread(_summed(c_xi, tables.values, tables.slopes), tables.along_xi)
    result += _spread(_summed(c_eta, tables.slopes, tables.values), tables.along_eta)
    return result


def _summed(c: Array, along_eta: Array, along_xi: Array) -> Array:
    """Σ c(ξ, η) f(η) g(ξ) for all columns f and g of two tables, shape (m, f g)."""
    m, Q = len(c), len(along_xi)
    rows = c.reshape(m * Q, Q) @ along_xi
    return np.asarray((along_eta.T @ rows.reshape(m, Q, -1)).reshape(m, -1))


def _spread(sums: Array, places: Index) -> Array:
    n = round(len(places) ** 0.5)
    return np.take(sums, places, axis=1, mode="clip").reshape(len(sums), n, n)
