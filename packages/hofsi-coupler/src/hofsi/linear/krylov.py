"""Iterative solvers of pyamg behind one contract: the residual is checked, failure raises."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from hofsi.counts import Counts
from hofsi.errors import LinearSolverError
from hofsi.linear.extra import pyamg_module
from hofsi.linear.solver import Solver

__all__ = ["KrylovSolver", "flexible_gmres"]

Array = NDArray[np.float64]
Operator: TypeAlias = Callable[[Array], Array]

_SLACK = 1.01  # of the tolerance, for the rounding of a residual that is computed twice
_ROUNDING = 1e-14  # of ‖A‖ ‖x‖: below that a residual is rounding
_WORST = 1e-3  # of ‖b‖: whatever the condition, a solution worse than this is none


def flexible_gmres(
    multiply: Operator,
    precondition: Operator,
    b: Array,
    tolerance: float,
    *,
    size: float = 0.0,
    restart: int = 60,
    cycles: int = 5,
) -> tuple[Array, int]:
    """Solve A x = b by FGMRES, with a preconditioner from the right that may change from iteration to iteration.

    Parameters
    ----------
    multiply, precondition : callable
        v ↦ A v and v ↦ M v with M ≈ A⁻¹, on vectors of shape (n,).
    b : ndarray, shape (n,)
    tolerance : float
        The iteration ends when ‖b - A x‖ ≤ tolerance · ‖b‖.
    size : float
        ‖A‖, if a residual of the size of the rounding error of A x is to be accepted; matrices of thin plates leave no
        smaller one.
    restart : int
        Iterations until the basis is given up.
    cycles : int
        Restarts and the first start.

    Returns
    -------
    x : ndarray, shape (n,)
    iterations : int

    Raises
    ------
    LinearSolverError
        If ‖b - A x‖, computed from x, is larger than both.

    References
    ----------
    Saad, SIAM J. Sci. Comput. 14 (1993) 461–469, doi:10.1137/0914028.
    """
    norm = float(np.linalg.norm(b))
    if norm == 0.0:
        return np.zeros(len(b)), 0
    if not np.isfinite(norm):
        raise LinearSolverError("the right-hand side is not finite.", "diverged")
    calls = _Counted(precondition)
    A, M = _operator(multiply, len(b)), _operator(calls, len(b))
    # It sets warning filters of its own, for the whole process, and warns of what is checked here.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            x, _ = pyamg_module("pyamg.krylov").fgmres(
                A, b, tol=tolerance, restart=min(restart, len(b)), maxiter=cycles, M=M
            )
        except (np.linalg.LinAlgError, ValueError) as error:
            problem = f"FGMRES broke down after {calls.count} iterations ({error})."
            raise LinearSolverError(problem, "diverged") from error
    residual = float(np.linalg.norm(b - multiply(x))) / norm
    rounding = min(_WORST, _ROUNDING * size * float(np.linalg.norm(x)) / norm)
    if not residual <= max(_SLACK * tolerance, rounding):
        raise LinearSolverError(
            f"FGMRES left a relative residual of {residual:.2g} after {calls.count} iterations on {len(b)} unknowns; "
            f"expected {tolerance:.2g} (linear.tolerance). Take smaller time steps, refine the mesh, or use "
            'linear.solver = "direct".',
            "max_iterations",
        )
    return np.asarray(x), calls.count


class KrylovSolver:
    """FGMRES with one matrix and one preconditioner.

    Parameters
    ----------
    matrix : sparse matrix
    preconditioner : Solver
    tolerance : float
        Of the residual, relative to the right-hand side.
    counts : Counts, optional
        Where its iterations are counted.

    Attributes
    ----------
    iterations : int
        Of the last solution.
    """

    def __init__(
        self, matrix: sp.spmatrix, preconditioner: Solver, tolerance: float, counts: Counts | None = None
    ) -> None:
        self._counts = Counts() if counts is None else counts
        self._A, self._preconditioner, self._tolerance = matrix.tocsr(), preconditioner, tolerance
        self._size = float(spla.norm(self._A, np.inf)) if matrix.nnz else 0.0
        self.iterations = 0

    def solve(self, b: Array, /) -> Array:
        """Solve A x = b.

        Raises
        ------
        LinearSolverError
            If neither the tolerance nor what rounding leaves is reached.
        """
        x, self.iterations = flexible_gmres(
            self._A.__matmul__, self._preconditioner.solve, b, self._tolerance, size=self._size
        )
        self._counts.linear_iterations += self.iterations
        return x


class _Counted:
    """An operator that counts its calls."""

    def __init__(self, operator: Operator) -> None:
        self.count = 0
        self._operator = operator

    def __call__(self, v: Array) -> Array:
        self.count += 1
        return self._operator(v)


def _operator(function: Operator, size: int) -> spla.LinearOperator:
    return spla.LinearOperator((size, size), matvec=lambda v: function(np.ravel(v)), dtype=np.float64)
