"""Block-triangular preconditioner of saddle-point systems with the least-squares commutator."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hofsi.linear.direct import DirectFactor
from hofsi.linear.krylov import conjugate_gradients
from hofsi.linear.solver import Solver

__all__ = ["BlockTriangular", "LeastSquaresCommutator", "ScaledLaplacian"]

Array = NDArray[np.float64]
Operator: TypeAlias = Callable[[Array], Array]

_TOLERANCE = 1e-2  # of the Laplacian's residual: less costs outer iterations, more inner ones
_LIMIT = 30


class ScaledLaplacian:
    """The matrix L = B D⁻¹ Bᵀ, and solutions with it: by LU factors, or if it is large rough ones by iteration.

    Parameters
    ----------
    B : csr_matrix, shape (m, n)
        Minus the divergence.
    scaling : ndarray, shape (n,)
        D, the diagonal of the velocity's mass matrix.
    approximate : callable
        Makes an approximate, symmetric inverse of L for the iteration.
    factorise_up_to : int
        Largest m for which L is factorised.
    """

    def __init__(
        self,
        B: sp.csr_matrix,
        scaling: Array,
        approximate: Callable[[sp.csr_matrix], Solver],
        *,
        factorise_up_to: int = 30_000,
    ) -> None:
        self.B, self.BT, self.scaling = B, B.T.tocsr(), scaling
        self._L = (B @ sp.diags(1.0 / scaling) @ self.BT).tocsr()
        self.factorised = B.shape[0] <= factorise_up_to
        self._inverse: Solver = DirectFactor(self._L.tocsc()) if self.factorised else approximate(self._L)

    def solve(self, r: Array, /) -> Array:
        """Solve L x = r, to two digits if iteratively."""
        if self.factorised:
            return self._inverse.solve(r)
        return conjugate_gradients(self._L.__matmul__, self._inverse.solve, r, _TOLERANCE, _LIMIT)


class LeastSquaresCommutator:
    """Approximation to the inverse of the Schur complement -B F⁻¹ Bᵀ: -L⁻¹ (B D⁻¹ F D⁻¹ Bᵀ) L⁻¹.

    Parameters
    ----------
    F : callable
        v ↦ F v, of the velocity unknowns.
    laplacian : ScaledLaplacian

    References
    ----------
    Elman, Howle, Shadid, Shuttleworth, Tuminaro, SIAM J. Sci. Comput. 27 (2006) 1651–1668, doi:10.1137/040608817.
    """

    def __init__(self, F: Operator, laplacian: ScaledLaplacian) -> None:
        self._F, self._laplacian = F, laplacian

    def solve(self, r: Array, /) -> Array:
        """Approximate the pressure p in -B F⁻¹ Bᵀ p = r."""
        laplacian = self._laplacian
        v = self._F((laplacian.BT @ laplacian.solve(r)) / laplacian.scaling)
        return -laplacian.solve(laplacian.B @ (v / laplacian.scaling))


class BlockTriangular:
    """Approximate inverse of [[F, Bᵀ], [B, 0]]: that of [[F, Bᵀ], [0, S]], S the Schur complement.

    Parameters
    ----------
    velocity : Solver
        Approximate inverse of F.
    pressure : Solver
        Approximate inverse of S.
    BT : csr_matrix, shape (n, m)

    References
    ----------
    Elman, Silvester, Wathen: Finite Elements and Fast Iterative Solvers, Oxford 2014, Section 9.1.
    """

    def __init__(self, velocity: Solver, pressure: Solver, BT: sp.csr_matrix) -> None:
        self._velocity, self._pressure, self._BT = velocity, pressure, BT

    def solve(self, r: Array, /) -> Array:
        """Approximate the solution for a right-hand side (velocity, pressure)."""
        n = self._BT.shape[0]
        p = self._pressure.solve(r[n:])
        return np.concatenate([self._velocity.solve(r[:n] - self._BT @ p), p])
