"""Batches of square matrices, to solve with: inverses of small ones, LU factors of large ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from hofsi.errors import LinearSolverError

Array = NDArray[np.float64]
Index = NDArray[np.int32]

__all__ = ["BlockFactors", "BlockInverses", "BlockSolver", "block_solver", "joined"]

_LARGE = 90
"""Rows from which factors, made block by block, take less time than inverses of all blocks at once."""


_ABSURD = 1e100
"""Entries that no units explain."""


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


def joined(solvers: Sequence[BlockSolver]) -> BlockSolver:
    """What solves with the matrices of several batches, made by `block_solver`, one after the other."""
    if len(solvers) == 1:
        return solvers[0]
    if isinstance(solvers[0], BlockInverses):
        return BlockInverses.joined([solver for solver in solvers if isinstance(solver, BlockInverses)])
    return BlockFactors.joined([solver for solver in solvers if isinstance(solver, BlockFactors)])


class BlockInverses:
    """Inverses of matrices of shape (e, n, n)."""

    def __init__(self, B: Array) -> None:
        try:
            self._inverses = np.linalg.inv(B)
        except np.linalg.LinAlgError as error:
            raise _failure(B) from error

    @staticmethod
    def joined(parts: Sequence[BlockInverses]) -> BlockInverses:
        """Inverses of several batches."""
        result = BlockInverses.__new__(BlockInverses)
        result._inverses = np.concatenate([part._inverses for part in parts])
        return result

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
                raise _failure(block)
            self._factors.append((lu, pivots))

    @staticmethod
    def joined(parts: Sequence[BlockFactors]) -> BlockFactors:
        """Factors of several batches."""
        result = BlockFactors.__new__(BlockFactors)
        result._factors = [factor for part in parts for factor in part._factors]
        return result

    def solve(self, R: Array) -> Array:
        """Solve B X = R for each block, shapes (e, n, k)."""
        X = np.empty(R.shape)
        for (lu, pivots), right, x in zip(self._factors, R, X, strict=True):
            x[:] = lapack.dgetrs(lu, pivots, right, trans=1)[0]
        return X


def _failure(B: Array) -> LinearSolverError:
    """Why matrices cannot be solved with."""
    largest = float(np.abs(B).max())
    if largest < _ABSURD:
        return LinearSolverError("the matrix of an element's inner unknowns is singular.", "singular")
    return LinearSolverError(
        f"the matrix of an element's inner unknowns has entries of {largest:.2g}: the flow has diverged. Lower the "
        "time step or the Reynolds number, or check the given velocities.",
        "diverged",
    )
