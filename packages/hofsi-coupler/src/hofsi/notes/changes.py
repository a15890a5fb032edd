"""Expressions that change faster than the time steps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hoblock.errors import ExpressionError
from hoblock.expressions import Expression
from hofsi.case import Case, Unsteady
from hofsi.case_checks import expressions

__all__ = ["fast_changes"]

_STEPS = 200  # first steps that are looked at
_BETWEEN = 8  # places in each, at odd distances
_FAR = 0.2  # of an expression's range: departure from a straight line within a step that is not resolved
_MANY = 0.2  # of the steps: a single jump, such as an inflow that is switched on, is nobody's mistake


def fast_changes(case: Case, time: Unsteady) -> Iterator[str]:
    """Say which expressions of t depart from a straight line within the steps: their steps are too large.

    They are looked at in one place; one that is not defined there or then is left out.
    """
    steps = min(time.steps, _STEPS)
    ends = np.array([time.start, *(time.step(k)[0] for k in range(1, steps + 1))])
    shares = (np.arange(_BETWEEN) + 0.37) / _BETWEEN
    x, y = np.mean(list(case.mesh.vertices.values()), axis=0) if case.mesh.vertices else (0.37, 0.41)
    for expression in expressions(case):
        if "t" not in expression.variables_used:
            continue
        try:
            far = _departures(expression, ends, shares, float(x), float(y))
        except ExpressionError:
            continue
        if far.mean() > _MANY:
            yield (
                f'{expression.place}: "{expression.text}" changes within the time steps of {time.dt:g}: in '
                f"{100.0 * far.mean():.0f} % of them it is not near a straight line. Take smaller steps, about 50 for "
                "each of its periods"
            )


def _departures(expression: Expression, ends: np.ndarray, shares: np.ndarray, x: float, y: float) -> np.ndarray:
    """Whether an expression departs from the straight line between the ends of each step, shape (k,)."""
    at = ends[:-1, None] + shares * np.diff(ends)[:, None]
    known = {name: value for name, value in (("x", x), ("y", y)) if name in expression.variables_used}
    first = expression.evaluate(t=ends, **{name: np.full(ends.shape, value) for name, value in known.items()})
    inside = expression.evaluate(t=at, **{name: np.full(at.shape, value) for name, value in known.items()})
    line = first[:-1, None] + shares * np.diff(first)[:, None]
    span = float(max(inside.max(), first.max()) - min(inside.min(), first.min()))
    if span == 0.0:
        return np.zeros(len(at), dtype=bool)
    return np.asarray(np.abs(inside - line).max(axis=1) > _FAR * span)
