"""VTK's unstructured-grid files with Lagrange cells, as ParaView reads them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.io.equispaced import equispaced_points
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.quality import scaled_jacobian

__all__ = ["write_vtu"]


def write_vtu(path: str | Path, mesh: QuadMesh) -> None:
    """Write a mesh for VTK and ParaView: linear quads for order 1, Lagrange quadrilaterals above.

    The cell data are an integer array for each group of elements (1 inside, 0 outside) and the elements'
    ``scaled_jacobian``. Groups of element sides are not written.

    Parameters
    ----------
    path : str or Path
    mesh : QuadMesh
        Of any order.
    """
    import meshio

    cell_type = "quad" if mesh.order == 1 else "VTK_LAGRANGE_QUADRILATERAL"
    cells = mesh.cells[:, node_order(mesh.order, "vtk")]
    data: dict[str, list[NDArray[np.generic]]] = {"scaled_jacobian": [scaled_jacobian(mesh)]}
    for name, members in mesh.cell_groups.items():
        inside = np.zeros(len(mesh.cells), dtype=np.int32)
        inside[members] = 1
        data[name] = [inside]
    points = np.pad(equispaced_points(mesh), ((0, 0), (0, 1)))
    meshio.write(path, meshio.Mesh(points, [(cell_type, cells)], cell_data=data), file_format="vtu")
