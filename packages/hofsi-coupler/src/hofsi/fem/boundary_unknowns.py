"""Unknowns on the elements' boundaries: which are free, and the frames of their nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hofsi.fem.constraints import NodeConstraints

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BoundaryUnknowns"]


class BoundaryUnknowns:
    """Numbers of what is left of elements without their inner unknowns.

    Parameters
    ----------
    dofs : ndarray, shape (e, k)
        Global numbers of the local unknowns of each element; those on the element's boundary first. Unknowns of a
        vector field come first: node n has 2n and 2n + 1.
    boundary : int
        How many local unknowns lie on the element's boundary.
    size : int
        Number of global unknowns.
    constraints : NodeConstraints
        Of the vector field.
    pinned : sequence of int
        Further unknowns that are held fixed, for example one pressure of an enclosed flow.
    copies : ndarray, shape (c, 2), optional
        Unknowns of no element, and those whose values they get in a solution.
    border : sequence of int
        Constrained unknowns of the vector field, both of each node, whose effect on all others can be asked for.

    Attributes
    ----------
    inner : int
        How many local unknowns lie inside.
    unknowns : ndarray
        Free unknowns on the elements' boundaries, in global numbers.
    skeleton : ndarray, shape (e, boundary)
        Numbers of these of each element, among ``unknowns``; -1 where constrained.
    with_border : ndarray, shape (e, boundary)
        The same, but the border's unknowns numbered in their order after all others.
    rotated : ndarray, shape (r,)
        Elements with nodes in a frame of their own.
    rotation : ndarray, shape (r, boundary, boundary)
        From these frames to x and y.
    """

    def __init__(
        self,
        dofs: Index,
        boundary: int,
        size: int,
        constraints: NodeConstraints,
        pinned: tuple[int, ...] = (),
        copies: Index | None = None,
        border: Sequence[int] | Index = (),
    ) -> None:
        self.border = np.asarray(border, dtype=np.int64)
        self.dofs, self.boundary, self.size = dofs, boundary, size
        self.copies = copies
        self.inner = dofs.shape[1] - boundary
        free = np.zeros(size, dtype=bool)
        free[dofs[:, :boundary]] = True
        vector = constraints.fixed.size
        free[:vector] &= ~constraints.fixed.ravel()
        free[list(pinned)] = False
        self.unknowns = np.flatnonzero(free)
        number = np.full(size, -1)
        number[self.unknowns] = np.arange(len(self.unknowns))
        self.skeleton = number[dofs[:, :boundary]]
        number[self.border] = len(self.unknowns) + np.arange(len(self.border))
        self.with_border = number[dofs[:, :boundary]]
        self.rotated, self.rotation = self._rotations(constraints)
        self._turned_nodes = constraints.rotated

    def _rotations(self, constraints: NodeConstraints) -> tuple[Index, Array]:
        """Elements with nodes in a frame of their own, and their local rotation matrices."""
        if not constraints.rotated.size:
            return np.zeros(0, dtype=np.int64), np.zeros((0, 0, 0))
        dofs = self.dofs[:, : self.boundary]
        vector = dofs < constraints.fixed.size
        nodes = np.where(vector, dofs // 2, 0)
        turned = vector & np.isin(nodes, constraints.rotated)
        elements = np.flatnonzero(turned.any(axis=1))
        R = np.zeros((len(elements), self.boundary, self.boundary))
        R[:, np.arange(self.boundary), np.arange(self.boundary)] = 1.0
        # In ascending order x and y of a node follow each other; where an element has a node twice, by periodic sides,
        # both x come first, then both y.
        order = np.argsort(dofs[elements], axis=1, kind="stable")
        row, column = np.nonzero(np.take_along_axis(turned[elements], order, axis=1))
        local = order[row, column]
        is_x = dofs[elements][row, local] % 2 == 0
        pair, row = (local[is_x], local[~is_x]), row[is_x]
        frames = constraints.frames[nodes[elements][row, pair[0]]]
        for a in range(2):
            for b in range(2):
                R[row, pair[a], pair[b]] = frames[:, a, b]
        return elements, R

    def turned(self, unknowns: Index) -> bool:
        """Whether some unknowns of the vector field belong to nodes with a frame of their own."""
        return bool(np.isin(unknowns // 2, self._turned_nodes).any())

    def rotate_back(self, x: Array) -> Array:
        """Element vectors (e, boundary) from the nodes' own frames to x and y."""
        if self.rotated.size:
            x[self.rotated] = (self.rotation @ x[self.rotated][:, :, None])[:, :, 0]
        return x

    def rotate(self, r: Array) -> Array:
        """Element vectors (e, boundary) from x and y to the nodes' own frames."""
        if self.rotated.size:
            r[self.rotated] = (self.rotation.transpose(0, 2, 1) @ r[self.rotated][:, :, None])[:, :, 0]
        return r
