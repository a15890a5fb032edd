"""A coarse quad mesh from a file, whose elements are the blocks of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["NodeOrder", "QuadsScene", "Spacing"]

NodeOrder = Literal["gmsh", "vtk", "lexicographic"]
"""Order of the nodes of a quad of order p, see `hoblock.coarse_quads.structure_from_quads`."""

Spacing = Literal["equispaced", "gll"]
"""Where nodes lie along the sides of the reference square."""


@dataclass(frozen=True, eq=False)
class QuadsScene:
    """What a file says about a coarse quad mesh.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
    quads : ndarray, shape (b, m)
        Points of each quad.
    names : tuple of str
        Of the points.
    order : int
        Of the quads.
    node_order, spacing : str
        How ``quads`` lists its nodes, and where they lie.
    block_groups : mapping of str to ndarray
    edge_groups : mapping of str to ndarray, shape (k, 2)
        Pairs of points.
    place : str
        Where the file is named in the scene, or the file itself.
    """

    points: Array
    quads: Index
    names: tuple[str, ...]
    order: int
    node_order: NodeOrder = "gmsh"
    spacing: Spacing = "equispaced"
    block_groups: Mapping[str, Index] = field(default_factory=dict)
    edge_groups: Mapping[str, Index] = field(default_factory=dict)
    place: str = ""
