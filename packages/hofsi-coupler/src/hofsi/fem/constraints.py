"""Constraints n·u = g on the nodes of a vector field: Dirichlet values, slip and rollers in one form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["DirectedNodes", "NodeConstraints"]

_PARALLEL = 1e-6  # sine of the angle below which two constraint directions count as one


@dataclass(frozen=True)
class DirectedNodes:
    """Nodes whose component along a direction is given.

    Attributes
    ----------
    nodes : ndarray, shape (k,)
    directions : ndarray, shape (k, 2)
        Unit vectors n of the constraint n·u = g.
    """

    nodes: Index
    directions: Array

    @staticmethod
    def component(nodes: Index, axis: int) -> DirectedNodes:
        """Return a constraint of one Cartesian component."""
        return DirectedNodes(nodes, np.broadcast_to(np.eye(2)[axis], (len(nodes), 2)))


class NodeConstraints:
    """All constraints of a vector field; earlier ones win where they contradict.

    A node with one constraint keeps a free direction; its two degrees of freedom are then those along n and along the
    tangent, unless n is an axis. A node with two independent constraints is fixed.

    Parameters
    ----------
    node_count : int
    entries : sequence of DirectedNodes
        In the order of precedence.

    Attributes
    ----------
    fixed : ndarray of bool, shape (n, 2)
        Fixed degrees of freedom, in each node's own frame.
    frames : ndarray, shape (n, 2, 2)
        Columns are the node's axes: u = frame @ u'.
    rotated : ndarray
        Nodes whose frame is not the identity.
    entries : tuple of DirectedNodes
    """

    def __init__(self, node_count: int, entries: Sequence[DirectedNodes]) -> None:
        self.fixed = np.zeros((node_count, 2), dtype=bool)
        self.frames = np.broadcast_to(np.eye(2), (node_count, 2, 2)).copy()
        rank = np.zeros(node_count, dtype=np.int64)
        first = np.zeros((node_count, 2))
        self.entries = tuple(entries)
        self._uses: list[tuple[Index, Index, Array, NDArray[np.bool_]]] = []
        for entry in entries:
            nodes, n = entry.nodes, entry.directions
            opening = rank[nodes] == 0
            sine = first[nodes, 0] * n[:, 1] - first[nodes, 1] * n[:, 0]
            closing = (rank[nodes] == 1) & (np.abs(sine) > _PARALLEL)
            used = opening | closing
            first[nodes[opening]] = n[opening]
            rank[nodes[used]] += 1
            self._uses.append((np.flatnonzero(used), nodes[used], n[used], closing[used]))
        self._first = first
        axis = np.abs(first) > 1.0 - 1e-14
        single = rank == 1
        self.fixed[rank == 2] = True
        for component in range(2):
            self.fixed[single & axis[:, component], component] = True
        self.rotated = np.flatnonzero(single & ~axis.any(axis=1))
        n = first[self.rotated]
        self.fixed[self.rotated, 0] = True
        self.frames[self.rotated] = np.stack([n, np.stack([-n[:, 1], n[:, 0]], -1)], axis=-1)

    def impose(self, field: Array, values: Sequence[Array]) -> Array:
        """Return the field with the constraints satisfied; free components are kept.

        Parameters
        ----------
        field : ndarray, shape (n, 2)
        values : sequence of ndarray
            g of each entry, in the order given to the constructor.
        """
        result = field.copy()
        for (where, nodes, n, closing), g in zip(self._uses, values, strict=True):
            given = g[where] if np.ndim(g) else g
            gap = given - np.sum(n * result[nodes], axis=1)
            direction = n.copy()
            # A second constraint must not disturb the first: move at a right angle to that one.
            t = np.stack([-self._first[nodes, 1], self._first[nodes, 0]], axis=-1)[closing]
            direction[closing] = t / np.sum(t * n[closing], axis=1)[:, None]
            result[nodes] += gap[:, None] * direction
        return result
