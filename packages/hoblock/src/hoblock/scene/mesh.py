"""The ``[mesh]`` part of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hoblock.orders import HIGHEST_ORDER
from hoblock.scene.curves import CurveScene
from hoblock.scene.gradings import GradingScene
from hoblock.scene.paths import Path, Quad
from hoblock.scene.quads import QuadsScene
from hoblock.scene.template import TemplateScene

__all__ = ["HIGHEST_ORDER", "CountScene", "MeshScene"]


@dataclass(frozen=True)
class CountScene:
    """One ``[[mesh.count]]``: the number of elements on every chain with an edge of some paths."""

    on: tuple[Path, ...]
    elements: int
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
    template : TemplateScene or None
        Where vertices, blocks and some of the named edges come from; it has curves, numbers of elements and
        distributions of its own, which those of the scene replace.
    quads : QuadsScene or None
        The elements of a mesh file, from which vertices, blocks and some of the named edges come; it may have curves.
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
    template: TemplateScene | None = None
    quads: QuadsScene | None = None
