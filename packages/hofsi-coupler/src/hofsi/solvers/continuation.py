"""Continuation: a nonlinear problem that Newton's method does not solve at once is approached from an easier one."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from hofsi.errors import LinearSolverError, NewtonError

Array = NDArray[np.float64]
Solve: TypeAlias = Callable[[Array, float], Array]

__all__ = ["approach"]

_FIRST = 0.1
_SMALLEST = 5e-3
_FASTER = 2.0  # factor of the step after a success


def approach(solve: Solve, start: Array, failure: NewtonError | LinearSolverError, done: str) -> Array:
    """Raise a share from 0, the easy problem, to 1, the one that is asked for.

    Every step starts from the straight line through the last two solutions. A step that fails is halved, the one after
    a success is doubled.

    Parameters
    ----------
    solve : callable
        (unknowns to start from, share) → unknowns; raises NewtonError or LinearSolverError if it fails.
    start : ndarray
        To start the easy problem from.
    failure : NewtonError or LinearSolverError
        Of the attempt to solve all at once, raised again if this fails too.
    done : str
        What the share is of, for the message: "of the convection".

    Raises
    ------
    NewtonError, LinearSolverError
        If a step of a hundredth fails.

    References
    ----------
    Allgower, Georg: Introduction to Numerical Continuation Methods, SIAM 2003, doi:10.1137/1.9780898719154, Section 2.
    """
    try:
        solution = solve(start, 0.0)
    except (NewtonError, LinearSolverError):
        raise failure from None
    share, slope, step = 0.0, np.zeros_like(start), _FIRST
    while share < 1.0:
        reached = share + step if share + step < 1.0 - _SMALLEST else 1.0
        try:
            following = solve(solution + (reached - share) * slope, reached)
        except (NewtonError, LinearSolverError) as error:
            step = 0.5 * (reached - share)
            if step < _SMALLEST:
                raise type(failure)(
                    f"{failure.problem} Approached little by little, {share:.3g} {done} was reached.",
                    failure.reason,
                    failure.where,
                ) from error
            continue
        slope = (following - solution) / (reached - share)
        solution, share, step = following, reached, _FASTER * (reached - share)
    return solution
