"""Elements as the curves of their sides, for file formats that hold no interior nodes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.mesh import QuadMesh
from hoblock.numbering import number_nodes, side_nodes
from hoblock.reference import gauss_lobatto, lagrange
from hoblock.spelling import did_you_mean

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["INSIDE", "UNNAMED", "ElementSides", "element_sides", "neighbours", "transfinite_deviation"]

INSIDE = "---"
"""HOHQMesh's label of a side between two elements."""

UNNAMED = "unnamed"
"""Label of a boundary side, or an element, that no group of the mesh names."""

_LABEL = re.compile(r"\S{1,32}")
_STRAIGHT = 1e-14
_CORNERS_OF_SIDE = np.array([[0, 1], [1, 2], [3, 2], [0, 3]])


@dataclass(frozen=True, eq=False)
class ElementSides:
    """What HOHQMesh's formats hold of a mesh.

    Attributes
    ----------
    order : int
        Order p of the curves.
    vertices : ndarray, shape (v, 2)
    corners : ndarray, shape (e, 4)
        Vertices of each element, counter-clockwise.
    curves : ndarray, shape (e, 4, p + 1, 2)
        Points of each side in its direction (that of the increasing coordinate) at the Chebyshev–Gauss–Lobatto
        points -cos(kπ/p).
    curved : ndarray of bool, shape (e, 4)
        Which of them are not straight lines with linear parameter.
    labels : ndarray of str, shape (e, 4)
        Names of the boundary sides, ``---`` inside.
    """

    order: int
    vertices: Array
    corners: Index
    curves: Array
    curved: NDArray[np.bool_]
    labels: NDArray[np.str_]


def element_sides(mesh: QuadMesh, boundaries: Sequence[str] | None = None) -> ElementSides:
    """Take the sides of all elements from a mesh; the curves are exactly the sides' own polynomials.

    Parameters
    ----------
    mesh : QuadMesh
    boundaries : sequence of str, optional
        Groups of element sides whose names are wanted, the first one wins where several hold a side. Default: all,
        and then no boundary side may have two names.

    Raises
    ------
    MeshFileError
        If there is no such group, a name cannot be a label, or a boundary side has two names.
    """
    order = mesh.order
    t, count = number_nodes(mesh.corners, 1)
    corners = t[:, [0, 1, 3, 2]]
    vertices = np.empty((count, 2))
    vertices[corners] = mesh.points[mesh.corners]
    chebyshev = -np.cos(np.pi * np.arange(order + 1) / order)
    nodes = mesh.points[mesh.cells[:, side_nodes(order)]]  # (e, 4, p + 1, 2)
    curves = lagrange(gauss_lobatto(order), (chebyshev - chebyshev[::-1]) / 2) @ nodes
    curves[:, :, [0, -1]] = nodes[:, :, [0, -1]]  # exactly the vertices
    s = (chebyshev[:, None] + 1) / 2
    lines = (1 - s) * curves[:, :, :1] + s * curves[:, :, -1:]
    curved = np.abs(curves - lines).max(axis=(2, 3)) > _STRAIGHT * np.abs(mesh.points).max(initial=0.0)
    return ElementSides(order, vertices, corners, curves, curved, _labels(mesh, corners, boundaries))


def neighbours(corners: Index) -> tuple[Index, Index, Index]:
    """Element sides that lie on each other.

    Parameters
    ----------
    corners : ndarray, shape (e, 4)

    Returns
    -------
    pairs : ndarray, shape (m, 2)
        Vertices of each edge of the mesh, the smaller number first.
    first, second : ndarray, shape (m, 2)
        (element, side) on both sides of it, first the one that has the edge on its boundary counter-clockwise from the
        smaller to the larger number; second is (-1, -1) on the boundary of the mesh.

    Raises
    ------
    MeshFileError
        If an edge belongs to more than two elements, or two elements lie on the same side of it.
    """
    around = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2)
    forward = around[:, 0] < around[:, 1]
    pairs, edge = np.unique(np.sort(around, axis=1), axis=0, return_inverse=True)
    edge = edge.ravel()
    found = np.full((2, len(pairs), 2), -1)
    for k, chosen in enumerate((forward, ~forward)):
        sides = np.flatnonzero(chosen)
        if len(np.unique(edge[sides])) < len(sides):
            twice = np.flatnonzero(np.bincount(edge[sides]) > 1)[0]
            raise MeshFileError(
                f"edge between corners {pairs[twice][0]} and {pairs[twice][1]} has two elements on the same side of "
                "it; expected a plane mesh of counter-clockwise elements."
            )
        found[k, edge[sides]] = np.stack([sides // 4, sides % 4], axis=1)
    alone = found[0, :, 0] < 0
    found[0, alone], found[1, alone] = found[1, alone], -1
    return pairs, found[0], found[1]


def _labels(mesh: QuadMesh, corners: Index, boundaries: Sequence[str] | None) -> NDArray[np.str_]:
    _, first, second = neighbours(corners)
    outside = np.zeros(corners.shape, dtype=bool)
    outside[tuple(first[second[:, 0] < 0].T)] = True
    labels = np.where(outside, UNNAMED, INSIDE).astype("U32")
    for name in mesh.edge_groups if boundaries is None else boundaries:
        if name not in mesh.edge_groups:
            raise MeshFileError(f"boundaries: no group of sides named {name!r}{did_you_mean(name, mesh.edge_groups)}")
        element, side = mesh.edge_groups[name].T
        element, side = element[outside[element, side]], side[outside[element, side]]
        if not element.size:
            continue
        check_label(name)
        taken = labels[element, side] != UNNAMED
        if taken.any() and boundaries is None:
            k = int(np.flatnonzero(taken)[0])
            known = str(labels[element[k], side[k]])
            raise MeshFileError(
                f"side {side[k]} of element {element[k]} belongs to {known!r} and to {name!r}; the format holds one "
                "name a side. Say which names to write, in order of precedence: boundaries=[...], or --boundaries on "
                "the command line."
            )
        labels[element[~taken], side[~taken]] = name
    return labels


def check_label(name: str) -> None:
    """Refuse a name that HOHQMesh's formats cannot hold.

    Raises
    ------
    MeshFileError
    """
    if not _LABEL.fullmatch(name) or name == INSIDE:
        raise MeshFileError(
            f"the name {name!r} cannot be written; expected 1 to 32 characters without spaces, not {INSIDE!r}. "
            "Rename the group."
        )


def transfinite_deviation(mesh: QuadMesh) -> float:
    """Largest distance of a node from the transfinite map of its element's four sides.

    Programs that know only the sides rebuild the interior by that map. The distance is at the level of round-off
    unless a block has different gradings on *both* pairs of opposite edges; there the interiors differ a little.

    Parameters
    ----------
    mesh : QuadMesh

    References
    ----------
    Gordon & Hall, Numer. Math. 21 (1973) 109–129, doi:10.1007/BF01436298.
    """
    n = mesh.order + 1
    x = mesh.coordinates.reshape(-1, n, n, 2)  # (e, j, i, d)
    s = (gauss_lobatto(mesh.order) + 1) / 2
    u, v = s[None, None, :, None], s[None, :, None, None]
    along = (1 - v) * x[:, :1] + v * x[:, -1:] + (1 - u) * x[:, :, :1] + u * x[:, :, -1:]
    bilinear = (1 - v) * ((1 - u) * x[:, :1, :1] + u * x[:, :1, -1:]) + v * (
        (1 - u) * x[:, -1:, :1] + u * x[:, -1:, -1:]
    )
    return float(np.hypot(*np.moveaxis(x - along + bilinear, -1, 0)).max())
