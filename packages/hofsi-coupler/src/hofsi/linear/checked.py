"""Direct solutions that are not taken on trust: residual, refinement, and a way out if both do not help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hofsi.errors import LinearSolverError

Array = NDArray[np.float64]

__all__ = ["CheckedSolver", "Factor"]

_REFINE = 1e-12
_ACCEPT = 1e-8
_ROUNDING = 1e-14  # of |A| |x|: what the best factors leave; more than _ACCEPT |b| if the matrix is ill-conditioned
_WORST = 1e-3  # of |b|: whatever the condition, a solution worse than this is none


class Factor(Protocol):
    """Factors of a matrix, together with the matrix."""

    @property
    def entries(self) -> int:
        """Number of entries of the factors."""
        ...

    def substitute(self, b: Array) -> Array:
        """Solve once, as well as the factors can."""
        ...

    def product(self, x: Array) -> Array:
        """The matrix times a vector."""
        ...

    def norm(self) -> float:
        """A bound of the largest sum of absolute values of a row."""
        ...


class CheckedSolver:
    """Solves with factors; a solution whose residual is not small is refined once.

    If that does not help either, other factors take the place of the first. Small is 1e-8 of the right-hand side, or
    what rounding leaves if the matrix is ill-conditioned, as those of thin plates are.

    Parameters
    ----------
    factor : Factor
    fallback : callable, optional
        Makes slower and safer factors of the same matrix.

    Attributes
    ----------
    fell_back : bool
        Whether the fallback has been used.
    """

    def __init__(self, factor: Factor, fallback: Callable[[], Factor] | None = None) -> None:
        self._factor, self._fallback = factor, fallback
        self.fell_back = False

    @property
    def factor(self) -> Factor:
        """The factors at hand."""
        return self._factor

    @property
    def entries(self) -> int:
        """Number of entries of the factors."""
        return self._factor.entries

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
        if not self._acceptable(x, residual, size) and self._fallback is not None:
            self.fall_back()
            x, residual = self._refined(b, size)
        if not self._acceptable(x, residual, size):
            raise LinearSolverError(
                f"relative residual {residual:.2g} after LU with full pivoting; expected below "
                f"{_ACCEPT:g}. The matrix is close to singular: a boundary condition may be missing, or a body be so "
                "thin, or its elements so flat, that double precision does not tell its bending from rounding."
            )
        return x

    def fall_back(self) -> None:
        """Take the fallback's factors from now on, unless it has happened or there are none."""
        if self._fallback is not None:
            self._factor, self._fallback, self.fell_back = self._fallback(), None, True

    def substitute(self, b: Array) -> Array:
        """Solve once, as well as the factors can, without a look at the residual: for preconditioning."""
        return self._factor.substitute(b)

    def _acceptable(self, x: Array, residual: float, size: float) -> bool:
        if residual <= _ACCEPT:
            return True
        rounding = _ROUNDING * self._factor.norm() * float(np.abs(x).max()) / size
        return residual <= min(_WORST, rounding)

    def _refined(self, b: Array, size: float) -> tuple[Array, float]:
        with np.errstate(invalid="ignore", over="ignore"):  # poor pivots may give anything; the residual tells
            x = self._factor.substitute(b)
            r = b - self._factor.product(x)
            residual = float(np.abs(r).max()) / size
            if residual > _REFINE:
                better = x + self._factor.substitute(r)
                refined = float(np.abs(b - self._factor.product(better)).max()) / size
                if refined < residual:
                    return better, refined
        return x, residual if np.isfinite(residual) else np.inf
