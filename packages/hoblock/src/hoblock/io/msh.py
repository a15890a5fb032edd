"""Gmsh's MSH files, version 2.2, binary."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.equispaced import equispaced_points
from hoblock.mesh import QuadMesh
from hoblock.node_order import line_node_order, node_order
from hoblock.numbering import side_nodes

Index = NDArray[np.int64]

__all__ = ["write_msh"]

_HIGHEST_ORDER = 10


def write_msh(path: str | Path, mesh: QuadMesh) -> None:
    """Write a mesh for Gmsh and the many programs that read its files.

    Quads have the type of their order (quad, quad9, quad16 …). Groups of elements become physical surfaces, groups of
    element sides physical curves made of lines of the same order. An edge in several groups is written once for each.

    Parameters
    ----------
    path : str or Path
    mesh : QuadMesh
        Of order 1 to 10, each element in at most one group.

    Raises
    ------
    MeshFileError
        If the format cannot hold the mesh.

    References
    ----------
    Gmsh reference manual, "MSH file format version 2 (Legacy)", https://gmsh.info/doc/texinfo/gmsh.html.
    """
    import meshio

    if mesh.order > _HIGHEST_ORDER:
        raise MeshFileError(
            f"{path}: the mesh has order {mesh.order}; Gmsh's files hold orders 1 to {_HIGHEST_ORDER}. "
            "Write .vtu or .npz, or lower the order."
        )
    _check_groups(path, mesh)
    blocks: list[tuple[str, Index]] = []
    tags: list[Index] = []
    names: dict[str, Index] = {}
    for tag, (name, sides) in enumerate(mesh.edge_groups.items(), start=1):
        names[name] = np.array([tag, 1])
        nodes = mesh.cells[sides[:, 0, None], side_nodes(mesh.order)[sides[:, 1]]]
        blocks.append((_cell_type("line", mesh.order), nodes[:, line_node_order(mesh.order, "gmsh")]))
        tags.append(np.full(len(sides), tag))
    quads, surface_tags = _tagged_quads(mesh, names)
    blocks.append((_cell_type("quad", mesh.order), quads))
    tags.append(surface_tags)
    points = np.pad(equispaced_points(mesh), ((0, 0), (0, 1)))
    # Every entity needs a number of its own, those without a name too; a physical tag of 0 means none.
    entities = [np.where(tag == 0, len(names) + 1, tag) for tag in tags]
    cell_data = {"gmsh:physical": tags, "gmsh:geometrical": entities}
    file = meshio.Mesh(points, blocks, cell_data=cell_data, field_data=names)
    meshio.write(path, file, file_format="gmsh22", binary=True)


def _tagged_quads(mesh: QuadMesh, names: dict[str, Index]) -> tuple[Index, Index]:
    """Quads in Gmsh's node order and their physical tags, which are added to ``names``."""
    tags = np.zeros(len(mesh.cells), dtype=np.int64)
    first = len(names) + 1
    for tag, (name, members) in enumerate(mesh.cell_groups.items(), start=first):
        names[name] = np.array([tag, 2])
        tags[members] = tag
    return mesh.cells[:, node_order(mesh.order, "gmsh")], tags


def _check_groups(path: str | Path, mesh: QuadMesh) -> None:
    both = sorted(mesh.cell_groups.keys() & mesh.edge_groups.keys())
    if both:
        raise MeshFileError(
            f"{path}: {', '.join(map(repr, both))} names elements and edges; a .msh file needs "
            "different names for them. Rename one."
        )
    uses = np.zeros(len(mesh.cells), dtype=np.int64)
    for name, members in mesh.cell_groups.items():
        uses[members] += 1
        if (uses[members] > 1).any():
            element = int(members[np.argmax(uses[members])])
            raise MeshFileError(
                f"{path}: element {element} is in group {name!r} and in another one; a .msh file holds "
                "one group an element. Write .npz or .vtu, or remove a group."
            )


def _cell_type(shape: str, order: int) -> str:
    count = order + 1 if shape == "line" else (order + 1) ** 2
    return shape if order == 1 else f"{shape}{count}"
