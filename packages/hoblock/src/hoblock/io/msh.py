"""Gmsh's MSH files, versions 2.2 and 4.1."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.assembly import assembled
from hoblock.io.group_names import check_names
from hoblock.io.msh_encoding import AsBytes, AsText
from hoblock.io.msh_reading import MshContent, MshElements, scan
from hoblock.io.msh_scanner import ScanError
from hoblock.io.msh_types import HIGHEST_ORDER, LINES, QUADS, describe
from hoblock.io.msh_writing import msh22, msh41
from hoblock.io.replacing import replacing
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.reference import equispaced

Index = NDArray[np.int64]

__all__ = ["read_msh", "write_msh"]

_POINT = 15


def write_msh(path: str | Path, mesh: QuadMesh, version: str | None = None, *, binary: bool = True) -> None:
    """Write a mesh for Gmsh and the many programs that read its files.

    Quads have the type of their order (quad, quad9, quad16 …). Groups of elements become physical surfaces, groups of
    element sides physical curves made of lines of the same order, which run counter-clockwise around the element that
    the group names. The file appears complete or not at all.

    Parameters
    ----------
    path : str or Path
    mesh : QuadMesh
        Of order 1 to 10.
    version : {"2.2", "4.1"}, optional
        Version 2.2 is what most programs read, and holds one group an element; a line in several groups is written
        once for each. Version 4.1 holds elements and lines in any number of groups. Default: 2.2 where it can hold the
        mesh, else 4.1.
    binary : bool, optional
        Whether to write numbers as bytes. As text (for deal.II and others that read nothing else) they are as exact,
        but take three times the space.

    Raises
    ------
    MeshFileError
        If the format cannot hold the mesh.
    ValueError
        If the version is neither.
    OSError
        If the file cannot be written.

    References
    ----------
    Gmsh reference manual, "MSH file format" and "MSH file format version 2 (Legacy)",
    https://gmsh.info/doc/texinfo/gmsh.html.
    """
    if version not in (None, "2.2", "4.1"):
        raise ValueError(f"write_msh: version is {version!r}; expected '2.2' or '4.1'.")
    if mesh.order > HIGHEST_ORDER:
        raise MeshFileError(
            f"{path}: the mesh has order {mesh.order}; Gmsh's files hold orders 1 to {HIGHEST_ORDER}. "
            "Write .vtu or .npz, or lower the order."
        )
    check_names(path, [*mesh.cell_groups, *mesh.edge_groups], quotes=False, most_bytes=120)
    shared = _shared_element(mesh)
    if version == "2.2" and shared is not None:
        raise MeshFileError(
            f"{path}: element {shared[0]} is in group {shared[1]!r} and in another one; version 2.2 holds one group an "
            "element. Write version 4.1, .vtu or .npz, or remove a group."
        )
    if len(mesh.points) >= 2**31 and version != "4.1":
        raise MeshFileError(f"{path}: the mesh has {len(mesh.points)} nodes; write version 4.1.")
    encoding = AsBytes() if binary else AsText()
    parts = msh22(mesh, encoding) if version != "4.1" and shared is None else msh41(mesh, encoding)
    with replacing(path) as file:
        file.writelines(parts)


def read_msh(path: str | Path) -> QuadMesh:
    """Read a mesh of quadrangles that Gmsh, `write_msh` or another program wrote.

    Versions 2.2 and 4.1 are read, text and binary. All quadrangles must have the same order, 1 to 10; lines name
    sides, points are ignored. Physical groups become groups of elements and of element sides, called by their number
    where they have no name. Clockwise elements are turned. The geometry is exactly that of the file, on GLL nodes;
    nodes and elements are numbered in the order of their tags.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    QuadMesh

    Raises
    ------
    MeshFileError
        If the file cannot be understood, or holds something else.
    OSError
        If the file cannot be opened.
    """
    try:
        content = scan(Path(path).read_bytes())
    except ScanError as error:
        raise MeshFileError(f"{path}: {error}.") from error
    _check_kinds(path, content.elements)
    quads = _merged(part for part in content.elements if part.kind in QUADS)
    if quads is None:
        raise MeshFileError(
            f"{path}: there are no quadrangles; expected at least one. Mesh the surface, and put it into a physical "
            "group if the file has any (Gmsh saves those only)."
        )
    order = QUADS[quads.kind]
    tags, first = np.unique(content.tags, return_index=True)
    quads = _each_once(quads)
    numbers = _numbers(path, tags, quads.nodes)
    cells = numbers[:, np.argsort(node_order(order, "gmsh"))]
    lines = [part for part in content.elements if part.kind in LINES]
    ends = np.concatenate([np.zeros((0, 2), dtype=np.int64), *(part.nodes[:, :2] for part in lines)])
    physical = [(part.physical, part) for part in lines]
    sides = _groups(content, 1, [(tags_of, len(part.nodes)) for tags_of, part in physical])
    pairs = _numbers(path, tags, ends)
    return assembled(
        path,
        content.points[first],
        cells,
        order,
        equispaced(order),
        cell_groups=_groups(content, 2, [(quads.physical, len(cells))]),
        lines={name: pairs[members] for name, members in sides.items()},
    )


def _shared_element(mesh: QuadMesh) -> tuple[int, str] | None:
    """An element in several groups, and the last one's name."""
    uses = np.zeros(len(mesh.cells), dtype=np.int64)
    for name, members in mesh.cell_groups.items():
        uses[members] += 1
        if (uses[members] > 1).any():
            return int(members[np.argmax(uses[members])]), name
    return None


def _check_kinds(path: str | Path, elements: list[MshElements]) -> None:
    counts: dict[int, int] = {}
    for part in elements:
        counts[part.kind] = counts.get(part.kind, 0) + len(part.nodes)
    for kind, count in counts.items():
        if count and kind not in QUADS and kind not in LINES and kind != _POINT:
            number = next(int(part.numbers[0]) for part in elements if part.kind == kind and len(part.nodes))
            what, remedy = describe(kind)
            raise MeshFileError(
                f"{path}: there are {count} {what}, the first is element {number}; expected quadrangles of order 1 to "
                f"{HIGHEST_ORDER} and lines. {remedy}"
            )
    orders = sorted(QUADS[kind] for kind, count in counts.items() if kind in QUADS and count)
    if len(orders) > 1:
        raise MeshFileError(
            f"{path}: there are quadrangles of orders {', '.join(map(str, orders))}; expected one order. "
            "In Gmsh: Mesh.ElementOrder, or setOrder."
        )


def _merged(parts: Iterable[MshElements]) -> MshElements | None:
    """Elements of one type, sorted by their numbers."""
    parts = [part for part in parts if len(part.nodes)]
    if not parts:
        return None
    width = max(part.physical.shape[1] for part in parts)
    physical = np.concatenate([np.pad(p.physical, ((0, 0), (0, width - p.physical.shape[1]))) for p in parts])
    numbers, nodes = np.concatenate([p.numbers for p in parts]), np.concatenate([p.nodes for p in parts])
    order = np.argsort(numbers, kind="stable")
    return MshElements(parts[0].kind, numbers[order], nodes[order], physical[order])


def _each_once(quads: MshElements) -> MshElements:
    """Version 2.2 repeats an element for each of its groups."""
    corners = quads.nodes[:, :4]
    if len(np.unique(corners[:, 0] * (int(corners.max()) + 1) + corners[:, 2])) == len(corners):
        return quads
    _, first, which = np.unique(quads.nodes, axis=0, return_index=True, return_inverse=True)
    which = np.argsort(np.argsort(first))[which.ravel()]
    first = np.sort(first)
    repeats = int(np.bincount(which).max())
    physical = np.zeros((len(first), repeats * quads.physical.shape[1]), dtype=np.int64)
    order = np.argsort(which, kind="stable")
    place = np.arange(len(which)) - np.searchsorted(which[order], which[order])
    width = quads.physical.shape[1]
    for k in range(width):
        physical[which[order], place * width + k] = quads.physical[order, k]
    return MshElements(quads.kind, quads.numbers[first], quads.nodes[first], physical)


def _numbers(path: str | Path, tags: Index, nodes: Index) -> Index:
    """Positions of nodes among the sorted tags."""
    if not len(tags):
        raise MeshFileError(f"{path}: there are no nodes. Write the file anew.")
    place = np.minimum(np.searchsorted(tags, nodes), len(tags) - 1)
    wrong = tags[place] != nodes
    if wrong.any():
        raise MeshFileError(f"{path}: an element uses node {nodes[wrong][0]}, which is not in the file. Write it anew.")
    return place


def _groups(content: MshContent, dimension: int, parts: list[tuple[Index, int]]) -> dict[str, Index]:
    """Members of the physical groups of a dimension, by name, in the order of their tags."""
    members: dict[int, list[Index]] = {tag: [] for d, tag in content.names if d == dimension}
    start = 0
    for physical, count in parts:
        for tag in np.unique(physical[physical != 0]).tolist():
            members.setdefault(tag, []).append(start + np.flatnonzero((physical == tag).any(axis=1)))
        start += count
    groups: dict[str, list[Index]] = {}
    for tag in sorted(members):
        groups.setdefault(content.names.get((dimension, tag), str(tag)), []).extend(members[tag])
    return {name: np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *lists])) for name, lists in groups.items()}
