"""Which nodes of a mesh are moving, fixed and free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.numbering import side_nodes

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["NodeRoles", "boundary_sides"]


def boundary_sides(mesh: QuadMesh) -> Index:
    """Element sides (element, side) that belong to one element only, shape (k, 2)."""
    ends = mesh.cells[:, side_nodes(mesh.order)[:, [0, -1]]].reshape(-1, 2)
    _, first, uses = np.unique(np.sort(ends, axis=1), axis=0, return_index=True, return_counts=True)
    alone = np.sort(first[uses == 1])
    return np.stack([alone // 4, alone % 4], axis=-1)


@dataclass(frozen=True, eq=False)
class NodeRoles:
    """Moving nodes have given positions, fixed ones stay, free ones are placed by a mover.

    Attributes
    ----------
    reference : ndarray, shape (n, 2)
    moving, fixed, free : ndarray
        Ascending.
    """

    reference: Array
    moving: Index
    fixed: Index
    free: Index

    @staticmethod
    def of(mesh: QuadMesh, moving: Index, fixed: Index) -> NodeRoles:
        """Sort the nodes of a mesh by what happens to them.

        Raises
        ------
        ValueError
            If a list is not ascending, the lists overlap, or a node of the boundary is in neither.
        """
        count = len(mesh.points)
        moving, fixed = _ascending(moving, "moving", count), _ascending(fixed, "fixed", count)
        if (both := np.intersect1d(moving, fixed)).size:
            raise ValueError(f"node {both[0]} is both moving and fixed. Take it out of one list.")
        given = np.union1d(moving, fixed)
        sides = boundary_sides(mesh)
        boundary = mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]]
        if (missing := np.setdiff1d(boundary, given)).size:
            raise ValueError(
                f"node {missing[0]} at {mesh.points[missing[0]].tolist()} is on the boundary, but neither moving nor "
                f"fixed ({missing.size} such nodes). Add them to one of the lists."
            )
        free = np.setdiff1d(np.arange(count), given)
        for array in (moving, fixed, free):
            array.setflags(write=False)
        return NodeRoles(mesh.points, moving, fixed, free)

    @property
    def given(self) -> Index:
        """Moving and fixed nodes, ascending."""
        return np.union1d(self.moving, self.fixed)

    def start(self, current: Array, incremental: bool) -> Array:
        """Return where a move starts: the reference, or the last accepted state if the method is incremental."""
        return self._checked(current, "current", len(self.reference)) if incremental else self.reference

    def displacement(self, start: Array, positions: Array) -> Array:
        """Displacement (n, 2) of the given nodes from a start to where they must be; zero at free nodes."""
        u = np.zeros_like(self.reference)
        u[self.moving] = self._checked(positions, "positions", len(self.moving)) - start[self.moving]
        u[self.fixed] = self.reference[self.fixed] - start[self.fixed]
        return u

    def placed(self, points: Array, positions: Array) -> Array:
        """Return all positions with those of the given nodes exact."""
        points = points.copy()
        points[self.moving], points[self.fixed] = positions, self.reference[self.fixed]
        return points

    def _checked(self, array: Array, name: str, count: int) -> Array:
        array = np.asarray(array, dtype=float)
        if array.shape != (count, 2):
            raise ValueError(f"move: {name} has shape {array.shape}; expected {(count, 2)}.")
        if not np.isfinite(array).all():
            k = int(np.argmin(np.isfinite(array).all(axis=1)))
            raise ValueError(f"move: {name}[{k}] is {array[k].tolist()}; expected finite coordinates.")
        return array


def _ascending(nodes: Index, name: str, count: int) -> Index:
    nodes = np.array(nodes)
    if nodes.ndim != 1 or (nodes.size and not np.issubdtype(nodes.dtype, np.integer)):
        raise ValueError(
            f"{name}: array of shape {nodes.shape}, type {nodes.dtype}; expected node numbers, shape (k,)."
        )
    nodes = nodes.astype(np.int64)
    if nodes.size and (nodes[0] < 0 or nodes[-1] >= count or (np.diff(nodes) <= 0).any()):
        raise ValueError(f"{name}: expected ascending node numbers from 0 to {count - 1}, each once. Use np.unique.")
    return nodes
