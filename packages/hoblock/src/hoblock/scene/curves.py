"""Curves as a scene states them."""

from __future__ import annotations

from dataclasses import dataclass

from hoblock.expressions import Expression
from hoblock.scene.paths import Path

__all__ = ["ArcAbout", "ArcThrough", "CurveScene", "Formula", "Shape"]


@dataclass(frozen=True)
class ArcAbout:
    """The shorter circular arc about a centre."""

    center: tuple[float, float]


@dataclass(frozen=True)
class ArcThrough:
    """The circular arc through a third point."""

    point: tuple[float, float]


@dataclass(frozen=True)
class Formula:
    """A parametric curve: x and y as expressions in ``s``, 0 at the first vertex, 1 at the second."""

    x: Expression
    y: Expression


Shape = ArcAbout | ArcThrough | Formula
"""The geometry of an edge, whatever its kind."""


@dataclass(frozen=True)
class CurveScene:
    """One ``[[mesh.curve]]``: the geometry of the edges along some paths, in the direction of the paths.

    Attributes
    ----------
    on : tuple of Path
        The paths; a name from ``[mesh.edges]`` is already replaced by its paths.
    shape : Shape
        The geometry of each single edge.
    place : str
        Where it stands in the scene.
    """

    on: tuple[Path, ...]
    shape: Shape
    place: str
