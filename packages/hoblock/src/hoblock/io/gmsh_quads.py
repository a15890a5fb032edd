"""Coarse quad meshes of Gmsh as plain data, with the numbers of nodes and the names of points kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.msh_reading import MshContent, MshElements, scan
from hoblock.io.msh_scanner import ScanError
from hoblock.io.msh_types import LINES, QUADS, describe
from hoblock.io.planar import planar
from hoblock.scene import QuadsScene

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["gmsh_quads"]

_POINT = 15
_ORDERS = {**QUADS, 16: 2, 39: 3, 40: 4, 41: 5}
"""Order of each type of quad, those without inner nodes included; the sides come first in all of them."""


def gmsh_quads(path: str | Path) -> QuadsScene:
    """Read the quads of a file of Gmsh, version 2.2 or 4.1, text or binary.

    Physical surfaces name quads, physical curves edges, a physical point that is one node names its vertex. Groups
    without a name are called by their number, points by the number of their node.

    Raises
    ------
    MeshFileError
        If the file cannot be understood or holds something else than quads of one order, lines and points.
    """
    try:
        content = scan(Path(path).read_bytes())
    except ScanError as error:
        raise MeshFileError(f"{path}: {error}.") from error
    order = _order(path, content.elements)
    tags, first = np.unique(content.tags, return_index=True)
    parts = [part for part in content.elements if part.kind in _ORDERS]
    listed = np.concatenate([part.nodes[:, : 4 * order] for part in parts])
    _, once, which = np.unique(listed, axis=0, return_index=True, return_inverse=True)
    rank = np.empty(len(once), dtype=np.int64)
    rank[np.argsort(once)] = np.arange(len(once))
    number_of = rank[which.ravel()]  # version 2.2 repeats an element for each of its groups
    return QuadsScene(
        planar(path, content.points[first]),
        _numbers(path, tags, listed[np.sort(once)]),
        _point_names(content, tags),
        order,
        block_groups=_groups(content, 2, parts, number_of),
        edge_groups=_edges(path, content, tags),
        place=str(path),
    )


def _order(path: str | Path, elements: list[MshElements]) -> int:
    """Order of the quads; anything that is no quad, line or point is an error that counts it."""
    counts: dict[int, int] = {}
    for part in elements:
        counts[part.kind] = counts.get(part.kind, 0) + len(part.nodes)
    quads = sum(count for kind, count in counts.items() if kind in _ORDERS)
    for kind, count in counts.items():
        if count and kind not in _ORDERS and kind not in LINES and kind != _POINT:
            what, remedy = describe(kind)
            raise MeshFileError(f"{path}: there are {count} {what} beside {quads} quads; expected none. {remedy}")
    if not quads:
        raise MeshFileError(
            f"{path}: there are no quads; expected at least one. Mesh the surface with Mesh.RecombineAll = 1, and put "
            "it into a physical group if the file has any (Gmsh saves those only)."
        )
    orders = sorted({_ORDERS[kind] for kind, count in counts.items() if kind in _ORDERS and count})
    if len(orders) > 1:
        raise MeshFileError(f"{path}: there are quads of orders {', '.join(map(str, orders))}; expected one order.")
    return orders[0]


def _numbers(path: str | Path, tags: Index, nodes: Index) -> Index:
    """Positions of nodes among the sorted tags."""
    place = np.minimum(np.searchsorted(tags, nodes), max(len(tags) - 1, 0))
    wrong = np.ones(nodes.shape, dtype=bool) if not len(tags) else tags[place] != nodes
    if wrong.any():
        raise MeshFileError(f"{path}: an element uses node {nodes[wrong][0]}, which is not in the file. Write it anew.")
    return np.asarray(place, dtype=np.int64)


def _groups(content: MshContent, dimension: int, parts: list[MshElements], number_of: Index) -> dict[str, Index]:
    """Members of the physical groups of a dimension by name; ``number_of`` the elements, one after the other."""
    members: dict[str, list[Index]] = {}
    start = 0
    for part in parts:
        numbers = number_of[start : start + len(part.nodes)]
        start += len(part.nodes)
        for tag in np.unique(part.physical[part.physical != 0]).tolist():
            name = content.names.get((dimension, tag), str(tag))
            members.setdefault(name, []).append(numbers[(part.physical == tag).any(axis=1)])
    return {name: np.unique(np.concatenate(lists)) for name, lists in members.items()}


def _edges(path: str | Path, content: MshContent, tags: Index) -> dict[str, Index]:
    lines = [part for part in content.elements if part.kind in LINES]
    if not lines:
        return {}
    ends = _numbers(path, tags, np.concatenate([part.nodes[:, :2] for part in lines]))
    return {name: ends[members] for name, members in _groups(content, 1, lines, np.arange(len(ends))).items()}


def _point_names(content: MshContent, tags: Index) -> tuple[str, ...]:
    """Numbers of the nodes, and the names of physical points that are one node."""
    names = {int(tag): str(tag) for tag in tags}
    points = [part for part in content.elements if part.kind == _POINT]
    if points:
        nodes = np.concatenate([part.nodes[:, 0] for part in points])
        for name, members in _groups(content, 0, points, np.arange(len(nodes))).items():
            named = np.unique(nodes[members])
            if len(named) == 1 and name not in names.values():
                names[int(named[0])] = name
    return tuple(names[int(tag)] for tag in tags)
