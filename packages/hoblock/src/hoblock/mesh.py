"""Meshes of quadrilateral elements of one order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from hoblock.frozen_mappings import FrozenMappings
from hoblock.numbering import corner_nodes, side_nodes

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["QuadMesh"]


@dataclass(frozen=True, eq=False)
class QuadMesh(FrozenMappings):
    """Elements of order p with (p + 1)² GLL nodes each.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Node positions, read-only.
    cells : ndarray, shape (e, (p + 1)²)
        Nodes of each element, lexicographic (see docs/conventions.md).
    order : int
    cell_groups : mapping of str to ndarray
        Named elements.
    edge_groups : mapping of str to ndarray, shape (k, 2)
        Named element sides: (element, side).
    """

    points: Array
    cells: Index
    order: int
    cell_groups: Mapping[str, Index]
    edge_groups: Mapping[str, Index]

    def __post_init__(self) -> None:
        points = self.points.view()
        points.setflags(write=False)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", _read_only(self.cells))
        for name in ("cell_groups", "edge_groups"):
            groups = getattr(self, name)
            if not isinstance(groups, MappingProxyType):
                kept = {key: _read_only(members) for key, members in groups.items()}
                object.__setattr__(self, name, MappingProxyType(kept))

    @property
    def corners(self) -> Index:
        """Corner nodes of each element, counter-clockwise, shape (e, 4)."""
        return self.cells[:, corner_nodes(self.order)]

    @property
    def coordinates(self) -> Array:
        """Node positions element by element, shape (e, (p + 1)², 2)."""
        return self.points[self.cells]

    def with_points(self, points: Array) -> QuadMesh:
        """Return the mesh with other node positions; connectivity and names are shared.

        Raises
        ------
        ValueError
            If the shape differs.
        """
        if points.shape != self.points.shape:
            raise ValueError(f"with_points: shape {points.shape}; expected {self.points.shape}.")
        return replace(self, points=points)

    def edge_nodes(self, name: str) -> Index:
        """Nodes on a named group of element sides, ascending, each once."""
        sides = self.edge_groups[name]
        return np.unique(self.cells[sides[:, 0, None], side_nodes(self.order)[sides[:, 1]]])


def _read_only(array: Index) -> Index:
    """Return the array if it is read-only, else a view of it that is; the caller's array stays as it was."""
    if not array.flags.writeable:
        return array
    view = array.view()
    view.setflags(write=False)
    return view
