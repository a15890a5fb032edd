"""Newton's method for energies with a barrier: steps that never leave the valid side, or come back to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["Energy", "Minimum", "minimise", "solve_positive", "untangle"]

_SUFFICIENT = 1e-4
"""Share of the predicted decrease that a step must reach (Armijo)."""
_ROUNDING = 1e-14
"""Noise of the energy, a mean of numbers of order 1."""
_QUADRATIC = 1e-11
"""Predicted decrease below which full steps converge and rounding hides the decrease."""
_SHORTEST = 1e-10
"""Fraction of a step below which a line search gives up."""
_NEAR = 1e-3
"""Predicted decrease, relative to the energy, below which a stationary point that is no minimum is followed."""
_EPSILONS = 40
"""How often the regularisation of the barrier is halved before an inverted start is given up."""
_STEPS_A_HALVING = 8


class Energy(Protocol):
    """A function of unknowns y, finite for ε > 0, infinite beyond the barrier for ε = 0."""

    def value(self, y: Array, epsilon: float) -> tuple[float, float]:
        """Energy, and the distance from the barrier: positive on the valid side."""
        ...

    def derivatives(self, y: Array, epsilon: float, convex: bool) -> tuple[float, Array, Any]:
        """Energy, gradient and Hessian, or a positive semidefinite matrix in its place."""
        ...


@dataclass(frozen=True, eq=False)
class Minimum:
    """What a minimisation found.

    Attributes
    ----------
    y : ndarray
    iterations : int
        Newton steps, each with one factorisation.
    converged : bool
    strict : bool
        Whether the Hessian is positive definite there. If not, the energy has a saddle, which is followed as long as it
        is regular: where a symmetric problem loses its symmetric minimum, the symmetric saddle is the better mesh.
    """

    y: Array
    iterations: int
    converged: bool
    strict: bool = True


def minimise(energy: Energy, y: Array, epsilon: float, *, length: float, iterations: int, tolerance: float) -> Minimum:
    """Minimise from a valid start, or from any for ε > 0.

    The Hessian is exact where it is positive definite and projected elsewhere. A full step shorter than ``tolerance``
    times ``length`` is the last one: the error after it is that squared.

    Parameters
    ----------
    energy : Energy
    y : ndarray
        Start.
    epsilon : float
    length : float
        A length of the problem.
    iterations : int
        Largest number of steps.
    tolerance : float
    """
    for iteration in range(1, iterations + 1):
        value, gradient, hessian = energy.derivatives(y, epsilon, False)
        step = solve_positive(hessian, -gradient)
        exact = step is not None
        if step is None:
            value, gradient, hessian = energy.derivatives(y, epsilon, True)
            step = solve_positive(hessian, -gradient, regularised=True)
        if step is None or not np.isfinite(step).all():
            return Minimum(y, iteration, False)
        slope = float(gradient @ step)
        if not exact and -slope <= _NEAR * abs(value):
            saddle = _saddle_step(energy, y, epsilon, gradient)
            if saddle is not None:
                y = y + saddle
                if np.abs(saddle).max() <= tolerance * length:
                    return Minimum(y, iteration, True, False)
                continue
        last = exact and np.abs(step).max() <= tolerance * length
        if last:
            return Minimum(y + step, iteration, True)
        settled = exact and -slope <= _QUADRATIC
        fraction = _line_search(energy, y, step, epsilon, value, slope, settled)
        if fraction is None:
            return Minimum(y, iteration, -slope <= _ROUNDING)
        y = y + fraction * step
    return Minimum(y, iterations, False)


def _saddle_step(energy: Energy, y: Array, epsilon: float, gradient: Array) -> Array | None:
    """Newton's step to a stationary point of any kind; None unless it is valid and halves the gradient."""
    hessian = energy.derivatives(y, epsilon, False)[2]
    step = _solve_regular(hessian, -gradient)
    if step is None or not np.isfinite(step).all() or not energy.value(y + step, epsilon)[1] > 0.0:
        return None
    new = energy.derivatives(y + step, epsilon, False)[1]
    return step if np.linalg.norm(new) <= 0.5 * np.linalg.norm(gradient) + _ROUNDING else None


def _line_search(
    energy: Energy, y: Array, step: Array, epsilon: float, value: float, slope: float, settled: bool
) -> float | None:
    """Largest of 1, 1/2, 1/4, … of a step that stays valid and lowers the energy; None if there is none."""
    fraction = 1.0
    while fraction > _SHORTEST:
        new, distance = energy.value(y + fraction * step, epsilon)
        valid = epsilon > 0.0 or distance > 0.0
        lower = new <= value + _SUFFICIENT * fraction * slope + _ROUNDING * (1.0 + abs(value))
        if valid and (lower or settled):
            return fraction
        fraction *= 0.5
    return None


def untangle(energy: Energy, y: Array, *, length: float, tolerance: float) -> Minimum:
    """Move from any start to a valid one: minimise for ε = 1, ½, ¼, … until the result is valid.

    References
    ----------
    Garanzha et al., ACM Trans. Graph. 40 (2021) 102, doi:10.1145/3450626.3459847, with a simpler rule for ε.
    """
    epsilon, total = 1.0, 0
    for _ in range(_EPSILONS):
        found = minimise(energy, y, epsilon, length=length, iterations=_STEPS_A_HALVING, tolerance=tolerance)
        total += found.iterations
        y = found.y
        if energy.value(y, 0.0)[1] > 0.0:
            return Minimum(y, total, True)
        epsilon *= 0.5
    return Minimum(y, total, False)


def solve_positive(matrix: Any, right: Array, *, regularised: bool = False) -> Array | None:
    """Solve with a symmetric matrix, dense or sparse; None if it is not positive definite.

    ``regularised`` adds a little to the diagonal, enough to make a positive semidefinite matrix definite.
    """
    if isinstance(matrix, np.ndarray):
        return _solve_dense(matrix, right, regularised)
    return _solve_sparse(matrix, right, regularised)


def _solve_dense(matrix: Array, right: Array, regularised: bool) -> Array | None:
    from scipy.linalg import lapack

    if regularised:
        matrix = matrix.copy()
        matrix[np.diag_indices(len(matrix))] += 1e-10 * np.trace(matrix) / len(matrix)
    factor, failed = lapack.dpotrf(matrix, lower=1)
    if failed:
        return None
    return np.asarray(lapack.dpotrs(factor, right, lower=1)[0])


def _solve_regular(matrix: Any, right: Array) -> Array | None:
    """Solve with a symmetric matrix, dense or sparse; None if it is singular."""
    from scipy.sparse.linalg import splu

    try:
        if isinstance(matrix, np.ndarray):
            return np.asarray(np.linalg.solve(matrix, right))
        return np.asarray(splu(matrix.tocsc()).solve(right))
    except (np.linalg.LinAlgError, RuntimeError):
        return None


def _solve_sparse(matrix: Any, right: Array, regularised: bool) -> Array | None:
    from scipy.sparse import identity
    from scipy.sparse.linalg import splu

    matrix = matrix.tocsc()
    if regularised:
        matrix = matrix + (1e-10 * matrix.diagonal().mean()) * identity(matrix.shape[0], format="csc")
    try:
        factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:  # exactly singular
        return None
    # Without row exchanges the signs of the pivots are those of the eigenvalues (Sylvester's law of inertia).
    if not (factor.U.diagonal() > 0.0).all():
        return None
    return np.asarray(factor.solve(right))
