"""Periodic sides: pairs of element sides that are translations of each other, and the nodes that become one by them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from hoblock import QuadMesh
from hoblock.numbering import side_nodes
from hofsi.errors import CaseError, MeshMotionError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["PeriodicSides", "pair_sides", "representatives"]

_SAME = 1e-9  # of the mesh's extent: distance of nodes that are at the same place


@dataclass(frozen=True, eq=False)
class PeriodicSides:
    """Two sets of element sides; row k of one is row k of the other, translated. Made by `pair_sides`.

    Attributes
    ----------
    first, second : ndarray, shape (k, 2)
        (element, side).
    turned : ndarray of bool, shape (k,)
        Whether the nodes along the second side run against those along the first.
    nodes : ndarray, shape (m, 2)
        Nodes of the mesh on both, one pair a row.
    translation : ndarray, shape (2,)
        From the first to the second.
    tolerance : float
        Distance of nodes that are at the same place.
    names, place : str
        For messages.
    """

    first: Index
    second: Index
    turned: NDArray[np.bool_]
    nodes: Index
    translation: Array
    tolerance: float
    names: str
    place: str

    def pairs(self, cells: Index, order: int) -> Index:
        """Pairs of nodes of any order on the same elements, shape (m, 2), from cells in lexicographic order."""
        first, second = (_along(cells, sides, order) for sides in (self.first, self.second))
        second = np.where(self.turned[:, None], second[:, ::-1], second)
        return np.stack([first.ravel(), second.ravel()], axis=-1)

    def check(self, points: Array, time: float) -> None:
        """Check that the two are still apart by the translation, after the nodes have moved.

        Raises
        ------
        MeshMotionError
            If they are not.
        """
        gap = points[self.nodes[:, 1]] - points[self.nodes[:, 0]] - self.translation
        apart = np.hypot(gap[:, 0], gap[:, 1])
        if apart.max(initial=0.0) > self.tolerance:
            worst = int(np.argmax(apart))
            raise MeshMotionError(
                f"the sides of {self.place} ({self.names}) are no translation by {_point(self.translation)} any more: "
                f"the nodes at {_point(points[self.nodes[worst, 0]])} and {_point(points[self.nodes[worst, 1]])} are "
                f"{apart[worst]:.3g} off. Let both sides move alike, or not at all",
                "periodic sides",
                f"fluid mesh, t = {time:g}",
            )


def pair_sides(mesh: QuadMesh, first: Sequence[str], second: Sequence[str], place: str) -> PeriodicSides:
    """Pair the element sides of two sets of names by the one translation that maps the first onto the second.

    Parameters
    ----------
    mesh : QuadMesh
    first, second : sequence of str
        Names of its edges.
    place : str
        Of the condition, for messages.

    Raises
    ------
    CaseError
        If there is no such translation, or the fluid is on the same side of both.
    """
    names = " and ".join(", ".join(repr(name) for name in side) for side in (first, second))
    one, other = (np.concatenate([mesh.edge_groups[name] for name in side]) for side in (first, second))
    if len(one) != len(other):
        raise CaseError(
            f"{names} have {len(one)} and {len(other)} element sides; expected as many on both, one opposite the "
            "other. Give their block edges the same numbers of elements",
            f"{place}.with",
        )
    X, Y = (mesh.points[_along(mesh.cells, sides, mesh.order)] for sides in (one, other))
    translation = Y.mean(axis=(0, 1)) - X.mean(axis=(0, 1))
    moved = X + translation
    other, Y = _opposite(other, Y, moved)
    apart = np.stack([np.linalg.norm(Z - moved, axis=2) for Z in (Y, Y[:, ::-1])])
    turned = apart[1].max(axis=1) < apart[0].max(axis=1)
    apart = np.where(turned[:, None], apart[1], apart[0])
    tolerance = _SAME * float(np.ptp(mesh.points, axis=0).max())
    if apart.max() > tolerance or len(np.unique(other, axis=0)) < len(other):
        k, i = np.unravel_index(int(apart.argmax()), apart.shape)
        raise CaseError(
            f"{names} are no translation of each other: moved by {_point(translation)}, which fits best, the node at "
            f"{_point(X[k, i])} is {apart[k, i]:.3g} from the nearest one opposite; expected the same shape, numbers "
            "of elements and gradings on both. Correct the vertices, curves or gradings of one of them",
            f"{place}.with",
        )
    if ((_direction(one) * _direction(other) > 0) != turned).any():
        raise CaseError(
            f"the fluid lies on the same side of {names}; expected it between them, so that what leaves through one "
            "enters through the other. Name two opposite sides",
            f"{place}.with",
        )
    sides = PeriodicSides(one, other, turned, np.zeros((0, 2), dtype=np.int64), translation, tolerance, names, place)
    nodes = np.unique(sides.pairs(mesh.cells, mesh.order), axis=0)
    return PeriodicSides(one, other, turned, nodes, translation, tolerance, names, place)


def representatives(pairs: Index, count: int) -> Index:
    """Smallest node of each set that pairs (k, 2) make one, for all nodes, shape (count,)."""
    graph = sp.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    number, labels = sp.csgraph.connected_components(graph, directed=False)
    smallest = np.full(number, count)
    np.minimum.at(smallest, labels, np.arange(count))
    return np.asarray(smallest[labels])


def _opposite(sides: Index, X: Array, moved: Array) -> tuple[Index, Array]:
    """The sides whose nodes X (k, p + 1, 2) have the mean nearest to that of each row of others, and these nodes."""
    nearest = cKDTree(X.mean(axis=1)).query(moved.mean(axis=1))[1]
    return sides[nearest], X[nearest]


def _along(cells: Index, sides: Index, order: int) -> Index:
    """Nodes along element sides (k, 2), shape (k, order + 1)."""
    return np.asarray(cells[sides[:, 0, None], side_nodes(order)[sides[:, 1]]])


def _direction(sides: Index) -> Index:
    """1 for sides whose nodes run counter-clockwise around the element, -1 for the others."""
    return np.where(sides[:, 1] < 2, 1, -1)


def _point(x: Array) -> str:
    return f"({x[0]:.6g}, {x[1]:.6g})"
