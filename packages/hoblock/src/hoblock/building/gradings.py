"""From the gradings of a scene to those of block edges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.building.paths import at, edge_pairs, take
from hoblock.expressions import Expression
from hoblock.grading import (
    BoundaryLayer,
    Cosine,
    Cubic,
    EdgeGrading,
    Exponential,
    Function,
    Geometric,
    Grading,
    Listed,
    Pieces,
    Quadratic,
    Tanh,
    TanhSpacing,
    Uniform,
)
from hoblock.scene import GradingScene
from hoblock.scene.gradings import GradingKind

Array = NDArray[np.float64]
Ends = tuple[str | int, str | int]

__all__ = ["build_gradings"]


def build_gradings(entries: tuple[GradingScene, ...], sides: set[frozenset[str]]) -> dict[Ends, Grading | EdgeGrading]:
    """Gradings of single edges; ``sides`` are the block edges there are."""
    places: dict[frozenset[str], str] = {}
    gradings: dict[Ends, Grading | EdgeGrading] = {}
    for entry in entries:
        with at(entry.place):
            grading = _GRADINGS[entry.kind](**entry.values)
        for pair in edge_pairs(entry.on, sides, entry.place):
            take(places, pair, entry.place, "grading")
            gradings[pair] = grading
    return gradings


@dataclass(frozen=True)
class _Formula:
    """An expression in ``s`` as a function; equal wherever it stands in the scene."""

    program: tuple[Any, ...]
    expression: Expression = field(compare=False)

    def __call__(self, s: Array) -> Array:
        return self.expression.evaluate(s=s)


def _function(value: Expression) -> Function:
    return Function(_Formula(value.program, value))


def _listed(positions: tuple[float, ...] = (), sizes: tuple[float, ...] = ()) -> Listed:
    return Listed(positions) if positions else Listed.of_sizes(sizes)


def _tanh(**values: Any) -> Tanh | TanhSpacing:
    return Tanh(**values) if "strength" in values else TanhSpacing(**values)


_GRADINGS: dict[GradingKind, Callable[..., Grading | EdgeGrading]] = {
    "boundary-layer": BoundaryLayer,
    "cosine": Cosine,
    "cubic": Cubic,
    "exponential": Exponential,
    "function": _function,
    "geometric": Geometric,
    "list": _listed,
    "pieces": Pieces,
    "quadratic": Quadratic,
    "tanh": _tanh,
    "uniform": Uniform,
}
