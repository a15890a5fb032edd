"""Symmetric sparse systems of element matrices with given values; unknowns inside elements are eliminated first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import spilu, splu

from full_mesh_movers.errors import MotionFailed
from hofsi.fem.assembly import MatrixPattern, assemble_vector

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["CondensedFactor", "CondensedSystem"]

_CHUNK = 256
"""Elements whose matrices are in memory at the same time."""

_REFINE = 1e-13
_ACCEPT = 1e-6


class CondensedSystem:
    """Pattern and order of elimination of systems on the same elements with values given at the same unknowns.

    The nodes on the sides of the elements are numbered in a minimum-degree order of their graph, the components of a
    node one after the other. It is found once; factorisations keep it and do not pivot.

    Parameters
    ----------
    cells : ndarray, shape (e, i)
        Nodes of the elements, those on the sides first.
    boundary : int
        How many of them are on the sides.
    given : ndarray of bool, shape (n, c)
        Components of nodes whose values are given. Nodes inside elements must not be among them.

    Notes
    -----
    Without pivoting, every leading block of the matrix in this order has to be regular. This holds for positive
    definite matrices and, if w comes before u at each node, for the mixed form [[M, -K], [-K, 0]] with M and the block
    of K at unknown u positive definite.
    """

    def __init__(self, cells: Index, boundary: int, given: NDArray[np.bool_]) -> None:
        if given[cells[:, boundary:]].any():
            raise ValueError("a given node is inside an element; expected nodes on sides of elements only.")
        self.count, self.components = given.shape
        self.boundary = boundary * self.components
        self.dofs = (cells[:, :, None] * self.components + np.arange(self.components)).reshape(len(cells), -1)
        sides = cells[:, :boundary]
        place = _elimination(sides, given.all(axis=1))
        unknown = np.zeros(given.shape, dtype=bool)
        unknown[np.unique(sides)] = True
        free = np.flatnonzero((unknown & ~given).ravel())
        order = np.lexsort((free % self.components, place[free // self.components]))
        self.unknowns = free[order]
        number = np.full(given.size, -1)
        number[self.unknowns] = np.arange(len(self.unknowns))
        self.given = np.flatnonzero(given.ravel())
        self.touching = np.flatnonzero(given[sides].any(axis=(1, 2)))
        self.skeleton = number[self.dofs[:, : self.boundary]]
        self.pattern = MatrixPattern(self.skeleton, len(self.unknowns))

    def factorise(self, matrices: Callable[[slice], Array]) -> CondensedFactor:
        """Condense and factorise.

        Parameters
        ----------
        matrices : callable
            From a range of elements to their symmetric matrices (k, i c, i c), local unknowns c i + component.

        Raises
        ------
        MotionFailed
            If the matrix is singular.
        """
        e, b = len(self.dofs), self.boundary
        inner = self.dofs.shape[1] - b
        S = np.empty((e, b, b))
        inverse, X = np.empty((e, inner, inner)), np.empty((e, inner, b))
        try:
            for first in range(0, e, _CHUNK):
                some = slice(first, min(first + _CHUNK, e))
                A = matrices(some)
                if not inner:
                    S[some] = A
                    continue
                inverse[some] = np.linalg.inv(A[:, b:, b:])
                X[some] = inverse[some] @ A[:, b:, :b]
                S[some] = A[:, :b, :b] - A[:, :b, b:] @ X[some]
            matrix = self.pattern.matrix(S)
            lu = None
            if self.unknowns.size:
                lu = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except (RuntimeError, np.linalg.LinAlgError) as error:
            raise MotionFailed(f"the system of {len(self.unknowns)} unknowns is singular ({error}).") from error
        return CondensedFactor(self, S[self.touching], inverse, X, matrix, lu)


def _elimination(sides: Index, given: NDArray[np.bool_]) -> Index:
    """Place of each node in a minimum-degree order; that of given nodes and nodes inside elements has no meaning."""
    nodes = np.unique(sides)
    nodes = nodes[~given[nodes]]
    place = np.zeros(len(given), dtype=np.int64)
    if nodes.size:
        number = np.full(len(given), -1)
        number[nodes] = np.arange(len(nodes))
        b = sides.shape[1]
        local = np.broadcast_to((b + 1.0) * np.eye(b) - 1.0, (len(sides), b, b))
        graph = MatrixPattern(number[sides], len(nodes)).matrix(local)
        # SuperLU tells its order with the factors only; an incomplete factorisation that drops all is the cheapest.
        factors = spilu(
            graph, permc_spec="MMD_AT_PLUS_A", drop_tol=1.0, fill_factor=1.0, options={"SymmetricMode": True}
        )
        place[nodes] = factors.perm_c
    return place


@dataclass(frozen=True, eq=False)
class CondensedFactor:
    """A factorised system; made by `CondensedSystem.factorise`."""

    system: CondensedSystem
    _S: Array  # of the elements with given values
    _inverse: Array
    _X: Array
    _matrix: sp.csc_matrix
    _lu: object

    def solve(self, values: Array, load: Array | None = None) -> Array:
        """Solve for all unknowns and for several right-hand sides at a time.

        Parameters
        ----------
        values : ndarray, shape (n, c, r)
            Only the given ones are read.
        load : ndarray, shape (n, c, r), optional
            Right-hand side, zero by default; what is there at given unknowns is not read.

        Returns
        -------
        ndarray, shape (n, c, r)

        Raises
        ------
        MotionFailed
            If the residual is not small.
        """
        system = self.system
        flat = values.reshape(system.count * system.components, -1)
        x = np.zeros_like(flat)
        x[system.given] = flat[system.given]
        outside, inside = system.dofs[:, : system.boundary], system.dofs[:, system.boundary :]
        rhs = self._assembled(system.skeleton[system.touching], -(self._S @ x[outside[system.touching]]))
        if load is not None:
            f = load.reshape(flat.shape)
            rhs += f[system.unknowns] - self._assembled(system.skeleton, self._X.transpose(0, 2, 1) @ f[inside])
        x[system.unknowns] = self._skeleton_solution(rhs)
        if inside.size:
            x[inside] = -(self._X @ x[outside])
            if load is not None:
                x[inside] += self._inverse @ f[inside]
        return x.reshape(values.shape)

    def _assembled(self, numbers: Index, local: Array) -> Array:
        size = len(self.system.unknowns)
        return np.stack([assemble_vector(numbers, local[..., k], size) for k in range(local.shape[2])], axis=-1)

    def _skeleton_solution(self, rhs: Array) -> Array:
        size = float(np.abs(rhs).max(initial=0.0))
        if self._lu is None or size == 0.0:
            return np.zeros_like(rhs)
        x = self._lu.solve(rhs)
        r = rhs - self._matrix @ x
        if np.abs(r).max() > _REFINE * size:
            x = x + self._lu.solve(r)
            r = rhs - self._matrix @ x
        if not np.abs(r).max() <= _ACCEPT * size:
            raise MotionFailed(f"relative residual {np.abs(r).max() / size:.2g} of the linear system; it is singular.")
        return x
