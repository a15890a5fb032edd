"""From order p to order 1 on the same elements: interpolation and patches for multigrid."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hoblock.reference import gauss_lobatto, tensor_basis
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.element import boundary_first
from hofsi.linear.amg import Coarsening

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["skeleton_coarsening"]


def skeleton_coarsening(
    cells: Index, order: int, constraints: NodeConstraints, unknowns: Index, points: Array | None = None
) -> Coarsening:
    """Coarsening of a vector field on the elements' boundaries; a patch is a vertex with the edges that end there.

    Parameters
    ----------
    cells : ndarray, shape (e, 4 order)
        Nodes on the boundary of each element.
    order : int
    constraints : NodeConstraints
    unknowns : ndarray, shape (n,)
        Free degrees of freedom on the elements' boundaries, in the nodes' own frames, ascending.
    points : ndarray, shape (nodes, 2), optional
        If given, a rigid rotation belongs to the near-kernel besides the translations.
    """
    count = len(constraints.fixed)
    W = _interpolation(cells, order, count)
    Q = sp.bsr_matrix((constraints.frames, np.arange(count), np.arange(count + 1))).tocsr()
    P = Q.T @ sp.kron(W, np.eye(2), format="csr") @ Q
    vertices = np.unique(_corners(cells, order))
    coarse = unknowns[np.isin(unknowns // 2, vertices)]
    # A vertex' basis function is nonzero at just the nodes of its patch.
    patches = sp.kron(W.T.tocsr()[vertices], np.ones((1, 2)), format="csr")
    motions = np.tile(np.eye(2), (count, 1))
    if points is not None:
        away = points - points.mean(axis=0)
        motions = np.column_stack([motions, np.stack([-away[:, 1], away[:, 0]], axis=-1).ravel()])
    return Coarsening(P[unknowns][:, coarse], patches[:, unknowns], np.asarray(Q.T @ motions)[coarse])


def _corners(cells: Index, order: int) -> Index:
    """Corner nodes of each element, shape (e, 4), lexicographic."""
    n = order + 1
    position = np.argsort(boundary_first(order)[0])
    return np.asarray(cells[:, position[[0, order, order * n, order * n + order]]])


def _interpolation(cells: Index, order: int, count: int) -> sp.csr_matrix:
    """Matrix (count, count) from values at vertices to all nodes of the elements, bilinear in each element."""
    xi, eta = np.meshgrid(gauss_lobatto(order), gauss_lobatto(order))
    nodes = np.stack([xi.ravel(), eta.ravel()], axis=-1)[boundary_first(order)[0]][: cells.shape[1]]
    local = tensor_basis(gauss_lobatto(1), nodes)
    shape = (*cells.shape, 4)
    rows = np.broadcast_to(cells[:, :, None], shape)
    columns = np.broadcast_to(_corners(cells, order)[:, None, :], shape)
    some = np.broadcast_to(np.abs(local) > 1e-14, shape)
    keys, first = np.unique(rows[some] * count + columns[some], return_index=True)
    values = np.broadcast_to(local, shape)[some][first]
    return sp.csr_matrix((values, (keys // count, keys % count)), shape=(count, count))
