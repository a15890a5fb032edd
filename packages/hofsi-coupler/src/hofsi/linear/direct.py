"""Sparse LU factorisation by SuperLU, with the residual of every solution checked."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from hofsi.errors import LinearSolverError
from hofsi.linear.checked import CheckedSolver

Array = NDArray[np.float64]

__all__ = ["DirectFactor", "PivotedFactor"]


class _SuperLU:
    """Factors by SuperLU, and the matrix."""

    def __init__(self, matrix: sp.csc_matrix, lu: spla.SuperLU) -> None:
        self._matrix, self._lu = matrix, lu

    @property
    def entries(self) -> int:
        """Number of entries of the factors."""
        return int(self._lu.nnz)

    def substitute(self, b: Array) -> Array:
        """Solve once."""
        return np.asarray(self._lu.solve(b))

    def product(self, x: Array) -> Array:
        """The matrix times a vector."""
        return np.asarray(self._matrix @ x)

    def norm(self) -> float:
        """Largest sum of absolute values of a row."""
        return float(spla.norm(self._matrix, np.inf))


class PivotedFactor(_SuperLU):
    """Column ordering with full pivoting: slow, and safe.

    Raises
    ------
    LinearSolverError
        If the matrix is singular.
    """

    def __init__(self, matrix: sp.csc_matrix) -> None:
        try:
            super().__init__(matrix, spla.splu(matrix, permc_spec="COLAMD", diag_pivot_thresh=1.0))
        except RuntimeError as error:
            raise LinearSolverError(
                f"the matrix of size {matrix.shape[0]} is singular ({error}). A boundary condition may be missing."
            ) from error


class DirectFactor(CheckedSolver):
    """LU factors of a matrix whose pattern is symmetric.

    The factorisation prefers the diagonal (threshold 1e-3) in a minimum-degree ordering of A + Aᵀ, which on
    the saddle-point matrices of this package is about ten times faster than column ordering with full pivoting, as long
    as the diagonal does serve as pivots. If the residual of a solution stays large, or a pivot vanishes, the matrix is
    factorised again with full pivoting; see `CheckedSolver`.

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
        try:
            lu = spla.splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options={"SymmetricMode": True})
        except RuntimeError:
            super().__init__(PivotedFactor(matrix))
            self.fell_back = True
        else:
            super().__init__(_SuperLU(matrix, lu), lambda: PivotedFactor(matrix))
