"""How the vertices of a structure respond to small motions of the driven ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.movers._corner_energies import DistortionEnergy
from hoblock.movers._corners import block_corners
from hoblock.movers._newton import solve_positive
from hoblock.movers._roles import VertexRoles
from hoblock.movers._unknowns import chain_rule

Array = NDArray[np.float64]

__all__ = ["linear_response"]

_DENSE = 400
"""Unknowns up to which a dense matrix is factorised."""


def linear_response(structure: BlockStructure, roles: VertexRoles) -> Array:
    """Response (size, 2 len(driven)) of the unknowns to the driven vertices, by the distortion of the corners.

    Parameters
    ----------
    structure : BlockStructure
        In the reference.
    roles : VertexRoles
    """
    count = 2 * len(roles.free) + len(roles.sliding.vertices)
    if not count or not len(roles.driven):
        return np.zeros((count, 2 * len(roles.driven)))
    moving = np.union1d(roles.movable, roles.driven)
    none = np.zeros(0, dtype=np.int64)
    corners = block_corners(structure, moving, none, np.zeros((0, 2, 2)))
    z = corners.vectors(structure.vertices, None, structure.vertices)
    hessian = corners.sums.sparse(DistortionEnergy(z, 1.0, 0.0).derivatives(z, 0.0).hessian)
    first = roles.sliding.derivatives(roles.sliding.start)[0]
    chain = chain_rule(
        np.searchsorted(moving, roles.free), np.searchsorted(moving, roles.sliding.vertices), first, len(moving)
    )
    driven = (2 * np.searchsorted(moving, roles.driven)[:, None] + [0, 1]).ravel()
    right = np.asarray((chain.T @ hessian[:, driven]).todense())
    inner = chain.T @ hessian @ chain
    solution = solve_positive(np.asarray(inner.todense()) if count <= _DENSE else inner, -right, regularised=True)
    return np.zeros_like(right) if solution is None else solution
