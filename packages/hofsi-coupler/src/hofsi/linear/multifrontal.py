"""Multifrontal LU of a sum of element matrices: dense LAPACK factorisations on a nested dissection of the elements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg import blas, lapack

from hofsi.errors import LinearSolverError
from hofsi.linear.checked import CheckedSolver
from hofsi.linear.direct import PivotedFactor
from hofsi.linear.dissection import Front, dissect

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["EliminationTree", "MultifrontalFactor", "multifrontal_solver"]

_LEAF_UNKNOWNS = 260
"""Unknowns of the elements of a leaf together, each counted as often as elements have it."""


class EliminationTree:
    """What can be known before the numbers: the fronts, and where the entries of their children and elements go.

    Parameters
    ----------
    cells : ndarray, shape (e, k)
        Unknowns of each element; negative ones are dropped.
    size : int
        Number of unknowns.
    places : ndarray, shape (e, 2)
        Where the elements are.
    leaf : int, optional
        Elements of a part that is not cut any more.
    kept : int, optional
        How many of the unknowns, the last ones, are not eliminated.
    """

    def __init__(self, cells: Index, size: int, places: Array, leaf: int | None = None, kept: int = 0) -> None:
        self.cells, self.size, self.kept = cells, size, kept
        leaf = leaf or max(1, round(_LEAF_UNKNOWNS / max(1, cells.shape[1])))
        self.fronts = dissect(cells, places, leaf, np.arange(size - kept, size))
        self._slots = {k: self._leaf_slots(front) for k, front in enumerate(self.fronts) if not front.children}
        self.maps = [self._runs(front) for front in self.fronts]

    @property
    def entries(self) -> int:
        """Number of entries of the factors."""
        return sum(len(f.unknowns) ** 2 - (len(f.unknowns) - f.eliminated) ** 2 for f in self.fronts)

    @property
    def multiplications(self) -> float:
        """Number of multiplications of a factorisation, about."""
        n = np.array([(front.eliminated, len(front.unknowns)) for front in self.fronts], dtype=float)
        a, b = n[:, 0], n[:, 1] - n[:, 0]
        return float((a**3 / 3.0 + a**2 * b + a * b**2).sum())

    def _leaf_slots(self, front: Front) -> Index:
        """Where the entries of its elements' matrices go in the matrix of a leaf, column after column."""
        n = len(front.unknowns)
        order = np.argsort(front.unknowns)
        mine = self.cells[front.elements]
        place = order[np.minimum(np.searchsorted(front.unknowns, mine, sorter=order), n - 1)] if n else mine
        # Element matrices are (row, column) in memory, fronts (column, row).
        slot = place[:, None, :] * n + place[:, :, None]
        free = (mine >= 0)[:, None, :] & (mine >= 0)[:, :, None]
        return np.where(free, slot, n * n).ravel()

    def _runs(self, front: Front) -> list[list[tuple[slice, slice]]]:
        """For each child, the runs of what is left over there and where they go here: (here, there)."""
        result = []
        order = np.argsort(front.unknowns)
        for child in front.children:
            left = self.fronts[child].unknowns[self.fronts[child].eliminated :]
            place = order[np.searchsorted(front.unknowns, left, sorter=order)]
            cuts = np.flatnonzero(np.diff(place) != 1) + 1
            starts, stops = np.concatenate(([0], cuts)), np.append(cuts, len(place))
            result.append(
                [
                    (slice(int(place[a]), int(place[a]) + int(b - a)), slice(int(a), int(b)))
                    for a, b in zip(starts, stops, strict=True)
                    if b > a
                ]
            )
        return result

    def leaf_matrix(self, k: int, S: Array) -> Array:
        """Matrix of a leaf, in columns, from element matrices (e, k, k)."""
        front = self.fronts[k]
        n = len(front.unknowns)
        values = S[front.elements].ravel()
        columns = np.bincount(self._slots[k], weights=values, minlength=n * n + 1)[: n * n]
        return np.asarray(columns, dtype=float).reshape(n, n).T


@dataclass(frozen=True, eq=False)
class _Block:
    """Factors of a front: LU of what is eliminated, what is below it, and its solution for what is beside it."""

    lu: Array
    pivots: Index
    below: Array
    beside: Array
    own: Index
    left: Index


def multifrontal_solver(tree: EliminationTree, S: Array, matrix: Callable[[], sp.csc_matrix]) -> CheckedSolver:
    """Factorise a sum of element matrices; where fronts do not serve, by SuperLU with full pivoting.

    Parameters
    ----------
    tree : EliminationTree
    S : ndarray, shape (e, k, k)
    matrix : callable
        Makes the same as a sparse matrix.

    Raises
    ------
    LinearSolverError
        If the matrix is singular.
    """
    try:
        return CheckedSolver(MultifrontalFactor(tree, S), lambda: PivotedFactor(matrix()))
    except LinearSolverError:
        solver = CheckedSolver(PivotedFactor(matrix()))
        solver.fell_back = True
        return solver


class MultifrontalFactor:
    """LU factors of a sum of element matrices, with partial pivoting inside each front.

    If the tree keeps unknowns the factors are those of the rows and columns of all others.

    Parameters
    ----------
    tree : EliminationTree
    S : ndarray, shape (e, k, k)
        Element matrices.

    Attributes
    ----------
    complement : ndarray, shape (kept, kept)
        What the kept unknowns do to their own rows while all others balance theirs: the Schur complement.

    Raises
    ------
    LinearSolverError
        If what a front eliminates is singular; another order of elimination may not be.

    References
    ----------
    Duff, Reid, ACM Trans. Math. Softw. 9 (1983) 302–325, doi:10.1145/356044.356047.
    """

    def __init__(self, tree: EliminationTree, S: Array) -> None:
        self._tree, self._S = tree, S
        waiting: dict[int, Array] = {}
        self._blocks: list[_Block] = []
        for k, front in enumerate(tree.fronts):
            n, m = len(front.unknowns), front.eliminated
            if front.children:
                F = np.zeros((n, n), order="F")
                for child, runs in zip(front.children, tree.maps[k], strict=True):
                    C = waiting.pop(child)
                    for rows, there in runs:
                        for columns, beyond in runs:
                            here = F[rows, columns]
                            np.add(here, C[there, beyond], out=here)
            else:
                F = tree.leaf_matrix(k, S)
            waiting[k] = self._eliminate(front, F, m)
        self.complement = self._sorted(waiting.popitem()[1])

    def _sorted(self, left: Array) -> Array:
        """What the last front leaves, in the order of the unknowns."""
        place = np.argsort(self._tree.fronts[-1].unknowns[self._tree.fronts[-1].eliminated :])
        return left[np.ix_(place, place)]

    def _eliminate(self, front: Front, F: Array, m: int) -> Array:
        """Eliminate the first m unknowns of a front; return what is left."""
        if not m:
            return F
        lu, pivots, info = lapack.dgetrf(F[:m, :m])
        if info:
            raise LinearSolverError(f"a front of {m} unknowns is singular at unknown {front.unknowns[abs(info) - 1]}.")
        if len(F) == m:
            nothing = np.zeros((0, 0))
            self._blocks.append(
                _Block(lu, pivots, np.zeros((0, m)), np.zeros((m, 0)), front.unknowns, front.unknowns[m:])
            )
            return nothing
        beside = lapack.dgetrs(lu, pivots, F[:m, m:])[0]
        below = F[m:, :m].copy(order="F")
        self._blocks.append(_Block(lu, pivots, below, beside, front.unknowns[:m], front.unknowns[m:]))
        return np.asarray(blas.dgemm(-1.0, below, beside, 1.0, F[m:, m:]))

    @property
    def entries(self) -> int:
        """Number of entries of the factors."""
        return self._tree.entries

    def norm(self) -> float:
        """A bound of the largest sum of absolute values of a row: sums of the elements' own."""
        cells, size = self._tree.cells, self._tree.size
        rows = np.abs(self._S).sum(axis=2)
        return float(np.bincount(cells.ravel() + 1, weights=rows.ravel(), minlength=size + 1)[1:].max(initial=0.0))

    def substitute(self, b: Array) -> Array:
        """Solve once, without a look at the residual, for one right-hand side (n,) or several (n, k)."""
        nothing = np.zeros((self._tree.kept, *b.shape[1:]))
        x = np.concatenate([b, nothing])
        for block in self._blocks:
            y = lapack.dgetrs(block.lu, block.pivots, x[block.own])[0]
            x[block.own] = y
            x[block.left] -= block.below @ y
        return self._back(x, nothing)

    def extended(self, kept: Array) -> Array:
        """The other unknowns for given kept ones, while nothing else acts: all of them, shape (n,)."""
        return np.append(self._back(np.zeros(self._tree.size), kept), kept)

    def _back(self, x: Array, kept: Array) -> Array:
        count = len(x) - len(kept)
        x[count:] = kept
        for block in reversed(self._blocks):
            x[block.own] -= block.beside @ x[block.left]
        return x[:count]

    def product(self, x: Array) -> Array:
        """The matrix times a vector, element by element."""
        cells, size, count = self._tree.cells, self._tree.size, len(x)
        local = np.append(x, np.zeros(self._tree.kept + 1))[cells]  # number -1 reads the last zero
        products = (self._S @ local[:, :, None])[:, :, 0]
        sums = np.bincount(cells.ravel() + 1, weights=products.ravel(), minlength=size + 1)[1 : count + 1]
        return np.asarray(sums, dtype=float)
