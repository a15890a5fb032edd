"""Roots of many functions of one variable at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["bracketed_newton"]

_ITERATIONS = 200  # bisection of any bracket of double numbers down to round-off takes far fewer


def bracketed_newton(
    evaluate: Callable[[Index, Array], tuple[Array, Array]], low: Array, high: Array, start: Array, tolerance: float
) -> Array:
    """Find a root in each of many brackets by Newton's method, safeguarded by bisection.

    A step that leaves its bracket, or is not at most half as long as the one before, is replaced by a bisection.

    Parameters
    ----------
    evaluate : callable
        Takes the numbers of some of the functions, (k,), and an argument for each; returns their values and
        derivatives, each (k,). Derivatives need not be exact.
    low, high : ndarray, shape (n,)
        Brackets: no function is positive at ``low``, none is negative at ``high``.
    start : ndarray, shape (n,)
        First guesses, inside the brackets.
    tolerance : float
        Of the last step.

    Returns
    -------
    ndarray, shape (n,)

    References
    ----------
    Press, Teukolsky, Vetterling, Flannery: Numerical Recipes, 3rd ed., Cambridge 2007, Section 9.4 (``rtsafe``).
    """
    low, high, root = low.copy(), high.copy(), start.copy()
    length = high - low
    active = np.arange(len(root))
    for _ in range(_ITERATIONS):
        if not active.size:
            break
        s = root[active]
        value, slope = evaluate(active, s)
        low[active] = np.where(value <= 0.0, s, low[active])
        high[active] = np.where(value >= 0.0, s, high[active])
        a, b = low[active], high[active]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            new = s - value / slope
            usable = (a <= new) & (new <= b) & (np.abs(new - s) <= 0.5 * length[active])
        new = np.where(usable, new, 0.5 * (a + b))
        length[active] = np.abs(new - s)
        root[active] = new
        active = active[length[active] > tolerance]
    return root
