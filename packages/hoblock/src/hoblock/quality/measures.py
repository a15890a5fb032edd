"""Measures of each element: scaled Jacobian, Jacobian ratio, equiangular skewness, aspect ratio, area.

All of them work chunk by chunk on coordinates relative to the element, so that memory stays small and neither the size
of a mesh nor its distance from the origin matters. An element with a node that is NaN or infinite has the measure NaN.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.quality.coordinates import ElementCoordinates, chunks, element_coordinates
from hoblock.reference import equispaced, gauss_legendre, gauss_lobatto, lagrange, lagrange_derivative

Array = NDArray[np.float64]

__all__ = [
    "aspect_ratio",
    "element_areas",
    "equiangular_skewness",
    "jacobian_ratio",
    "scaled_jacobian",
]


class _Grid:
    """Basis and derivatives at a tensor grid of points."""

    def __init__(self, order: int, xi: Array, eta: Array | None = None) -> None:
        nodes = gauss_lobatto(order)
        eta = xi if eta is None else eta
        self.order = order
        self.N_xi, self.D_xi = lagrange(nodes, xi), lagrange_derivative(nodes, xi)
        self.N_eta, self.D_eta = lagrange(nodes, eta), lagrange_derivative(nodes, eta)

    def tangents(self, x: Array) -> tuple[Array, Array]:
        """x_ξ and x_η of elements (2, (p + 1)², k), each (2, points along η, points along ξ, k)."""
        n, k = self.order + 1, x.shape[2]
        nodes = x.reshape(2, n, n, k)

        def derivative(along_xi: Array, along_eta: Array) -> Array:
            first = (along_xi @ nodes).reshape(2, n, -1)
            return np.asarray((along_eta @ first).reshape(2, len(along_eta), len(along_xi), k))

        return derivative(self.D_xi, self.N_eta), derivative(self.N_xi, self.D_eta)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[0] * b[1] - a[1] * b[0])


def _length(a: Array) -> Array:
    return np.asarray(np.hypot(a[0], a[1]))


def _measured(mesh: QuadMesh, measure: Callable[[ElementCoordinates], Array]) -> Array:
    """A measure of all elements, chunk by chunk; NaN where nodes are not finite."""
    result = np.empty(len(mesh.cells))
    for some in chunks(mesh.order, len(mesh.cells)):
        coordinates = element_coordinates(mesh, some)
        values = measure(coordinates)
        values[~coordinates.finite] = np.nan
        result[some] = values
    return result


def scaled_jacobian(mesh: QuadMesh, samples: int | None = None) -> Array:
    """Minimum of det J/(|x_ξ||x_η|), the sine of the angle between the grid lines, over a grid of each element.

    Parameters
    ----------
    mesh : QuadMesh
    samples : int, optional
        Points along each direction, at least 2; default 2p + 1.

    Returns
    -------
    ndarray, shape (e,)
        In [-1, 1]; 1 for rectangles. 0 where x_ξ or x_η vanishes.

    Raises
    ------
    ValueError
        If there are fewer than two samples.
    """
    count = 2 * mesh.order + 1 if samples is None else samples
    if count < 2:
        raise ValueError(f"scaled_jacobian: samples is {samples}; expected an integer >= 2.")
    grid = _Grid(mesh.order, equispaced(count - 1))

    def measure(coordinates: ElementCoordinates) -> Array:
        x_xi, x_eta = grid.tangents(coordinates.isotropic)
        lengths = np.maximum(_length(x_xi) * _length(x_eta), np.finfo(float).tiny)
        return np.asarray((_cross(x_xi, x_eta) / lengths).min(axis=(0, 1)))

    return _measured(mesh, measure)


def jacobian_ratio(mesh: QuadMesh) -> Array:
    """min det J/max det J over a dense grid of each element, shape (e,), in (-∞, 1]; -∞ if no det J is positive."""
    grid = _Grid(mesh.order, equispaced(2 * mesh.order))

    def measure(coordinates: ElementCoordinates) -> Array:
        det_J = _cross(*grid.tangents(coordinates.x))
        smallest, largest = det_J.min(axis=(0, 1)), det_J.max(axis=(0, 1))
        return np.where(largest > 0.0, smallest / np.where(largest > 0.0, largest, 1.0), -np.inf)

    return _measured(mesh, measure)


def equiangular_skewness(mesh: QuadMesh) -> Array:
    """Equiangular skewness max{(θ_max - 90°)/90°, (90° - θ_min)/90°} of each element, shape (e,).

    The angles are those between the element's curved sides at its corners. 0 is best; above 1 a corner is turned over.
    """
    grid = _Grid(mesh.order, np.array([-1.0, 1.0]))

    def measure(coordinates: ElementCoordinates) -> Array:
        x_xi, x_eta = grid.tangents(coordinates.isotropic)
        angle = np.arctan2(_cross(x_xi, x_eta), (x_xi * x_eta).sum(axis=0))  # (η, ξ, k)
        # At the corners (1, -1) and (-1, 1) the interior angle is the supplement of the angle from x_ξ to x_η.
        angle[0, 1], angle[1, 0] = np.pi - angle[0, 1], np.pi - angle[1, 0]
        return np.asarray(np.abs(angle / (np.pi / 2.0) - 1.0).max(axis=(0, 1)))

    return _measured(mesh, measure)


def aspect_ratio(mesh: QuadMesh) -> Array:
    """Ratio of the arc lengths of an element's two mid lines, the longer over the shorter, shape (e,), at least 1.

    The mid lines are the curves η = 0 and ξ = 0; their lengths are found by 2p + 2 Gauss points. Infinite where a mid
    line has no length.
    """
    points, weights = gauss_legendre(2 * mesh.order + 2)
    along_xi = _Grid(mesh.order, points, np.zeros(1))
    along_eta = _Grid(mesh.order, np.zeros(1), points)

    def measure(coordinates: ElementCoordinates) -> Array:
        x = coordinates.isotropic
        lengths = weights @ _length(along_xi.tangents(x)[0])[0], weights @ _length(along_eta.tangents(x)[1])[:, 0]
        shorter, longer = np.minimum(*lengths), np.maximum(*lengths)
        return np.where(shorter > 0.0, longer / np.where(shorter > 0.0, shorter, 1.0), np.inf)

    return _measured(mesh, measure)


def element_areas(mesh: QuadMesh) -> Array:
    """Area ∫ det J of each element, shape (e,), exact for its polynomial map; negative for an inverted element."""
    points, weights = gauss_legendre(mesh.order)
    grid = _Grid(mesh.order, points)

    def measure(coordinates: ElementCoordinates) -> Array:
        det_J = _cross(*grid.tangents(coordinates.x))
        return coordinates.unscaled(np.einsum("i,j,ijk->k", weights, weights, det_J))

    return _measured(mesh, measure)
