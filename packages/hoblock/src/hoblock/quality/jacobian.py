"""Jacobians of the element maps at reference points."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.quality.coordinates import chunks
from hoblock.reference import equispaced, gauss_lobatto, tensor_gradient

Array = NDArray[np.float64]

__all__ = [
    "dense_grid",
    "det_jacobian",
    "determinant",
    "jacobian",
    "jacobian_rows",
    "minimum_det_jacobian",
    "sample_points",
    "square",
]


def square(nodes: Array) -> Array:
    """Points (n², 2) of a tensor grid, ξ fastest."""
    return np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2)


def jacobian_rows(coordinates: Array, gradient: Array) -> Array:
    """Jacobians (k, q, 2, 2) of elements with given node positions (k, n, 2) from gradients (q, n, 2)."""
    x = (coordinates - coordinates[:, :1]).transpose(0, 2, 1)  # (e, c, i); far from the origin digits would be lost
    flat = x @ gradient.transpose(1, 0, 2).reshape(gradient.shape[1], -1)
    return np.asarray(flat.reshape(len(x), 2, len(gradient), 2).transpose(0, 2, 1, 3))


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
    return jacobian_rows(mesh.coordinates, tensor_gradient(gauss_lobatto(mesh.order), np.asarray(xi, dtype=float)))


def determinant(J: Array) -> Array:
    """Determinants of 2 × 2 matrices on the last two axes."""
    return np.asarray(J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0])


def det_jacobian(mesh: QuadMesh, xi: Array) -> Array:
    """det J at reference points (k, 2), shape (e, k)."""
    gradient = tensor_gradient(gauss_lobatto(mesh.order), np.asarray(xi, dtype=float))
    result = np.empty((len(mesh.cells), len(gradient)))
    for some in chunks(mesh.order, len(mesh.cells)):
        result[some] = determinant(jacobian_rows(mesh.points[mesh.cells[some]], gradient))
    return result


def dense_grid(order: int) -> Array:
    """The (2p + 1)² equispaced points at which measures of an element are sampled."""
    return square(equispaced(2 * order))


@cache
def sample_points(order: int) -> Array:
    """The dense grid and the nodes."""
    points = np.concatenate([dense_grid(order), square(gauss_lobatto(order))])
    points.setflags(write=False)
    return points


def minimum_det_jacobian(mesh: QuadMesh) -> float:
    """Smallest det J over all elements, sampled at (2p + 1)² points of each and at its nodes."""
    gradient = tensor_gradient(gauss_lobatto(mesh.order), sample_points(mesh.order))
    smallest = [
        determinant(jacobian_rows(mesh.points[mesh.cells[some]], gradient)).min()
        for some in chunks(mesh.order, len(mesh.cells))
    ]
    return float(np.min(smallest))
