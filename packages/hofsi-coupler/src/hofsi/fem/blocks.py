"""Batches of square matrices, to solve with: inverses of small ones, LU factors of large ones."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from hofsi.errors import LinearSolverError

Array = NDArray[np.float64]
Index = NDArray[np.int32]

__all__ = ["BlockFactors", "BlockInverses", "BlockSolver", "block_solver"]

_LARGE = 90
"""Rows from which factors, made block by block, take less time than inverses of all blocks at once."""


class BlockSolver(Protocol):
    """Solves with a batch of matrices."""

    def solve(self, R: Array) -> Array:
        """Solve B X = R for each block, shapes (e, n, k)."""
        ...


def block_solver(B: Array) -> BlockSolver:
    """Make what solves with matrices of shape (e, n, n).

    Raises
    ------
    LinearSolverError
        If one of them is singular.
    """
    return BlockFactors(B) if B.shape[1] >= _LARGE else BlockInverses(B)


class BlockInverses:
    """Inverses of matrices of shape (e, n, n)."""

    def __init__(self, B: Array) -> None:
        try:
            self._inverses = np.linalg.inv(B)
        except np.linalg.LinAlgError as error:
            raise _singular() from error

    def solve(self, R: Array) -> Array:
        """Solve B X = R for each block, shapes (e, n, k)."""
        return np.asarray(self._inverses @ R)


class BlockFactors:
    """LU factors of matrices of shape (e, n, n), with partial pivoting."""

    def __init__(self, B: Array) -> None:
        self._factors: list[tuple[Array, Index]] = []
        for block in B:
            # LAPACK reads columns: what it sees of an array of rows is the transpose.
            lu, pivots, info = lapack.dgetrf(block.T)
            if info:
                raise _singular()
            self._factors.append((lu, pivots))

    def solve(self, R: Array) -> Array:
        """Solve B X = R for each block, shapes (e, n, k)."""
        X = np.empty(R.shape)
        for (lu, pivots), right, x in zip(self._factors, R, X, strict=True):
            x[:] = lapack.dgetrs(lu, pivots, right, trans=1)[0]
        return X


def _singular() -> LinearSolverError:
    return LinearSolverError("the matrix of an element's inner unknowns is singular.")
