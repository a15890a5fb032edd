"""A mesh and its data as the arrays of VTK's unstructured grids; VTU and VTKHDF files share them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hoblock.errors import MeshFileError
from hoblock.io.equispaced import equispaced_points, equispaced_values
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.quality import scaled_jacobian

Array = NDArray[np.float64]
Index = NDArray[np.int64]
AnyArray = NDArray[np.generic]
Data = Mapping[str, ArrayLike]

__all__ = ["LAGRANGE_QUADRILATERAL", "QUAD", "Data", "VtkCells", "cell_arrays", "group_arrays", "point_arrays"]

QUAD = 9
LAGRANGE_QUADRILATERAL = 70


@dataclass(frozen=True, eq=False)
class VtkCells:
    """Cells of an unstructured grid: linear quads for order 1, Lagrange quadrilaterals above.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Equispaced nodes.
    connectivity : ndarray, shape (e (p + 1)²,)
    offsets : ndarray, shape (e + 1,)
        Beginning with 0.
    types : ndarray of uint8, shape (e,)
    """

    points: Array
    connectivity: Index
    offsets: Index
    types: NDArray[np.uint8]

    @classmethod
    def of(cls, mesh: QuadMesh) -> VtkCells:
        """Cells of a mesh of any order."""
        count, size = mesh.cells.shape
        return cls(
            np.pad(equispaced_points(mesh), ((0, 0), (0, 1))),
            mesh.cells[:, node_order(mesh.order, "vtk")].ravel(),
            np.arange(count + 1, dtype=np.int64) * size,
            np.full(count, QUAD if mesh.order == 1 else LAGRANGE_QUADRILATERAL, dtype=np.uint8),
        )


def point_arrays(mesh: QuadMesh, data: Data | None) -> dict[str, AnyArray]:
    """Fields at the nodes of a mesh as arrays at its equispaced nodes.

    Parameters
    ----------
    mesh : QuadMesh
    data : mapping of str to array_like, shape (n,) or (n, k), optional
        Values at the GLL nodes. Two components get a third one, zero: to VTK they are a vector then.

    Raises
    ------
    ValueError
        If an array does not have one row for each node.
    """
    arrays = _checked(data, len(mesh.points), "point_data", "node")
    return {name: _spatial(equispaced_values(mesh, values.astype(float))) for name, values in arrays.items()}


def cell_arrays(mesh: QuadMesh, data: Data | None) -> dict[str, AnyArray]:
    """Quality, groups and the given data of the elements.

    Parameters
    ----------
    mesh : QuadMesh
    data : mapping of str to array_like, shape (e,) or (e, k), optional

    Returns
    -------
    dict of str to ndarray
        ``scaled_jacobian`` (unless the data have one), an int32 array for each group of elements (1 inside, 0
        outside), and the data.

    Raises
    ------
    MeshFileError
        If a group has the name of an array.
    ValueError
        If an array does not have one row for each element.
    """
    given = _checked(data, len(mesh.cells), "cell_data", "element")
    arrays = given if "scaled_jacobian" in given else {"scaled_jacobian": scaled_jacobian(mesh), **given}
    for name, members in mesh.cell_groups.items():
        if name in arrays:
            raise MeshFileError(f"the group {name!r} has the name of an array of cell data. Rename one of them.")
        arrays[name] = np.zeros(len(mesh.cells), dtype=np.int32)
        arrays[name][members] = 1
    return {name: _spatial(values) for name, values in arrays.items()}


def group_arrays(mesh: QuadMesh) -> dict[str, Index]:
    """Groups as field data: ``cell_group:NAME`` (k,) elements, ``edge_group:NAME`` (k, 2) elements and sides."""
    return {
        f"{kind}_group:{name}": np.asarray(members, dtype=np.int64)
        for kind, groups in (("cell", mesh.cell_groups), ("edge", mesh.edge_groups))
        for name, members in groups.items()
    }


def _checked(data: Data | None, count: int, what: str, owner: str) -> dict[str, AnyArray]:
    arrays = {name: np.asarray(values) for name, values in (data or {}).items()}
    for name, values in arrays.items():
        if values.ndim not in (1, 2) or len(values) != count:
            raise ValueError(
                f"{what}[{name!r}] has shape {values.shape}; expected one row for each {owner}: "
                f"({count},) or ({count}, k)."
            )
        if values.dtype.kind not in "biuf":
            raise ValueError(f"{what}[{name!r}] has type {values.dtype}; expected real numbers.")
    return arrays


def _spatial(values: AnyArray) -> AnyArray:
    values = values.astype(np.uint8) if values.dtype.kind == "b" else values
    values = values.astype(np.float64) if values.dtype.kind == "f" else values
    return np.pad(values, ((0, 0), (0, 1))) if values.ndim == 2 and values.shape[1] == 2 else values
