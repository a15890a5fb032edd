"""Driven edges that cross each other or another part of the boundary: why no mesh can be valid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import HoblockError
from hoblock.layout import layout

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BoundaryCrossing", "boundary_crossing"]

_AT_ONCE = 1 << 20


@dataclass(frozen=True)
class BoundaryCrossing:
    """Two edges of the boundary that cross.

    Attributes
    ----------
    first, second : str
        Names of the edges; equal if an edge crosses itself.
    place : tuple of float
    """

    first: str
    second: str
    place: tuple[float, float]

    def __str__(self) -> str:
        x, y = self.place
        if self.first == self.second:
            return f"The driven edge {self.first} crosses itself near ({x:.6g}, {y:.6g})."
        return f"The boundary edges {self.first} and {self.second} cross near ({x:.6g}, {y:.6g})."


def boundary_crossing(structure: BlockStructure, order: int) -> BoundaryCrossing | None:
    """Return the first place where the boundary of a structure crosses itself, as polygons through its nodes.

    Parameters
    ----------
    structure : BlockStructure
        Moved.
    order : int
        Order of the elements whose nodes are the polygons' corners.
    """
    try:
        starts, ends, nodes, edges = _segments(structure, order)
    except HoblockError:
        return None
    step = max(1, _AT_ONCE // max(1, len(starts)))
    for k in range(0, len(starts), step):
        some = np.arange(k, min(k + step, len(starts)))
        hit = _crossing(starts[some, None], ends[some, None], starts[None], ends[None])
        hit &= some[:, None] < np.arange(len(starts))
        hit &= ~(nodes[some, None, :, None] == nodes[None, :, None, :]).any(axis=(2, 3))  # neighbours touch
        if hit.any():
            i, j = np.argwhere(hit)[0]
            a, b = int(some[i]), int(j)
            name = structure.topology.edge_name
            place = 0.25 * (starts[a] + ends[a] + starts[b] + ends[b])
            return BoundaryCrossing(name(int(edges[a])), name(int(edges[b])), (float(place[0]), float(place[1])))
    return None


def _segments(structure: BlockStructure, order: int) -> tuple[Array, Array, Index, Index]:
    """Starts, ends, nodes (k, 2) and edges of the boundary's straight pieces."""
    plan = layout(structure, order)
    starts, ends, nodes, numbers = [], [], [], []
    for edge in np.flatnonzero(structure.topology.blocks_per_edge == 1).tolist():
        points = structure.edge_points(edge, plan.parameters_of_edge(edge))
        starts.append(points[:-1])
        ends.append(points[1:])
        along = plan.nodes_of_edge(edge)
        nodes.append(np.stack([along[:-1], along[1:]], axis=-1))
        numbers.append(np.full(len(points) - 1, edge))
    return np.concatenate(starts), np.concatenate(ends), np.concatenate(nodes), np.concatenate(numbers)


def _crossing(a: Array, b: Array, c: Array, d: Array) -> NDArray[np.bool_]:
    """Whether the segments ab and cd cross or touch, other than along a common line."""

    def side(p: Array, q: Array, r: Array) -> Array:
        a, b = q - p, r - p
        return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])

    c_side, d_side, a_side, b_side = side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)
    apart = (c_side * d_side > 0.0) | (a_side * b_side > 0.0)
    parallel = (c_side == 0.0) & (d_side == 0.0)
    return np.asarray(~apart & ~parallel)
