"""Multigrid by pyamg: patches of unknowns on the finest level, smoothed aggregation below it."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hoblock.extras import import_extra
from hofsi.errors import LinearSolverError

__all__ = ["Coarsening", "PatchMultigrid", "pyamg_module"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_DIRECT = 500  # unknowns at most on the level that is solved by LU


def pyamg_module(name: str = "pyamg") -> ModuleType:
    """Import pyamg or one of its modules.

    Raises
    ------
    MissingExtraError
        If pyamg is not installed; names the extra that brings it.
    """
    return import_extra(name, "amg", "hofsi-coupler")


@dataclass(frozen=True, eq=False)
class Coarsening:
    """How a matrix of high order is taken to one of order 1, and what is solved for together before and after.

    Attributes
    ----------
    prolongation : csr_matrix, shape (n, m)
        From the coarse unknowns to all.
    patches : csr_matrix, shape (k, n)
        The entries of a row are the unknowns of one patch; patches may overlap, together they hold all unknowns.
    near_kernel : ndarray, shape (m, l)
        Coarse vectors that the operator nearly takes to zero away from the boundary.
    """

    prolongation: sp.csr_matrix
    patches: sp.csr_matrix
    near_kernel: Array


class PatchMultigrid:
    """One multigrid cycle for a matrix of high order, an approximate inverse.

    The finest level is smoothed by multiplicative Schwarz sweeps over the patches, forward before and backward after
    the coarse correction. That is one cycle of smoothed aggregation on Pᵀ A P, with Gauss–Seidel smoothing if A is
    symmetric and with Gauss–Seidel on the normal equations (which convection does not harm) if it is not. For a
    symmetric A the cycle is symmetric.

    Parameters
    ----------
    matrix : sparse matrix, shape (n, n)
    coarsening : Coarsening
    symmetric : bool
        Whether A is symmetric and positive definite.

    Raises
    ------
    LinearSolverError
        If the matrix of a patch is singular.
    MissingExtraError
        If pyamg is not installed.

    References
    ----------
    Pavarino, Numer. Math. 66 (1994) 493–515, doi:10.1007/BF01385709 (patches around vertices, order 1 as coarse space).
    Vaněk, Mandel, Brezina, Computing 56 (1996) 179–196, doi:10.1007/BF02238511.
    """

    def __init__(self, matrix: sp.spmatrix, coarsening: Coarsening, *, symmetric: bool) -> None:
        self._sweep: Any = pyamg_module("pyamg.relaxation.relaxation").schwarz
        self._A = sp.csr_matrix(matrix)
        self._A.sort_indices()
        self._P, self._R = coarsening.prolongation, coarsening.prolongation.T.tocsr()
        self._patches = _patches_and_inverses(self._A, coarsening.patches)
        coarse = (self._R @ self._A @ self._P).tocsr()
        self._coarse: Any = _aggregation(coarse, coarsening.near_kernel, symmetric) if coarse.shape[0] else None

    def solve(self, b: Array, /) -> Array:
        """Return the result of one cycle from zero for A x = b."""
        x = np.zeros(len(b))
        self._sweep(self._A, x, b, 1, *self._patches, sweep="forward")
        if self._coarse is not None:
            r = self._R @ (b - self._A @ x)
            x += self._P @ self._coarse.solve(r, maxiter=1, tol=1e-15)
        self._sweep(self._A, x, b, 1, *self._patches, sweep="backward")
        return x


def _patches_and_inverses(A: sp.csr_matrix, patches: sp.csr_matrix) -> tuple[Index, Index, Array, Index]:
    """Unknowns of the patches, where each begins, the inverses of their matrices, where each of those begins."""
    patches = patches.sorted_indices()
    sizes = np.diff(patches.indptr)
    sizes = sizes[sizes > 0]
    unknowns = patches.indices.astype(np.int32)
    start = np.concatenate(([0], np.cumsum(sizes)))
    block_start = np.concatenate(([0], np.cumsum(sizes.astype(np.int64) ** 2)))
    inverses = np.empty(block_start[-1])
    for size in np.unique(sizes):
        chosen = np.flatnonzero(sizes == size)
        members = unknowns[start[chosen][:, None] + np.arange(size)]
        rows = np.broadcast_to(members[:, :, None], (len(chosen), size, size))
        blocks = np.asarray(A[rows.ravel(), rows.transpose(0, 2, 1).ravel()]).reshape(rows.shape)
        try:
            inverse = np.linalg.inv(blocks)
        except np.linalg.LinAlgError as error:
            raise LinearSolverError(
                f"the matrix of a patch of {size} unknowns is singular; multigrid needs a regular "
                'one. Use linear.solver = "direct".',
                "singular",
            ) from error
        inverses[block_start[chosen][:, None] + np.arange(size * size)] = inverse.reshape(len(chosen), -1)
    return unknowns, start.astype(np.int32), inverses, block_start.astype(np.int32)


def _aggregation(A: sp.csr_matrix, near_kernel: Array, symmetric: bool) -> Any:
    """Smoothed aggregation hierarchy.

    The prolongation is smoothed with local weights, for those from spectral radii are random numbers.
    """
    smoother = ("gauss_seidel" if symmetric else "gauss_seidel_nr", {"sweep": "symmetric", "iterations": 2})
    return pyamg_module().smoothed_aggregation_solver(
        A,
        B=near_kernel,
        BH=None if symmetric else near_kernel,
        symmetry="symmetric" if symmetric else "nonsymmetric",
        smooth=("jacobi", {"omega": 1.0, "weighting": "local"}),
        presmoother=smoother,
        postsmoother=smoother,
        improve_candidates=None,
        max_coarse=_DIRECT,
        coarse_solver="splu",
    )
