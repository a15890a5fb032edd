"""Gradings as a scene states them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hoblock.expressions import Expression
from hoblock.scene.paths import Path

__all__ = ["GradingKind", "GradingScene", "GradingValue"]

GradingKind = Literal[
    "boundary-layer",
    "cosine",
    "cubic",
    "exponential",
    "function",
    "geometric",
    "list",
    "pieces",
    "quadratic",
    "tanh",
    "uniform",
]
"""How a grading distributes elements."""

GradingValue = float | str | tuple[float, ...] | tuple[int, ...] | Expression
"""What a key of a grading may hold; expressions are in ``s``."""


@dataclass(frozen=True)
class GradingScene:
    """One ``[[mesh.grading]]``: the distribution of elements along the single edges of some paths.

    Attributes
    ----------
    on : tuple of Path
        The paths, in their direction.
    kind : str
    values : mapping of str to value
        The keys of its kind that the scene gives, named as in the scene; numbers are checked against their limits.
    place : str
        Where it stands in the scene.
    """

    on: tuple[Path, ...]
    kind: GradingKind
    values: Mapping[str, GradingValue]
    place: str
