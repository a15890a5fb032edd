"""Equispaced geometry for file formats that assume it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.reference import equispaced, gauss_lobatto, lagrange

Array = NDArray[np.float64]

__all__ = ["equispaced_points"]


def equispaced_points(mesh: QuadMesh) -> Array:
    """Points of the same elements with equispaced instead of GLL nodes.

    Parameters
    ----------
    mesh : QuadMesh

    Returns
    -------
    ndarray, shape (n, 2)
        Numbered as in ``mesh.cells``. The geometry is exactly the same: an element map is a polynomial of order p,
        whatever nodes carry it.
    """
    n = mesh.order + 1
    if mesh.order <= 2:  # the nodes coincide
        return np.array(mesh.points)
    B = lagrange(gauss_lobatto(mesh.order), equispaced(mesh.order))
    along_xi = B @ mesh.coordinates.reshape(-1, n, n, 2)  # (e, j, i, d), j along η
    along_eta = B @ along_xi.transpose(0, 2, 1, 3)  # (e, i, j, d)
    points = np.array(mesh.points)
    points[mesh.cells] = along_eta.transpose(0, 2, 1, 3).reshape(len(mesh.cells), -1, 2)
    return points
