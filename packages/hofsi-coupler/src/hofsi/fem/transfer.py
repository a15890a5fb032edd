"""Between the Taylor–Hood spaces of nested meshes: interpolation, and matrices and constraints of the coarser one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.reference import gauss_lobatto, lagrange
from hofsi.fem.constraints import DirectedNodes, NodeConstraints
from hofsi.fem.element import boundary_first
from hofsi.fem.element_matrices import ElementMatrices, batches, maker
from hofsi.fem.nesting import Nesting
from hofsi.fem.spaces import TaylorHood

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Transfer", "coarse_constraints"]

_SAME = 1e-9
"""Distance of places in [-1, 1] that are one."""

# Coordinate of a place of the parent in its parts (all, first half, second half), and the other way.
_INSIDE: tuple[Callable[[Array], Array], ...] = (lambda s: s, lambda s: 2.0 * s + 1.0, lambda s: 2.0 * s - 1.0)
_OUTSIDE: tuple[Callable[[Array], Array], ...] = (lambda s: s, lambda s: (s - 1.0) / 2.0, lambda s: (s + 1.0) / 2.0)


@dataclass(frozen=True, eq=False)
class _Kind:
    """Elements that lie in their parents alike.

    Attributes
    ----------
    elements, parents : ndarray, shape (k,)
    part : tuple of int
    turn : int
    interpolation : ndarray, shape (fine local unknowns, coarse local unknowns)
    """

    elements: Index
    parents: Index
    part: tuple[int, int]
    turn: int
    interpolation: Array


class Transfer:
    """Interpolation of velocity and pressure from the elements of a coarser mesh, element by element.

    Both spaces are piecewise polynomials in the parents' own coordinates, of the same order. Element vectors and
    matrices are in x and y, in the local order of `TaylorHood`.

    Parameters
    ----------
    fine, coarse : TaylorHood
    nesting : Nesting
    """

    def __init__(self, fine: TaylorHood, coarse: TaylorHood, nesting: Nesting) -> None:
        self.fine, self.coarse = fine, coarse
        key = nesting.part[:, 0] + 3 * nesting.part[:, 1] + 9 * nesting.turn
        self.kinds = []
        for value in np.unique(key).tolist():
            elements = np.flatnonzero(key == value)
            part, turn = (value % 3, value // 3 % 3), value // 9
            P = _interpolation(fine, part, turn)
            self.kinds.append(_Kind(elements, nesting.parent[elements], part, turn, P))

    def matrices(self, A: ElementMatrices) -> Array:
        """Galerkin's matrices Pᵀ A P of the coarse elements, from those of the fine ones, (e, k, k) or made on call."""
        count, k = self.fine.dofs.shape
        make, result = maker(A), np.zeros((len(self.coarse.dofs), k, k))
        for batch in batches(count, k):
            part = make(batch)
            for kind in self.kinds:
                first, last = np.searchsorted(kind.elements, [batch.start, batch.stop])  # they ascend
                if first < last:
                    own = part[kind.elements[first:last] - batch.start]
                    product = (own.reshape(-1, k) @ kind.interpolation).reshape(-1, k, k)
                    result[kind.parents[first:last]] += kind.interpolation.T @ product
        return result

    def restrict(self, r: Array) -> Array:
        """Pᵀ r of the coarse elements (c, k), from shares of the unknowns on the fine elements' boundaries (e, b)."""
        result = np.zeros(self.coarse.dofs.shape)
        for kind in self.kinds:
            result[kind.parents] += r[kind.elements] @ kind.interpolation[: self.fine.boundary]
        return result

    def prolong(self, x: Array) -> Array:
        """P x on the fine elements' boundaries (e, b), from all values of the coarse elements (c, k)."""
        result = np.empty((len(self.fine.dofs), self.fine.boundary))
        for kind in self.kinds:
            result[kind.elements] = x[kind.parents] @ kind.interpolation[: self.fine.boundary].T
        return result


def _turned(order: int, turn: int) -> Index:
    """Local nodes of an element in the order in which its parent counts them, lexicographic."""
    return np.rot90(np.arange((order + 1) ** 2).reshape(order + 1, order + 1), turn).ravel()


def _interpolation(space: TaylorHood, part: tuple[int, int], turn: int) -> Array:
    """Values of the unknowns of an element that is a part of another, from those of the other."""
    result = np.zeros((space.dofs.shape[1],) * 2)
    for field, order in enumerate((space.order, space.order, space.order - 1)):
        nodes = gauss_lobatto(order)
        along = [lagrange(nodes, _OUTSIDE[half](nodes)) for half in part]
        values = np.empty(((order + 1) ** 2,) * 2)
        values[_turned(order, turn)] = np.kron(along[1], along[0])
        local = boundary_first(order)[0]
        space.put(result[None], field, field, values[None, local[:, None], local])
    return result


def coarse_constraints(transfer: Transfer, constraints: NodeConstraints) -> NodeConstraints:
    """Constraints of a coarser velocity: those of the fine nodes that lie nearest along the elements' sides.

    Parameters
    ----------
    transfer : Transfer
    constraints : NodeConstraints
        Of the fine velocity; they do not change between the ends of a coarse side.
    """
    coarse = transfer.coarse
    source = np.full(coarse.velocity_count, -1, dtype=np.int64)
    for here, there in _partners(transfer):
        source[here] = there
    nodes = np.flatnonzero(source >= 0)
    source = source[nodes]
    turned = np.isin(source, constraints.rotated)
    fixed = constraints.fixed[source]
    entries = [DirectedNodes.component(nodes[fixed[:, axis] & ~turned], axis) for axis in range(2)]
    if turned.any():
        entries.append(DirectedNodes(nodes[turned], constraints.frames[source[turned], :, 0]))
    return NodeConstraints(coarse.velocity_count, entries)


def _partners(transfer: Transfer) -> Iterator[tuple[Index, Index]]:
    """Coarse velocity nodes on the elements' boundaries, and fine ones on the same sides."""
    fine, coarse, p = transfer.fine, transfer.coarse, transfer.fine.order
    local, on_boundary = boundary_first(p)
    place = np.argsort(local)
    for kind in transfer.kinds:
        along = [_nearest(p, half) for half in kind.part]
        turned = _turned(p, kind.turn)
        for number, node in enumerate(local[:on_boundary].tolist()):
            i, j = along[0][node % (p + 1)], along[1][node // (p + 1)]
            if i >= 0 and j >= 0:
                own = place[turned[i + (p + 1) * j]]
                yield coarse.velocity_cells[kind.parents, number], fine.velocity_cells[kind.elements, own]


def _nearest(order: int, half: int) -> list[int]:
    """For each node of a side, the node of a part of it in the same place, else the nearest that is no end, else -1."""
    nodes = gauss_lobatto(order)
    result = []
    for place in _INSIDE[half](nodes):
        away = np.abs(nodes - place)
        if abs(place) > 1.0 + _SAME:
            result.append(-1)
        elif away.min() < _SAME:
            result.append(int(away.argmin()))
        else:
            result.append(1 + int(away[1:-1].argmin()))
    return result
