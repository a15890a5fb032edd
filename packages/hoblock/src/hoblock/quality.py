"""Validity and quality of elements: det J and its certified bounds, scaled Jacobian, Jacobian ratio, skewness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.reference import (
    bernstein_from_legendre,
    equispaced,
    gauss_legendre,
    gauss_lobatto,
    lagrange,
    legendre_from_gauss,
    tensor_basis,
    tensor_gradient,
    tensor_quadrature,
)

Array = NDArray[np.float64]

__all__ = [
    "BadElement",
    "det_jacobian",
    "det_jacobian_bounds",
    "equiangular_skewness",
    "invalid_elements",
    "jacobian",
    "jacobian_ratio",
    "minimum_det_jacobian",
    "scaled_jacobian",
]

_BERNSTEIN_DEGREE = 15
"""Highest degree of the Bernstein coefficients that bound det J; elements up to order 8 need no more."""


def _square(nodes: Array) -> Array:
    return np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2)


def jacobian(mesh: QuadMesh, xi: Array) -> Array:
    """Jacobian of the element maps at reference points.

    Parameters
    ----------
    mesh : QuadMesh
    xi : ndarray, shape (k, 2)

    Returns
    -------
    ndarray, shape (e, k, 2, 2)
        J[..., c, d] = ∂x_c/∂ξ_d.
    """
    gradient = tensor_gradient(gauss_lobatto(mesh.order), xi)  # (k, i, d)
    x = mesh.coordinates.transpose(0, 2, 1)  # (e, c, i)
    flat = x @ gradient.transpose(1, 0, 2).reshape(gradient.shape[1], -1)
    return np.asarray(flat.reshape(len(x), 2, len(xi), 2).transpose(0, 2, 1, 3))


def _determinant(J: Array) -> Array:
    return np.asarray(J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0])


def det_jacobian(mesh: QuadMesh, xi: Array) -> Array:
    """det J at reference points (k, 2), shape (e, k)."""
    return _determinant(jacobian(mesh, xi))


def _dense_grid(order: int) -> Array:
    return _square(equispaced(2 * order))


def minimum_det_jacobian(mesh: QuadMesh) -> float:
    """Smallest det J over all elements, sampled at (2p + 1)² points of each and at its nodes."""
    points = np.concatenate([_dense_grid(mesh.order), _square(gauss_lobatto(mesh.order))])
    return float(det_jacobian(mesh, points).min())


def scaled_jacobian(mesh: QuadMesh, samples: int | None = None) -> Array:
    """Minimum of det J/(|x_ξ||x_η|) over a grid of each element, shape (e,), in [-1, 1].

    Parameters
    ----------
    mesh : QuadMesh
    samples : int, optional
        Points along each direction; default 2p + 1.
    """
    J = jacobian(mesh, _dense_grid(mesh.order) if samples is None else _square(equispaced(samples - 1)))
    lengths = np.hypot(J[..., 0, 0], J[..., 1, 0]) * np.hypot(J[..., 0, 1], J[..., 1, 1])
    return np.asarray((_determinant(J) / np.maximum(lengths, np.finfo(float).tiny)).min(axis=1))


def jacobian_ratio(mesh: QuadMesh) -> Array:
    """min det J/max det J over a dense grid of each element, shape (e,), in (-∞, 1]."""
    det_J = det_jacobian(mesh, _dense_grid(mesh.order))
    largest = det_J.max(axis=1)
    return np.asarray(np.where(largest > 0.0, det_J.min(axis=1) / np.where(largest > 0.0, largest, 1.0), -np.inf))


def equiangular_skewness(mesh: QuadMesh) -> Array:
    """Equiangular skewness max{(θ_max - 90°)/90°, (90° - θ_min)/90°} of each element, shape (e,).

    The angles are those between the element's curved sides at its corners. 0 is best; above 1 a corner is turned over.
    """
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    J = jacobian(mesh, corners)
    angle = np.arctan2(_determinant(J), J[..., 0, 0] * J[..., 0, 1] + J[..., 1, 0] * J[..., 1, 1])
    # At corners 1 and 3 the interior angle is the supplement of the angle from x_ξ to x_η.
    angle[:, [1, 3]] = np.pi - angle[:, [1, 3]]
    return np.asarray(np.abs(angle / (np.pi / 2.0) - 1.0).max(axis=1))


def _gauss_values(mesh: QuadMesh) -> Array:
    """det J, a polynomial of degree 2p - 1 in each direction, at the 2p Gauss points of each (e, 2p, 2p; η first)."""
    count = 2 * mesh.order
    return det_jacobian(mesh, tensor_quadrature(count)[0]).reshape(-1, count, count)


def _extremes(values: Array) -> tuple[Array, Array]:
    """Lower and upper bounds of polynomials given at Gauss points, each of shape (e,).

    Bernstein coefficients of a high degree drown in round-off, so only the Legendre modes up to `_BERNSTEIN_DEGREE`
    pass through them; a higher mode is at most its coefficient.
    """
    count = values.shape[1]
    degree = min(count - 1, _BERNSTEIN_DEGREE)
    B = bernstein_from_legendre(degree) @ legendre_from_gauss(count)[: degree + 1]
    coefficients = B @ values @ B.T
    lower, upper = coefficients.min(axis=(1, 2)), coefficients.max(axis=(1, 2))
    if degree == count - 1:
        return lower, upper
    modes = np.abs(legendre_from_gauss(count) @ values @ legendre_from_gauss(count).T)
    modes[:, : degree + 1, : degree + 1] = 0.0
    rest = modes.sum(axis=(1, 2))
    return lower - rest, upper + rest


def det_jacobian_bounds(mesh: QuadMesh, subdivisions: int = 0) -> tuple[Array, Array]:
    """Certified lower and upper bounds of det J of each element.

    Parameters
    ----------
    mesh : QuadMesh
    subdivisions : int
        How often an element whose lower bound is not positive is cut in four to sharpen that bound.

    Returns
    -------
    lower, upper : ndarray, shape (e,)

    References
    ----------
    Johnen, Remacle, Geuzaine, J. Comput. Phys. 233 (2013) 359–372, doi:10.1016/j.jcp.2012.08.051.
    """
    values = _gauss_values(mesh)
    lower, upper = _extremes(values)
    open_elements = np.flatnonzero(lower <= 0.0)
    if subdivisions and open_elements.size:
        finer = _sharpened(values[open_elements], subdivisions)
        lower[open_elements] = np.maximum(lower[open_elements], finer)
    return lower, upper


def _sharpened(pieces: Array, subdivisions: int) -> Array:
    """Lower bounds of polynomials given at Gauss points, by cutting the pieces whose bound is not positive in four."""
    owner = np.arange(len(pieces))
    bound = np.full(len(pieces), -np.inf)
    settled = np.full(len(pieces), np.inf)  # smallest positive bound among the pieces that need no further cut
    for _ in range(subdivisions):
        pieces, owner = _subdivide(pieces), np.repeat(owner, 4)
        low, _ = _extremes(pieces)
        bound = settled.copy()
        np.minimum.at(bound, owner, low)
        done = low > 0.0
        np.minimum.at(settled, owner[done], low[done])
        pieces, owner = pieces[~done], owner[~done]
        if not owner.size:
            break
    return bound


def _subdivide(values: Array) -> Array:
    """Cut polynomials given at Gauss points in four; children of one parent are adjacent."""
    points, _ = gauss_legendre(values.shape[1])
    halves = [lagrange(points, 0.5 * (points + end)) for end in (-1.0, 1.0)]
    quarters = [first @ values @ second.T for first in halves for second in halves]
    return np.stack(quarters, axis=1).reshape(-1, *values.shape[1:])


@dataclass(frozen=True)
class BadElement:
    """An element whose det J is not positive: where it is worst, and the likely reason."""

    element: int
    det_J: float
    xi: float
    eta: float
    x: float
    y: float
    reason: str


def invalid_elements(mesh: QuadMesh, subdivisions: int = 6) -> list[BadElement]:
    """Elements that are not certainly valid, worst first.

    An element counts as valid when the Bernstein bound proves det J > 0, after up to ``subdivisions`` cuts.
    """
    values = _gauss_values(mesh)
    lower, _ = _extremes(values)
    elements = np.flatnonzero(~(lower > 0.0))
    if not elements.size:
        return []
    grid = np.concatenate([_dense_grid(mesh.order), _square(gauss_lobatto(mesh.order))])
    part = QuadMesh(mesh.points, mesh.cells[elements].copy(), mesh.order, {}, {})
    det_J = det_jacobian(part, grid)
    certain = np.zeros(len(elements), dtype=bool)
    undecided = np.flatnonzero(det_J.min(axis=1) > 0.0)  # the others are bad already; cutting them would be endless
    if undecided.size:
        certain[undecided] = _sharpened(values[elements[undecided]], subdivisions) > 0.0
    if certain.all():
        return []
    elements, det_J = elements[~certain], det_J[~certain]
    part = QuadMesh(mesh.points, mesh.cells[elements].copy(), mesh.order, {}, {})
    at = det_J.argmin(axis=1)
    places = (tensor_basis(gauss_lobatto(mesh.order), grid[at])[:, None, :] @ part.coordinates)[:, 0]
    found = [
        BadElement(
            int(element),
            float(det_J[k, at[k]]),
            float(grid[at[k], 0]),
            float(grid[at[k], 1]),
            float(places[k, 0]),
            float(places[k, 1]),
            _reason(det_J[k], grid[at[k]]),
        )
        for k, element in enumerate(elements)
    ]
    return sorted(found, key=lambda bad: bad.det_J)


def _reason(det_J: Array, xi: Array) -> str:
    if not np.isfinite(det_J).all():
        return "Its nodes are not finite."
    if (det_J <= 0.0).all():
        return "The element is inverted: check the order of the block's vertices and the positions of its neighbours."
    if det_J.min() > 0.0:
        return "det J is positive where sampled but too close to zero to be certain: move a vertex or soften the curve."
    if np.abs(xi).max() == 1.0 and np.abs(xi).min() == 1.0:
        return "The angle at that corner is 180° or more: move a vertex of its block or soften its curves."
    return (
        "Edges of its block cross or bend too far: move a vertex, split the block or soften the curve or the grading."
    )
