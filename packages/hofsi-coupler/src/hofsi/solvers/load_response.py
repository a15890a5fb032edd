"""A load that answers to the displacement of the nodes on which it acts, and linear systems with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from hofsi.errors import LinearSolverError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["LoadResponse", "RespondingSystem", "unknowns_of"]


def unknowns_of(nodes: Index) -> Index:
    """Numbers 2 n + a of the unknowns of nodes, shape (2k,)."""
    return np.asarray((2 * nodes[:, None] + np.arange(2)).ravel())


@dataclass(frozen=True, eq=False)
class LoadResponse:
    """What a load gains when its nodes are displaced: F (d - d₀).

    Attributes
    ----------
    nodes : ndarray, shape (k,)
        On the boundaries of elements.
    matrix : ndarray, shape (2k, 2k)
        F.
    about : ndarray, shape (k, 2)
        d₀, where the load is what it is said to be.
    """

    nodes: Index
    matrix: Array
    about: Array

    def add_force(self, force: Array, displacement: Array) -> None:
        """Add what a displacement (n, 2) gains to nodal forces (n, 2)."""
        force[self.nodes] += self.of(displacement[self.nodes] - self.about)

    def rounding(self, size: Array) -> float:
        """Size of the rounding error of the answer to displacements of some absolute size (n, 2)."""
        answer = np.abs(self.matrix) @ size[self.nodes].ravel()
        return float(np.finfo(float).eps * np.linalg.norm(answer))

    def of(self, change: Array) -> Array:
        """F times a change (k, 2) of displacement, shape (k, 2)."""
        return np.asarray((self.matrix @ change.ravel()).reshape(-1, 2))


class RespondingSystem:
    """Solves (K - F) x = r by solutions with K, where F acts on some nodes only.

    With C, the part of K⁻¹ at these nodes, and z = K⁻¹ r, what answers there is λ = (1 - F C)⁻¹ F z, and x =
    K⁻¹ (r + λ): Woodbury's formula.

    Parameters
    ----------
    solve : callable
        Solves K x = r for nodal forces (n, 2).
    flexibility : ndarray, shape (2k, 2k)
        C.
    response : LoadResponse

    Raises
    ------
    LinearSolverError
        If the system is singular.
    """

    def __init__(self, solve: Callable[[Array], Array], flexibility: Array, response: LoadResponse) -> None:
        self._solve, self._response = solve, response
        A = -response.matrix @ flexibility
        A[np.diag_indices_from(A)] += 1.0
        if not np.isfinite(A).all():
            raise LinearSolverError("the response of the load is not finite.", "diverged")
        self._lu, self._pivots, info = lapack.dgetrf(A, overwrite_a=True)
        if info:
            raise LinearSolverError("the solid and the response of its load are singular together.", "singular")

    def solve(self, force: Array) -> Array:
        """x, shape (n, 2), for nodal forces r, shape (n, 2)."""
        nodes = self._response.nodes
        free = self._response.of(self._solve(force)[nodes])
        answer = lapack.dgetrs(self._lu, self._pivots, free.ravel())[0].reshape(-1, 2)
        total = force.copy()
        total[nodes] += answer
        return self._solve(total)
