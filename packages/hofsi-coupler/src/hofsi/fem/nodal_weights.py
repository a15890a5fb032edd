"""Weights of nodes in sums that stand for integrals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.quality import element_areas
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_quadrature

Array = NDArray[np.float64]

__all__ = ["nodal_weights"]


def nodal_weights(mesh: QuadMesh) -> Array:
    """Gauss–Lobatto weights of the nodes, times the areas of their elements: positive, their sum is the mesh's area.

    Σ w f² is about ∫ f²: near enough for the norm of an error, exact on parallelograms for f² of order 2p - 1.

    Parameters
    ----------
    mesh : QuadMesh

    Returns
    -------
    ndarray, shape (n,)
    """
    points, weights = tensor_quadrature(mesh.order + 1)
    local = weights @ tensor_basis(gauss_lobatto(mesh.order), points) / weights.sum()
    shares = element_areas(mesh)[:, None] * local
    total = np.bincount(mesh.cells.ravel(), weights=shares.ravel(), minlength=len(mesh.points))
    return np.asarray(total, dtype=np.float64)
