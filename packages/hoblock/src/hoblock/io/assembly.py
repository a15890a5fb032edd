"""Meshes put together from the cells that a file lists: in the plane, counter-clockwise, on GLL nodes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.equispaced import resampled
from hoblock.io.planar import planar
from hoblock.mesh import QuadMesh
from hoblock.numbering import corner_nodes, side_nodes
from hoblock.reference import differentiation_matrix, gauss_legendre, gauss_lobatto, lagrange

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Bool = NDArray[np.bool_]

__all__ = ["assembled", "directed_sides"]

_NONE: Mapping[str, Index] = MappingProxyType({})
_LARGEST = 1e100  # coordinate; squares of larger ones may overflow in what is computed from a mesh
_CCW = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])  # corners of sides 0 to 3, counter-clockwise


def directed_sides(mesh: QuadMesh, sides: Index) -> Index:
    """Nodes of element sides, shape (k, p + 1), walked counter-clockwise around their element.

    So the direction tells which of two neighbours a side inside the mesh belongs to.
    """
    nodes = mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]]
    return np.where(sides[:, 1, None] < 2, nodes, nodes[:, ::-1])


def assembled(
    path: str | Path,
    points: Array,
    cells: Index,
    order: int,
    nodes: Array,
    *,
    cell_groups: Mapping[str, Index] = _NONE,
    edge_groups: Mapping[str, Index] = _NONE,
    lines: Mapping[str, Index] = _NONE,
) -> QuadMesh:
    """Make a mesh of what a file holds.

    Elements that are listed clockwise are turned (not single ones that are turned over), nodes that no element uses are
    left out, and the geometry is resampled on GLL nodes (exactly: an element map is a polynomial).

    Parameters
    ----------
    path : str or Path
        For messages.
    points : ndarray, shape (n, 2) or (n, 3)
        The third coordinate has to be the same everywhere.
    cells : ndarray, shape (e, (p + 1)²)
        Lexicographic.
    order : int
    nodes : ndarray, shape (p + 1,)
        Reference nodes of the file's elements, with both ends.
    cell_groups : mapping of str to ndarray, optional
        Elements.
    edge_groups : mapping of str to ndarray, shape (k, 2), optional
        (element, side) of the cells as given.
    lines : mapping of str to ndarray, shape (k, 2), optional
        Further groups of sides, by their end nodes. Of two elements at a side, the one around which the line runs
        counter-clockwise is taken.

    Returns
    -------
    QuadMesh

    Raises
    ------
    MeshFileError
        If the parts do not fit together.
    """
    if not len(cells):
        raise MeshFileError(f"{path}: there are no quadrilaterals; expected at least one.")
    if cells.min() < 0 or cells.max() >= len(points):
        raise MeshFileError(f"{path}: elements use nodes {cells.min()} to {cells.max()}; there are {len(points)}.")
    _check_corners(path, cells[:, corner_nodes(order)])
    used = np.zeros(len(points), dtype=bool)
    used[cells] = True
    number = np.cumsum(used) - 1
    cells = number[cells]
    flat = resampled(_planar(path, points[used]), cells, order, nodes, gauss_lobatto(order))
    clockwise = _clockwise(cells[:, corner_nodes(order)], _signed_areas(flat, cells, order))
    transposed = np.arange((order + 1) ** 2).reshape(order + 1, -1).T.ravel()
    cells[clockwise] = cells[clockwise][:, transposed]
    sides = {name: _turned(members, clockwise) for name, members in edge_groups.items()}
    finder = _SideFinder(cells[:, corner_nodes(order)], int(used.sum()))
    for name, pairs in lines.items():
        if pairs.size and (pairs.min() < 0 or pairs.max() >= len(points)):
            raise MeshFileError(f"{path}: lines of {name!r} use nodes that are not in the file. Write it anew.")
        inside = used[pairs].all(axis=1) if len(pairs) else np.zeros(0, dtype=bool)
        found = finder.find(number[pairs])
        lost = np.flatnonzero(~inside | (found[:, 0] < 0))
        if lost.size:
            first, second = points[pairs[lost[0]], :2].tolist()
            raise MeshFileError(
                f"{path}: {lost.size} lines of {name!r} are no sides of quadrilaterals, the first from "
                f"({first[0]:.6g}, {first[1]:.6g}) to ({second[0]:.6g}, {second[1]:.6g}). "
                "Leave them out of the group, or mesh the surface beside them."
            )
        sides[name] = np.unique(found, axis=0)
    return QuadMesh(flat, cells, order, dict(cell_groups), sides)


def _check_corners(path: str | Path, corners: Index) -> None:
    ascending = np.sort(corners, axis=1)
    collapsed = np.flatnonzero((ascending[:, 1:] == ascending[:, :-1]).any(axis=1))
    if collapsed.size:
        raise MeshFileError(
            f"{path}: {collapsed.size} quadrilaterals have two corners in one node, the first is element "
            f"{collapsed[0]}; expected four different corners. Mesh those places with proper quadrilaterals."
        )


def _planar(path: str | Path, points: Array) -> Array:
    if not np.isfinite(points).all():
        raise MeshFileError(f"{path}: a node has a coordinate that is not finite. Write the file anew.")
    if np.abs(points).max(initial=0.0) > _LARGEST:
        raise MeshFileError(
            f"{path}: a node has the coordinate {np.abs(points).max():.3g}; expected at most {_LARGEST:g}, so that "
            "areas do not overflow. The file is damaged, or its unit of length is far too small: write it anew."
        )
    return planar(path, points)


def _signed_areas(points: Array, cells: Index, order: int) -> Array:
    """Areas of elements on GLL nodes, negative if clockwise: the integral of x dy around each."""
    nodes = gauss_lobatto(order)
    x, w = gauss_legendre(order + 1)
    Q = (w @ lagrange(nodes, x))[:, None] * differentiation_matrix(nodes)
    sides = points[cells[:, side_nodes(order)]]  # (e, s, k, d)
    sides = sides - sides[:, :1, :1]
    parts = np.einsum("esk,kl,esl->es", sides[..., 0], Q, sides[..., 1], optimize=True)
    return np.asarray(parts @ np.array([1.0, 1.0, -1.0, -1.0]))


def _clockwise(corners: Index, areas: Array) -> Bool:
    """Elements that a file lists the other way round than the rest of their connected part.

    Neighbours run their common side in opposite directions. A part counts as clockwise by its whole area, so that
    single elements that are turned over stay as they are, to be found invalid.
    """
    if not (areas < 0.0).any():
        return np.zeros(len(areas), dtype=bool)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = corners[:, _CCW].reshape(-1, 2)
    count = int(corners.max()) + 1
    keys = pairs.min(axis=1) * count + pairs.max(axis=1)
    order = np.argsort(keys, kind="stable")
    shared = np.flatnonzero(keys[order[1:]] == keys[order[:-1]])
    first, second = order[shared], order[shared + 1]
    differ = pairs[first, 0] == pairs[second, 0]  # one of the two has to be turned
    n = len(areas)
    ends = [np.concatenate([first // 4, first // 4 + n]), np.concatenate([second // 4, second // 4 + n])]
    ends[1] = (ends[1] + np.tile(differ, 2) * n) % (2 * n)
    # Two copies of each element, as listed and turned; a part of the copies is one way to orient a part of the mesh.
    graph = coo_array((np.ones(len(ends[0])), tuple(ends)), shape=(2 * n, 2 * n))
    _, part = connected_components(graph, directed=False)
    total = np.bincount(part, weights=np.concatenate([areas, -areas]))
    listed, turned = total[part[:n]], total[part[n:]]
    return np.where(part[:n] == part[n:], areas < 0.0, turned > listed)


def _turned(sides: Index, clockwise: Bool) -> Index:
    """Sides after the axes of clockwise elements were swapped."""
    result = np.array(sides)
    swap = clockwise[result[:, 0]]
    result[swap, 1] = 3 - result[swap, 1]
    return result


class _SideFinder:
    """Finds element sides by their end nodes.

    Parameters
    ----------
    corners : ndarray, shape (e, 4)
        Counter-clockwise.
    count : int
        Number of nodes.
    """

    def __init__(self, corners: Index, count: int) -> None:
        self._count = count
        pairs = corners[:, _CCW].reshape(-1, 2)
        keys = pairs[:, 0] * count + pairs[:, 1]
        self._order = np.argsort(keys, kind="stable")
        self._keys = keys[self._order]

    def find(self, pairs: Index) -> Index:
        """Sides (element, side) between nodes, by preference of that direction; -1 where there is none."""
        pairs = pairs.reshape(-1, 2)
        along = self._match(pairs)
        index = np.where(along >= 0, along, self._match(pairs[:, ::-1]))
        return np.where(index[:, None] < 0, -1, np.stack([index // 4, index % 4], axis=-1))

    def _match(self, pairs: Index) -> Index:
        keys = pairs[:, 0] * self._count + pairs[:, 1]
        place = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        return np.where(self._keys[place] == keys, self._order[place], -1)
