"""Sparse LU factorisation by SuperLU, with the residual of every solution checked."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from hofsi.errors import LinearSolverError

Array = NDArray[np.float64]

__all__ = ["DirectFactor"]

_REFINE = 1e-12
_ACCEPT = 1e-8
_ROUNDING = 1e-14  # of |A| |x|: what the best factors leave; more than _ACCEPT |b| if the matrix is ill-conditioned
_WORST = 1e-3  # of |b|: whatever the condition, a solution worse than this is none


class DirectFactor:
    """LU factors of a matrix whose pattern is symmetric.

    The factorisation prefers the diagonal (threshold 1e-3) in a minimum-degree ordering of A + Aᵀ, which on
    the saddle-point matrices of this package is about ten times faster than column ordering with full pivoting. A
    solution whose residual is not small is refined once; if that does not help the matrix is factorised again with
    full pivoting. Small is 1e-8 of the right-hand side, or what rounding leaves if the matrix is ill-conditioned, as
    those of thin plates are.

    Parameters
    ----------
    matrix : csc_matrix

    Raises
    ------
    LinearSolverError
        If the matrix is singular.

    References
    ----------
    Li, ACM Trans. Math. Softw. 31 (2005) 302–325, doi:10.1145/1089014.1089017.
    """

    def __init__(self, matrix: sp.csc_matrix) -> None:
        self._matrix = matrix
        self.pivoted = False
        try:
            self._lu = spla.splu(
                matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options={"SymmetricMode": True}
            )
        except RuntimeError:
            self._factorise_with_pivoting()

    @property
    def entries(self) -> int:
        """Number of entries of the factors."""
        return int(self._lu.nnz)

    def _factorise_with_pivoting(self) -> None:
        self.pivoted = True
        try:
            self._lu = spla.splu(self._matrix, permc_spec="COLAMD", diag_pivot_thresh=1.0)
        except RuntimeError as error:
            raise LinearSolverError(
                f"the matrix of size {self._matrix.shape[0]} is singular ({error}). A boundary condition may be "
                "missing."
            ) from error

    def solve(self, b: Array) -> Array:
        """Solve A x = b.

        Raises
        ------
        LinearSolverError
            If the right-hand side is not finite or the residual stays large.
        """
        size = float(np.abs(b).max(initial=0.0))
        if size == 0.0:
            return np.zeros_like(b)
        if not np.isfinite(size):
            raise LinearSolverError("the right-hand side is not finite.", "diverged")
        x, residual = self._refined(b, size)
        if not self._acceptable(x, residual, size) and not self.pivoted:
            self._factorise_with_pivoting()
            x, residual = self._refined(b, size)
        if not self._acceptable(x, residual, size):
            raise LinearSolverError(
                f"relative residual {residual:.2g} after LU with full pivoting; expected below "
                f"{_ACCEPT:g}. The matrix is close to singular. A boundary condition may be "
                "missing."
            )
        return x

    def _acceptable(self, x: Array, residual: float, size: float) -> bool:
        if residual <= _ACCEPT:
            return True
        rounding = _ROUNDING * float(spla.norm(self._matrix, np.inf)) * float(np.abs(x).max()) / size
        return residual <= min(_WORST, rounding)

    def _refined(self, b: Array, size: float) -> tuple[Array, float]:
        x = self._lu.solve(b)
        r = b - self._matrix @ x
        residual = float(np.abs(r).max()) / size
        if residual > _REFINE:
            better = x + self._lu.solve(r)
            refined = float(np.abs(b - self._matrix @ better).max()) / size
            if refined < residual:
                return better, refined
        return x, residual
