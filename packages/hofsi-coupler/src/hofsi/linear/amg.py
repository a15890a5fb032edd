"""Multigrid by pyamg: patches of unknowns on the finest level, smoothed aggregation below it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hofsi.linear.extra import pyamg_module
from hofsi.linear.patches import PatchSmoother

__all__ = ["Coarsening", "PatchMultigrid"]

Array = NDArray[np.float64]

_DIRECT = 500  # unknowns at most on the level that is solved by LU


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
        pyamg_module()
        A = sp.csr_matrix(matrix)
        self._smoother = PatchSmoother(A, coarsening.patches)
        self._P, self._R = coarsening.prolongation, coarsening.prolongation.T.tocsr()
        coarse = (self._R @ A @ self._P).tocsr()
        self._coarse: Any = _aggregation(coarse, coarsening.near_kernel, symmetric) if coarse.shape[0] else None

    def solve(self, b: Array, /) -> Array:
        """Return the result of one cycle from zero for A x = b."""
        x = np.zeros(len(b))
        self._smoother.sweep(x, b)
        if self._coarse is not None:
            r = self._R @ self._smoother.residual(x, b)
            x += self._P @ self._coarse.solve(r, maxiter=1, tol=1e-15)
        self._smoother.sweep(x, b, backward=True)
        return x


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
