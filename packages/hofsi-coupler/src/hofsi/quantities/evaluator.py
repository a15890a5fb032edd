"""Quantities as functions of a finished step."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from hofsi.records import State, StepRecord

Array = NDArray[np.float64]

__all__ = ["Evaluator", "VectorEvaluator", "component_of", "kept", "scaled"]

Evaluator: TypeAlias = Callable[[StepRecord], float]
"""A quantity as a function of a finished step; nan where it does not exist then."""

VectorEvaluator: TypeAlias = Callable[[StepRecord], Array]
"""A vector, shape (2,), as a function of a finished step."""


def component_of(vector: VectorEvaluator, component: str) -> Evaluator:
    """Return the component "x" or "y" of a vector, or its "magnitude"."""
    if component == "magnitude":
        return lambda record: float(np.hypot(*vector(record)))
    axis = "xy".index(component)
    return lambda record: float(vector(record)[axis])


def scaled(evaluate: Evaluator, factor: float) -> Evaluator:
    """Return a quantity times a factor."""
    return lambda record: factor * evaluate(record)


def kept(evaluate: VectorEvaluator) -> VectorEvaluator:
    """Return a vector that is evaluated once a state, however many quantities ask for it."""
    last: tuple[State, Array] | None = None

    def vector(record: StepRecord) -> Array:
        nonlocal last
        if last is None or last[0] is not record.state:
            last = (record.state, evaluate(record))
        return last[1]

    return vector
