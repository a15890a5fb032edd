"""The arithmetic of expressions: the functions a scene may call, and logic that lets NaN through.

Everything is a 64-bit float, conditions too (1.0 is true, 0.0 false). A comparison with NaN is NaN, not
false, so that an undefined value cannot vanish inside a condition; only a branch that is not selected
is discarded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

__all__ = ["FUNCTIONS", "Comparison", "Function", "all_of", "any_of", "negation", "power", "select"]

# Scalars and arrays alike; NumPy's scalar and array types have no common name that type checkers accept.
Value = Any


@dataclass(frozen=True)
class Function:
    """A function of an expression: the callable, and how many arguments it takes (``most=None``: any number)."""

    call: Callable[..., Value]
    least: int = 1
    most: int | None = 1


@dataclass(frozen=True)
class Comparison:
    """A chain such as ``a < b <= c``: every neighbouring pair must hold."""

    relations: tuple[Callable[..., Value], ...]

    def __call__(self, *values: Value) -> Value:
        """One more value than relations; 1.0 where all hold, 0.0 where one does not, else NaN."""
        pairs = zip(self.relations, values[:-1], values[1:], strict=True)
        return reduce(all_of, (_compare(relation, a, b) for relation, a, b in pairs))


def all_of(a: Value, b: Value) -> Value:
    """``a and b`` as 0.0 or 1.0; ``b`` counts only where ``a`` holds."""
    return select(a, _truth(b), 0.0)


def any_of(a: Value, b: Value) -> Value:
    """``a or b`` as 0.0 or 1.0; ``b`` counts only where ``a`` does not hold."""
    return select(a, 1.0, _truth(b))


def negation(a: Value) -> Value:
    """``not a`` as 0.0 or 1.0."""
    return select(a, 0.0, 1.0)


def select(condition: Value, a: Value, b: Value) -> Value:
    """Take ``a`` where the condition is not zero, ``b`` where it is zero, NaN where it is NaN."""
    return np.where(np.isnan(condition), np.nan, np.where(np.not_equal(condition, 0.0), a, b))


def power(a: Value, b: Value) -> Value:
    """``a**b``, NaN where either is NaN (IEEE arithmetic says ``nan**0 = 1`` and ``1**nan = 1``)."""
    if np.ndim(b) == 0 and np.isfinite(b) and b != 0.0:
        return np.asarray(a) ** float(b)
    return np.where(np.isnan(a) | np.isnan(b), np.nan, np.power(a, b))


def _truth(a: Value) -> Value:
    return select(a, 1.0, 0.0)


def _compare(relation: Callable[..., Value], a: Value, b: Value) -> Value:
    return np.where(np.isnan(a) | np.isnan(b), np.nan, relation(a, b))


def _minimum(*values: Value) -> Value:
    return reduce(np.minimum, values)


def _maximum(*values: Value) -> Value:
    return reduce(np.maximum, values)


FUNCTIONS: dict[str, Function] = {
    "abs": Function(np.abs),
    "acos": Function(np.arccos),
    "asin": Function(np.arcsin),
    "atan": Function(np.arctan),
    "atan2": Function(np.arctan2, 2, 2),
    "cos": Function(np.cos),
    "cosh": Function(np.cosh),
    "exp": Function(np.exp),
    "floor": Function(np.floor),
    "hypot": Function(np.hypot, 2, 2),
    "log": Function(np.log),
    "max": Function(_maximum, 2, None),
    "min": Function(_minimum, 2, None),
    "sign": Function(np.sign),
    "sin": Function(np.sin),
    "sinh": Function(np.sinh),
    "sqrt": Function(np.sqrt),
    "tan": Function(np.tan),
    "tanh": Function(np.tanh),
    "where": Function(select, 3, 3),
}
