"""What a scene says about its mesh: plain data, not yet a mesh.

The places (``"mesh.curve[3]"``) tell where in the scene each entry stands, for errors that only show when
the blocks are built.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hoblock.expressions import Expression

__all__ = [
    "HIGHEST_ORDER",
    "ArcAbout",
    "ArcThrough",
    "CountScene",
    "CurveScene",
    "Formula",
    "GradingScene",
    "MeshScene",
    "Path",
    "Quad",
]

HIGHEST_ORDER = 32
"""Highest polynomial order of the elements of a scene."""

Path = tuple[str, ...]
"""A walk along edges from vertex to vertex, by their names."""

Quad = tuple[str, str, str, str]
"""The vertices of a block by name, counter-clockwise."""


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


@dataclass(frozen=True)
class CurveScene:
    """One ``[[mesh.curve]]``: the geometry of the edges along some paths, in the direction of the paths.

    Attributes
    ----------
    on : tuple of Path
        The paths; a name from ``[mesh.edges]`` is already replaced by its paths.
    shape : ArcAbout or ArcThrough or Formula
        The geometry of each single edge.
    place : str
        Where it stands in the scene.
    """

    on: tuple[Path, ...]
    shape: ArcAbout | ArcThrough | Formula
    place: str


@dataclass(frozen=True)
class CountScene:
    """One ``[[mesh.count]]``: the number of elements on every chain with an edge of some paths."""

    on: tuple[Path, ...]
    elements: int
    place: str


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


@dataclass(frozen=True)
class MeshScene:
    """The ``[mesh]`` part of a scene.

    Attributes
    ----------
    order : int
        Polynomial order of the elements, 1 to `HIGHEST_ORDER`.
    vertices : mapping of str to (float, float)
        Block vertices by name.
    blocks : mapping of str to tuple of Quad
        Blocks by group; group ``fluid``, block 2 stands at ``mesh.blocks.fluid[2]``.
    edges : mapping of str to tuple of Path
        Named edges.
    curves : tuple of CurveScene
        Edges that are not straight.
    counts : tuple of CountScene
        Numbers of elements.
    gradings : tuple of GradingScene
        Distributions that are not uniform.
    elements : int
        Number of elements on chains without a count.
    title : str
        One line for people, maybe empty.
    file : str
        Where the scene was read from.
    """

    order: int
    vertices: Mapping[str, tuple[float, float]]
    blocks: Mapping[str, tuple[Quad, ...]]
    edges: Mapping[str, tuple[Path, ...]]
    curves: tuple[CurveScene, ...] = ()
    counts: tuple[CountScene, ...] = ()
    gradings: tuple[GradingScene, ...] = ()
    elements: int = 1
    title: str = ""
    file: str = ""
