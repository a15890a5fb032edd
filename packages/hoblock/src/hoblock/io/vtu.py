"""VTK's unstructured-grid files with Lagrange cells, as ParaView reads them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.assembly import assembled
from hoblock.io.group_names import check_names
from hoblock.io.replacing import replacing
from hoblock.io.vtk_arrays import LAGRANGE_QUADRILATERAL, QUAD, Data, VtkCells, cell_arrays, group_arrays, point_arrays
from hoblock.io.vtk_xml import VtkXml, VtkXmlError, data_array
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.reference import equispaced

Index = NDArray[np.int64]
AnyArray = NDArray[np.generic]

__all__ = ["read_vtu", "write_vtu"]

_BIQUADRATIC_QUAD = 28
_QUADS = {QUAD, _BIQUADRATIC_QUAD, LAGRANGE_QUADRILATERAL}
_IGNORED = {1, 2, 3, 4, 21, 35, 68}  # vertices, lines and curves
_REFUSED = {
    5: "triangles",
    7: "polygons",
    8: "pixels",
    22: "quadratic triangles",
    23: "quads with eight nodes",
    69: "Lagrange triangles",
    77: "Bézier quadrilaterals",
}


def write_vtu(
    path: str | Path, mesh: QuadMesh, *, point_data: Data | None = None, cell_data: Data | None = None
) -> None:
    """Write a mesh for VTK and ParaView: linear quads for order 1, Lagrange quadrilaterals above.

    The cell data are the elements' ``scaled_jacobian``, an integer array for each group of elements (1 inside, 0
    outside), and what is given. The field data hold all groups exactly, for `read_vtu` and for scripts: an integer
    array ``cell_group:NAME`` of elements for each group of elements, and ``edge_group:NAME``, of pairs (element,
    side), for each group of element sides. Data are binary and compressed; the file appears complete or not at all.

    Parameters
    ----------
    path : str or Path
    mesh : QuadMesh
        Of any order.
    point_data : mapping of str to array_like, shape (n,) or (n, k), optional
        Fields at the nodes. They are resampled at equispaced nodes as the geometry is, which changes nothing in them.
        Two components are written as a vector with a third one, zero.
    cell_data : mapping of str to array_like, shape (e,) or (e, k), optional
        Values of the elements.

    Raises
    ------
    MeshFileError
        If a group of elements has the name of an array of cell data, or a name has control characters.
    ValueError
        If an array does not have one row for each node or element.
    OSError
        If the file cannot be written.

    References
    ----------
    VTK file formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html.
    """
    check_names(path, [*mesh.cell_groups, *mesh.edge_groups, *(point_data or {}), *(cell_data or {})])
    cells = VtkCells.of(mesh)
    sections: dict[str, Mapping[str, AnyArray]] = {
        "PointData": point_arrays(mesh, point_data),
        "CellData": cell_arrays(mesh, cell_data),
        "Points": {"Points": cells.points},
        "Cells": {"connectivity": cells.connectivity, "offsets": cells.offsets[1:], "types": cells.types},
    }
    with replacing(path) as file:
        file.write(
            b'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
            b'header_type="UInt64" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n<FieldData>\n'
        )
        file.writelines(data_array(name, values, tuples=True) for name, values in group_arrays(mesh).items())
        file.write(b"</FieldData>\n")
        file.write(b'<Piece NumberOfPoints="%d" NumberOfCells="%d">\n' % (len(mesh.points), len(mesh.cells)))
        for section, arrays in sections.items():
            file.write(f"<{section}>\n".encode())
            file.writelines(data_array(name, values) for name, values in arrays.items())
            file.write(f"</{section}>\n".encode())
        file.write(b"</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


def read_vtu(path: str | Path) -> QuadMesh:
    """Read a mesh of quads, biquadratic or Lagrange quadrilaterals, by `write_vtu` or another program.

    All cells must have the same order; vertices and lines are ignored. Groups come from the field data that
    `write_vtu` describes. In files without them, each integer array of cell data with no other values than 0 and 1
    makes a group of elements. Points that cells do not share stay apart.

    Parameters
    ----------
    path : str or Path
        With inline or appended data, text, base64 or raw, without compression or with zlib or LZMA.

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
    data = Path(path).read_bytes()
    try:
        file = VtkXml.parse(data)
        return _mesh(path, file)
    except VtkXmlError as error:
        raise MeshFileError(f"{path}: {error}.") from error


def _mesh(path: str | Path, file: VtkXml) -> QuadMesh:
    if file.root.get("type") != "UnstructuredGrid":
        raise VtkXmlError(f"the file holds {file.root.get('type', 'nothing')[:40]!r}; expected 'UnstructuredGrid'")
    pieces = file.root.findall("UnstructuredGrid/Piece")
    if len(pieces) != 1:
        raise VtkXmlError(f"there are {len(pieces)} pieces; expected one. In ParaView: Merge Blocks")
    points = np.asarray(_one(file, pieces[0], "Points"), dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise VtkXmlError(f"points have shape {points.shape}; expected (n, 3)")
    cells, order, kept = _cells(file, pieces[0])
    groups = {
        array.get("Name", ""): file.array(array)
        for array in file.root.findall("UnstructuredGrid/FieldData/DataArray")
        if array.get("Name", "").startswith(("cell_group:", "edge_group:"))
    }
    cell_groups, edge_groups = _groups(groups, len(cells))
    if not groups:
        cell_groups = _flagged(file, pieces[0], kept)
    lexicographic = cells[:, np.argsort(node_order(order, "vtk"))]
    return assembled(
        path, points, lexicographic, order, equispaced(order), cell_groups=cell_groups, edge_groups=edge_groups
    )


def _one(file: VtkXml, piece: Element, section: str, name: str | None = None) -> AnyArray:
    arrays = [array for array in piece.findall(f"{section}/DataArray") if name in (None, array.get("Name"))]
    if len(arrays) != 1:
        raise VtkXmlError(f"{section} has {len(arrays)} arrays{f' {name!r}' if name else ''}; expected one")
    return file.array(arrays[0])


def _integers(file: VtkXml, piece: Element, name: str) -> Index:
    values = _one(file, piece, "Cells", name)
    if values.dtype.kind not in "iu" or values.ndim != 1:
        raise VtkXmlError(f"array {name!r} has type {values.dtype} and shape {values.shape}; expected integers, (n,)")
    return values.astype(np.int64)


def _cells(file: VtkXml, piece: Element) -> tuple[Index, int, NDArray[np.bool_]]:
    """Quads in VTK's node order, their order, and which cells of the file they are."""
    connectivity, ends, types = (_integers(file, piece, name) for name in ("connectivity", "offsets", "types"))
    if len(ends) != len(types) or not len(ends) or ends[-1] > len(connectivity) or (np.diff(ends, prepend=0) < 0).any():
        raise VtkXmlError(f"{len(types)} types, {len(ends)} offsets and {len(connectivity)} nodes do not fit together")
    for kind in np.unique(types).tolist():
        if kind not in _QUADS | _IGNORED:
            found = np.flatnonzero(types == kind)
            raise VtkXmlError(
                f"there are {len(found)} {_REFUSED.get(kind, f'cells of type {kind}')}, the first is cell {found[0]}; "
                "expected quads (types 9, 28, 70) only. Remove them, or write complete quadrilaterals"
            )
    kept = np.isin(types, list(_QUADS))
    sizes = np.diff(ends, prepend=0)[kept]
    if not kept.any():
        raise VtkXmlError("there are no quads; expected at least one")
    if (sizes != sizes[0]).any():
        raise VtkXmlError(f"there are quads of {sizes.min()} and of {sizes.max()} nodes; expected one order")
    order = round(float(sizes[0]) ** 0.5) - 1
    if order < 1 or (order + 1) ** 2 != sizes[0]:
        raise VtkXmlError(f"quads have {sizes[0]} nodes; expected (p + 1)², the same order in both directions")
    starts = (ends - np.diff(ends, prepend=0))[kept]
    return connectivity[starts[:, None] + np.arange(sizes[0])], order, kept


def _groups(arrays: dict[str, AnyArray], count: int) -> tuple[dict[str, Index], dict[str, Index]]:
    cell_groups: dict[str, Index] = {}
    edge_groups: dict[str, Index] = {}
    for key, values in arrays.items():
        kind, name = key.split(":", 1)
        edges = kind == "edge_group"
        if values.dtype.kind not in "iu" or values.ndim != 1 + edges or (edges and values.shape[1] != 2):
            raise VtkXmlError(f"array {key!r} has type {values.dtype} and shape {values.shape}. Write the file anew")
        members = values.astype(np.int64)
        if (members < 0).any() or (members >= np.array([count, 4] if edges else count)).any():
            raise VtkXmlError(f"array {key!r} does not fit the {count} elements. Write the file anew")
        (edge_groups if edges else cell_groups)[name] = members
    return cell_groups, edge_groups


def _flagged(file: VtkXml, piece: Element, kept: NDArray[np.bool_]) -> dict[str, Index]:
    """Groups from cell data of zeros and ones."""
    groups = {}
    for element in piece.findall("CellData/DataArray"):
        if "Int" in element.get("type", ""):
            values = file.array(element)
            if values.shape == kept.shape and np.isin(values, (0, 1)).all():
                groups[element.get("Name", "")] = np.flatnonzero(values[kept])
    return groups
