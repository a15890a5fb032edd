"""The reference element [-1, 1]²: nodes, Lagrange and Bernstein bases, quadrature, tensor products."""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = [
    "bernstein_from_legendre",
    "differentiation_matrix",
    "equispaced",
    "gauss_legendre",
    "gauss_lobatto",
    "lagrange",
    "lagrange_derivative",
    "legendre_from_gauss",
    "tensor_basis",
    "tensor_gradient",
    "tensor_quadrature",
]


def _frozen(array: Array) -> Array:
    array.setflags(write=False)
    return array


@cache
def gauss_lobatto(order: int) -> Array:
    """Gauss–Lobatto–Legendre points, the nodes of an element of the given order.

    Parameters
    ----------
    order : int
        Polynomial order p ≥ 1.

    Returns
    -------
    ndarray, shape (p + 1,)
        The ends of [-1, 1] and the roots of P'_p between them, ascending and exactly symmetric.

    References
    ----------
    Canuto, Hussaini, Quarteroni, Zang: Spectral Methods, Springer 2006, Section 2.3.
    """
    if order < 1:
        raise ValueError(f"gauss_lobatto: order is {order}; expected an integer >= 1.")
    inner = legendre.legroots(legendre.legder([0.0] * order + [1.0])) if order > 1 else np.zeros(0)
    series = [0.0] * order + [1.0]
    first, second = legendre.legder(series), legendre.legder(series, 2)
    for _ in range(2):  # polish the eigenvalues by Newton's method
        if inner.size:
            inner = inner - legendre.legval(inner, first) / legendre.legval(inner, second)
    nodes = np.concatenate(([-1.0], np.sort(inner), [1.0]))
    return _frozen((nodes - nodes[::-1]) / 2)


@cache
def equispaced(order: int) -> Array:
    """Equally spaced points of an element of the given order, exactly symmetric, shape (p + 1,)."""
    if order < 1:
        raise ValueError(f"equispaced: order is {order}; expected an integer >= 1.")
    nodes = np.linspace(-1.0, 1.0, order + 1)
    return _frozen((nodes - nodes[::-1]) / 2)


@cache
def gauss_legendre(count: int) -> tuple[Array, Array]:
    """Points and weights of the Gauss–Legendre rule on [-1, 1], exact to degree 2·count - 1."""
    points, weights = legendre.leggauss(count)
    return _frozen(points), _frozen(weights)


def _barycentric(nodes: Array) -> Array:
    difference = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(difference, 1.0)
    return np.asarray(1.0 / np.prod(difference, axis=1))


def lagrange(nodes: Array, x: Array) -> Array:
    """Lagrange basis on ``nodes`` at the points ``x``.

    Returns
    -------
    ndarray, shape (len(x), len(nodes))
        Row k holds the basis functions at x[k]; rows sum to one.

    References
    ----------
    Berrut & Trefethen, SIAM Review 46 (2004) 501–517, Eq. (4.2), doi:10.1137/S0036144502417715.
    """
    x = np.atleast_1d(np.asarray(x, dtype=float))
    difference = x[:, None] - nodes[None, :]
    exact = np.abs(difference) < 1e-200  # division by less might overflow
    terms = _barycentric(nodes) / np.where(exact, 1.0, difference)
    hit = exact.any(axis=1)
    terms[hit] = exact[hit]
    return np.asarray(terms / terms.sum(axis=1, keepdims=True))


def differentiation_matrix(nodes: Array) -> Array:
    """Matrix D with (D f)_k = f'(nodes[k]) for every polynomial f of order len(nodes) - 1."""
    weights = _barycentric(nodes)
    difference = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(difference, 1.0)
    D = (weights[None, :] / weights[:, None]) / difference
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(axis=1))
    return np.asarray(D)


def lagrange_derivative(nodes: Array, x: Array) -> Array:
    """Derivatives of the Lagrange basis on ``nodes`` at ``x``, shape (len(x), len(nodes))."""
    return lagrange(nodes, x) @ differentiation_matrix(nodes)


@cache
def legendre_from_gauss(count: int) -> Array:
    """Matrix that turns values at ``count`` Gauss points into Legendre coefficients, shape (count, count).

    Exact for polynomials of degree ``count - 1``, and well conditioned for every degree.
    """
    points, weights = gauss_legendre(count)
    degrees = np.arange(count)
    return _frozen(np.asarray((2 * degrees[:, None] + 1) / 2 * weights * legendre.legvander(points, count - 1).T))


@cache
def bernstein_from_legendre(order: int) -> Array:
    """Matrix that turns Legendre into Bernstein coefficients of the same order on [-1, 1].

    The entries are those of exact arithmetic; they grow as 2^order, and so does the round-off of the coefficients.

    Parameters
    ----------
    order : int
        Order m of the polynomial.

    Returns
    -------
    ndarray, shape (m + 1, m + 1)

    References
    ----------
    Farouki, J. Comput. Appl. Math. 119 (2000) 145–160, Eq. (20), doi:10.1016/S0377-0427(00)00376-9.
    """
    columns = np.empty((order + 1, order + 1))
    for j in range(order + 1):
        for k in range(order + 1):
            terms = range(max(0, j + k - order), min(j, k) + 1)
            total = sum((-1) ** (k + i) * comb(k, i) ** 2 * comb(order - k, j - i) for i in terms)
            columns[j, k] = total / comb(order, j)
    return _frozen(columns)


def tensor_basis(nodes: Array, points: Array) -> Array:
    """Tensor-product Lagrange basis at scattered points of the square.

    Parameters
    ----------
    nodes : ndarray, shape (p + 1,)
    points : ndarray, shape (k, 2)
        (ξ, η).

    Returns
    -------
    ndarray, shape (k, (p + 1)²)
        Local node i + (p + 1) j, ξ fastest.
    """
    a, b = lagrange(nodes, points[:, 0]), lagrange(nodes, points[:, 1])
    return np.asarray((b[:, :, None] * a[:, None, :]).reshape(len(a), -1))


def tensor_gradient(nodes: Array, points: Array) -> Array:
    """Reference gradients of the tensor-product basis, shape (k, (p + 1)², 2)."""
    a, b = lagrange(nodes, points[:, 0]), lagrange(nodes, points[:, 1])
    D = differentiation_matrix(nodes)
    along_xi = (b[:, :, None] * (a @ D)[:, None, :]).reshape(len(a), -1)
    along_eta = ((b @ D)[:, :, None] * a[:, None, :]).reshape(len(a), -1)
    return np.stack([along_xi, along_eta], axis=-1)


@cache
def tensor_quadrature(count: int) -> tuple[Array, Array]:
    """Gauss rule with count × count points on the square: points (count², 2), weights (count²,)."""
    x, w = gauss_legendre(count)
    points = np.stack(np.meshgrid(x, x, indexing="xy"), axis=-1).reshape(-1, 2)
    return _frozen(points), _frozen(np.outer(w, w).ravel())
