"""LU factors of one matrix that solve with a later one: as the preconditioner of GMRES, as long as that is cheap."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hofsi.linear.checked import CheckedSolver

__all__ = ["LaggedSolver"]

Array = NDArray[np.float64]

_SLACK = 2.0  # of the goal, for a residual that GMRES estimates and that is computed here


class LaggedSolver:
    """Solves with a matrix by GMRES, preconditioned from the right by the factors of an earlier one.

    If that takes more than some iterations the matrix is factorised after all, once.

    Parameters
    ----------
    product : callable
        v ↦ A v on vectors of shape (n,).
    factor : CheckedSolver
        Of the earlier matrix.
    factorise : callable
        Makes factors of this one.
    goal : float
        A solution ends when ‖b - A x‖ is at most that.
    limit : int
        Iterations at most.

    Attributes
    ----------
    factor : CheckedSolver
        The earlier factors, or those of this matrix once they have been made.
    renewed : bool
        Whether they have been.
    iterations : int
        Of all solutions so far.

    References
    ----------
    Saad: Iterative Methods for Sparse Linear Systems, SIAM 2003, doi:10.1137/1.9780898718003, Section 9.3.2.
    """

    def __init__(
        self,
        product: Callable[[Array], Array],
        factor: CheckedSolver,
        factorise: Callable[[], CheckedSolver],
        goal: float,
        limit: int,
    ) -> None:
        self._product, self._factorise, self._goal, self._limit = product, factorise, goal, limit
        self.factor = factor
        self.renewed = False
        self.iterations = 0

    def solve(self, b: Array, /) -> Array:
        """Solve A x = b.

        Raises
        ------
        LinearSolverError
            If the matrix had to be factorised and is singular.
        """
        if not self.renewed:
            x = self._iterate(b)
            if x is not None:
                return x
            self.factor, self.renewed = self._factorise(), True
        return self.factor.solve(b)

    def _iterate(self, b: Array) -> Array | None:
        """Solution by GMRES, None if the limit is not enough."""
        size = float(np.linalg.norm(b))
        if size == 0.0 or not np.isfinite(size):
            return np.zeros_like(b) if size == 0.0 else None
        x, count = _gmres(self._product, self.factor.substitute, b, self._goal, self._limit)
        self.iterations += count
        return x if np.linalg.norm(b - self._product(x)) <= _SLACK * self._goal else None


def _gmres(
    product: Callable[[Array], Array], precondition: Callable[[Array], Array], b: Array, goal: float, limit: int
) -> tuple[Array, int]:
    """One cycle from zero until the residual is at most the goal, and its number of iterations.

    What the preconditioner makes of the basis is kept, so that the solution takes no further call of it.
    """
    V, Z = [b / np.linalg.norm(b)], []
    H = np.zeros((limit + 1, limit))
    right = np.zeros(limit + 1)
    right[0] = np.linalg.norm(b)
    y: Array = np.zeros(0)
    for k in range(limit):
        Z.append(precondition(V[k]))
        w = product(Z[k])
        size = np.linalg.norm(w)
        for _ in range(2):  # once more where most of it cancels
            basis = np.array(V)
            h = basis @ w
            w -= h @ basis
            H[: k + 1, k] += h
            if np.linalg.norm(w) > 0.5 * size:
                break
        H[k + 1, k] = np.linalg.norm(w)
        y = np.asarray(np.linalg.lstsq(H[: k + 2, : k + 1], right[: k + 2], rcond=None)[0], dtype=float)
        residual = np.linalg.norm(right[: k + 2] - H[: k + 2, : k + 1] @ y)
        if residual <= goal or H[k + 1, k] <= np.finfo(float).eps * size:
            break
        V.append(w / H[k + 1, k])
    return np.array(Z).T @ y, len(Z)
