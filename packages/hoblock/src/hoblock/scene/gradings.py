"""Gradings as a scene states them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hoblock.scene.paths import Path

__all__ = ["GradingScene"]


@dataclass(frozen=True)
class GradingScene:
    """One ``[[mesh.grading]]``: the distribution of elements along the single edges of some paths.

    Attributes
    ----------
    on : tuple of Path
        The paths, in their direction.
    kind : str
        ``"uniform"``, ``"quadratic"``, ``"cubic"`` or ``"exponential"``.
    parameter : float
        m of quadratic (-1 < m < 1) and cubic (0 <= m < 1), a of exponential (-50 <= a <= 50), 0 of uniform.
    place : str
        Where it stands in the scene.
    """

    on: tuple[Path, ...]
    kind: Literal["uniform", "quadratic", "cubic", "exponential"]
    parameter: float
    place: str
