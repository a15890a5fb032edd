"""Block structures from files of coarse quad meshes: every quad becomes a block, names become names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.coarse_quads import structure_from_quads
from hoblock.edge_tables import Ends
from hoblock.errors import MeshFileError, TopologyError
from hoblock.io.gmsh_quads import gmsh_quads
from hoblock.io.mesh_file import FORMATS, read_mesh
from hoblock.io.meshio_quads import meshio_quads
from hoblock.mesh import QuadMesh
from hoblock.numbering import side_nodes
from hoblock.scene import QuadsScene

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["read_quads", "read_structure"]


def read_structure(
    path: str | Path, *, counts: Mapping[Ends, int] | int = 1, tolerance: float | None = None
) -> BlockStructure:
    """Read a coarse quad mesh as a block structure.

    Every quad becomes a block; sides of quads of order 2 and more become curves where they are not straight. Physical
    groups of Gmsh, sets of Abaqus and the like become names of blocks and of edges. Vertices are named by the numbers
    of the nodes in the file (Gmsh), or from 0 on; a physical point of Gmsh names its vertex.

    Parameters
    ----------
    path : str or Path
        ``.msh`` of Gmsh (2.2 and 4.1, text and binary), every format of `hoblock.io.mesh_file.read_mesh`, and what
        meshio reads: Abaqus, VTK, MED, XDMF, Exodus …
    counts : mapping of (vertex, vertex) to int, or int
        Elements along edges, as in `BlockStructure.build`.
    tolerance : float, optional
        Distance of points that become one vertex; 1e-9 of the whole's size if missing.

    Raises
    ------
    MeshFileError
        If the file cannot be understood, holds triangles or other cells beside lines and points, quads of several
        orders, or a third coordinate that is not the same everywhere.
    TopologyError
        If its quads form no block structure, or the counts do not fit; the error names the file.
    OSError
        If the file cannot be opened.
    """
    found = read_quads(path)
    try:
        return structure_from_quads(
            found.points,
            found.quads,
            order=found.order,
            node_order=found.node_order,
            spacing=found.spacing,
            names=found.names,
            block_groups=found.block_groups,
            edge_groups=found.edge_groups,
            counts=counts,
            tolerance=tolerance,
        )
    except TopologyError as error:
        raise TopologyError(f"{path}: {error}") from error


def read_quads(path: str | Path) -> QuadsScene:
    """Read a coarse quad mesh as plain data; see `read_structure`.

    Raises
    ------
    MeshFileError, OSError
        As `read_structure`.
    """
    with Path(path).open("rb"):  # a file that is not there, before any other complaint
        pass
    suffix = Path(path).suffix.lower()
    if suffix == ".msh":
        return gmsh_quads(path)
    if any(known.suffix == suffix and known.read is not None for known in FORMATS.values()):
        return _from_mesh(read_mesh(path), str(path))
    found = meshio_quads(path)
    if not len(found.quads):
        raise MeshFileError(f"{path}: there are no quads; expected at least one.")
    return found


def _from_mesh(mesh: QuadMesh, place: str) -> QuadsScene:
    ends = mesh.cells[:, side_nodes(mesh.order)[:, [0, -1]]]
    return QuadsScene(
        mesh.points,
        mesh.cells,
        tuple(str(k) for k in range(len(mesh.points))),
        mesh.order,
        "lexicographic",
        "gll",
        dict(mesh.cell_groups),
        {name: ends[members[:, 0], members[:, 1]] for name, members in mesh.edge_groups.items()},
        place,
    )
