"""VTK's unstructured-grid files with fields on Lagrange cells, as ParaView reads them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.extras import import_extra
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.reference import equispaced
from hofsi.fem.resampling import gathered, resampled

Array = NDArray[np.float64]

__all__ = ["require_vtk", "write_vtu"]

_LAGRANGE_QUADRILATERAL = 70


def require_vtk() -> None:
    """Raise MissingExtraError where the extra ``vtk`` is not installed."""
    for name in ("vtkCommonCore", "vtkCommonDataModel", "vtkIOXML", "util.numpy_support"):
        _vtk(name)


def write_vtu(path: str | os.PathLike[str], mesh: QuadMesh, points: Array, fields: Mapping[str, Array]) -> None:
    """Write the fields of one time on Lagrange quadrilaterals of the mesh's order; nothing is lost by it.

    Nodes are equispaced in the file. Data are binary and compressed. The file appears complete or not at all.

    Parameters
    ----------
    path : path-like
        Of the file, in an existing directory.
    mesh : QuadMesh
        For its elements.
    points : ndarray, shape (n, 2)
        Positions of the mesh's nodes at that time.
    fields : mapping of str to ndarray, shape (n,), (n, 2) or (n, k)
        Values at the nodes. Fields with two components are written as vectors with a third one, zero.

    Raises
    ------
    MissingExtraError
        If vtk is not installed.
    ValueError
        If a field does not have one row for each node.
    OSError
        If the file cannot be written.
    """
    count = len(mesh.points)
    for name, values in {"points": points, **fields}.items():
        if len(values) != count:
            raise ValueError(f"field {name!r} has {len(values)} rows; expected one for each of the {count} nodes.")
    grid = _vtk("vtkCommonDataModel").vtkUnstructuredGrid()
    positions = _vtk("vtkCommonCore").vtkPoints()
    positions.SetData(_array("points", _spatial(_equispaced(mesh, points))))
    grid.SetPoints(positions)
    grid.SetCells(_LAGRANGE_QUADRILATERAL, _cells(mesh))
    for name, values in fields.items():
        values = _equispaced(mesh, values)
        pair = values.ndim == 2 and values.shape[1] == 2
        grid.GetPointData().AddArray(_array(name, _spatial(values) if pair else values))
    _write(Path(path), grid)


def _vtk(module: str) -> ModuleType:
    return import_extra(f"vtkmodules.{module}", "vtk", "hofsi-coupler")


def _equispaced(mesh: QuadMesh, values: Array) -> Array:
    """Nodal values with every element's nodes equispaced."""
    return gathered(resampled(values[mesh.cells], equispaced(mesh.order)), mesh.cells, len(values))


def _spatial(values: Array) -> Array:
    return np.pad(values, ((0, 0), (0, 1)))


def _array(name: str, values: Array) -> Any:
    array = _vtk("util.numpy_support").numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName(name)
    return array


def _cells(mesh: QuadMesh) -> Any:
    nodes = mesh.cells[:, node_order(mesh.order, "vtk")]
    convert = _vtk("util.numpy_support").numpy_to_vtkIdTypeArray
    cells = _vtk("vtkCommonDataModel").vtkCellArray()
    cells.SetData(
        convert(np.arange(len(nodes) + 1, dtype=np.int64) * nodes.shape[1], deep=1),
        convert(np.ascontiguousarray(nodes, dtype=np.int64).ravel(), deep=1),
    )
    return cells


def _write(path: Path, grid: Any) -> None:
    writer = _vtk("vtkIOXML").vtkXMLUnstructuredGridWriter()
    part = path.with_name(path.name + ".part")
    writer.SetFileName(os.fspath(part))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    if not path.parent.is_dir() or writer.Write() != 1:
        part.unlink(missing_ok=True)
        raise OSError(f"{path}: could not be written. Check that the directory exists, and the space on the disk.")
    os.replace(part, path)
