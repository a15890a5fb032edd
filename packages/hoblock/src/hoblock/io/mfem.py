"""MFEM's mesh files with curved elements and named attribute sets."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.io.assembly import directed_sides
from hoblock.io.group_names import check_names
from hoblock.io.group_sets import boundary_sides, group_sets, named_sides
from hoblock.io.mfem_reading import read_mfem
from hoblock.io.replacing import replacing
from hoblock.mesh import QuadMesh
from hoblock.numbering import number_nodes

Index = NDArray[np.int64]

__all__ = ["read_mfem", "write_mfem"]

_SEGMENT, _SQUARE = 1, 3


def write_mfem(path: str | Path, mesh: QuadMesh, version: str | None = None) -> None:
    """Write a mesh for MFEM and GLVis.

    The geometry is a discontinuous grid function of order p on GLL nodes (``L2_T1_2D_P<p>``): the very nodes of the
    mesh, nothing is resampled. All boundary sides become boundary elements, and so do named sides between elements.
    An element or side has one attribute; where groups overlap, each combination has an attribute of its own, and a
    set lists all of those that belong to its group.

    Parameters
    ----------
    path : str or Path
        Usually ends in ``.mesh``.
    mesh : QuadMesh
        Of any order.
    version : {"1.3", "1.0"}, optional
        Version 1.3 names the sets; MFEM reads it from 4.7 on. Version 1.0 says them in comments only. Default: 1.3 if
        the mesh has groups.

    Raises
    ------
    MeshFileError
        If a name has control characters.
    ValueError
        If the version is neither.
    OSError
        If the file cannot be written.

    References
    ----------
    https://mfem.org/mesh-formats/, https://mfem.org/mesh-format-v1.x/.
    """
    if version not in (None, "1.0", "1.3"):
        raise ValueError(f"write_mfem: version is {version!r}; expected '1.0' or '1.3'.")
    check_names(path, [*mesh.cell_groups, *mesh.edge_groups])
    named = version == "1.3" or (version is None and bool(mesh.cell_groups or mesh.edge_groups))
    with replacing(path) as file:
        file.writelines(part.encode() for part in _parts(mesh, named))


def _parts(mesh: QuadMesh, named: bool) -> Iterator[str]:
    sets, classes = group_sets(mesh.cell_groups, len(mesh.cells))
    sides, members = _sides(mesh)
    side_sets, side_classes = group_sets(members, len(sides))
    yield f"MFEM mesh v1.{3 if named else 0}\n\n"
    if not named:
        yield from _comments("element", mesh.cell_groups, sets)
        yield from _comments("boundary", members, side_sets)
    corners, count = number_nodes(mesh.corners, 1)
    vertex = np.zeros(len(mesh.points), dtype=np.int64)
    vertex[mesh.corners] = corners[:, [0, 1, 3, 2]]
    yield f"dimension\n2\n\nelements\n{len(mesh.cells)}\n"
    yield _table(np.column_stack([classes + 1, np.full(len(classes), _SQUARE), vertex[mesh.corners]]))
    if named:
        yield from _attribute_sets("attribute_sets", mesh.cell_groups, sets)
    ends = vertex[directed_sides(mesh, sides)[:, [0, -1]]]
    yield f"\nboundary\n{len(sides)}\n"
    yield _table(np.column_stack([side_classes + 1, np.full(len(sides), _SEGMENT), ends]))
    if named:
        yield from _attribute_sets("bdr_attribute_sets", members, side_sets)
    yield f"\nvertices\n{count}\n\nnodes\nFiniteElementSpace\nFiniteElementCollection: L2_T1_2D_P{mesh.order}\n"
    yield "VDim: 2\nOrdering: 1\n\n"
    yield "".join(map("{!r} {!r}\n".format, *(mesh.coordinates[..., d].ravel().tolist() for d in range(2))))
    if named:
        yield "\nmfem_mesh_end\n"


def _sides(mesh: QuadMesh) -> tuple[Index, dict[str, Index]]:
    """Named sides and then the other ones on the boundary, and the members of each group."""
    sides, members = named_sides(mesh)
    outer = boundary_sides(mesh)
    new = outer[~np.isin(outer @ [4, 1], sides @ [4, 1])]
    return np.concatenate([sides, new]), members


def _comments(what: str, groups: Mapping[str, Index], sets: list[tuple[int, ...]]) -> Iterator[str]:
    for k, name in enumerate(groups):
        attributes = " ".join(str(number) for number, held in enumerate(sets, start=1) if k in held)
        yield f"# {what} attributes of {name}: {attributes}\n"
    if groups:
        yield "\n"


def _attribute_sets(section: str, groups: Mapping[str, Index], sets: list[tuple[int, ...]]) -> Iterator[str]:
    yield f"\n{section}\n{len(groups)}\n"
    for k, name in enumerate(groups):
        attributes = [str(number) for number, held in enumerate(sets, start=1) if k in held]
        quoted = name.replace("\\", "\\\\").replace('"', '\\"')
        yield f'"{quoted}"\n{len(attributes)}\n{" ".join(attributes)}\n'


def _table(rows: Index) -> str:
    buffer = io.StringIO()
    np.savetxt(buffer, rows, fmt="%d")
    return buffer.getvalue()
