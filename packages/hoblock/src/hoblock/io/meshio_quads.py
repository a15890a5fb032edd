"""Coarse quad meshes of all the formats that meshio reads, as plain data."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.planar import planar
from hoblock.scene import NodeOrder, QuadsScene

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["meshio_quads"]

_TAGS = ("gmsh:physical", "cell_tags", "su2:tag", "medit:ref", "flac3d:group")
"""Where the readers of meshio put the numbers of groups."""

_FAILURES = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    ImportError,
    LookupError,
    NameError,
    RuntimeError,
    TypeError,
    ValueError,
)
"""What the readers of meshio raise on files that they do not expect, apart from its own error."""

_LAGRANGE = "VTK_LAGRANGE_QUADRILATERAL"


def meshio_quads(path: str | Path) -> QuadsScene:
    """Read the quads of a file with meshio.

    Sets of cells (Abaqus, Exodus …), cell tags (MED) and physical tags name quads and lines. Vertices are named by the
    numbers of the points from 0 on.

    Raises
    ------
    MeshFileError
        If meshio cannot read the file, or it holds something else than quads of one order, lines and points.
    """
    mesh = _read(path)
    counts: dict[str, int] = {}
    for block in mesh.cells:
        counts[block.type] = counts.get(block.type, 0) + len(block.data)
    kinds = [kind for kind, count in counts.items() if count and _is_quad(kind)]
    others = {k: c for k, c in counts.items() if c and not (_is_quad(k) or _is_line(k) or k == "vertex")}
    if others:
        listed = ", ".join(f"{count} of type {kind}" for kind, count in others.items())
        total = sum(counts[kind] for kind in kinds)
        raise MeshFileError(f"{path}: there are cells that are no quads: {listed} beside {total} quads; expected none.")
    if not kinds:
        raise MeshFileError(f"{path}: there are no quads; expected at least one.")
    widths = {block.data.shape[1] for block in mesh.cells if _is_quad(block.type)}
    if len(kinds) > 1 or len(widths) > 1:
        raise MeshFileError(f"{path}: there are quads of types {', '.join(kinds)}; expected one type.")
    quads = _joined(mesh, _is_quad)
    lines = _joined(mesh, _is_line)
    groups = _named(mesh)
    return QuadsScene(
        planar(path, mesh.points),
        quads,
        tuple(str(k) for k in range(len(mesh.points))),
        _order(kinds[0], quads.shape[1]),
        _node_order(kinds[0]),
        block_groups=_members(mesh, groups, _is_quad),
        edge_groups={name: lines[found][:, :2] for name, found in _members(mesh, groups, _is_line).items()},
        place=str(path),
    )


def _read(path: str | Path) -> Any:
    import meshio

    try:
        return meshio.read(path)
    except SystemExit as error:  # meshio leaves the interpreter where it knows no reader
        raise MeshFileError(f"{path}: meshio does not know how to read this file.") from error
    except (meshio.ReadError, *_FAILURES) as error:
        raise MeshFileError(
            f"{path}: meshio cannot read it ({type(error).__name__}: {str(error) or 'no reason given'}). Convert the "
            "mesh to .msh or .vtu."
        ) from error


def _is_quad(kind: str) -> bool:
    return re.fullmatch(r"quad\d*", kind) is not None or kind == _LAGRANGE


def _is_line(kind: str) -> bool:
    return re.fullmatch(r"line\d*", kind) is not None or kind == "VTK_LAGRANGE_CURVE"


def _order(kind: str, count: int) -> int:
    """Order of a quad with so many nodes; 8 and 12 are those of sides and corners alone."""
    return count // 4 if kind in ("quad8", "quad12") else round(count**0.5) - 1


def _node_order(kind: str) -> NodeOrder:
    return "vtk" if kind == _LAGRANGE else "gmsh"


def _joined(mesh: Any, wanted: Any) -> Index:
    """Nodes of all cells of a kind, one block after the other."""
    blocks = [np.asarray(block.data, dtype=np.int64) for block in mesh.cells if wanted(block.type)]
    return np.concatenate(blocks) if blocks else np.zeros((0, 2), dtype=np.int64)


def _named(mesh: Any) -> dict[str, list[Index]]:
    """Members of named groups in each block of cells."""
    groups: dict[str, list[Index]] = {}
    for name, members in mesh.cell_sets.items():
        if not str(name).startswith("gmsh:"):
            groups[str(name)] = [np.asarray([] if some is None else some, dtype=np.int64) for some in members]
    names = {**_physical_names(mesh), **(getattr(mesh, "cell_tags", None) or {})}
    for key in _TAGS:
        data = [np.asarray(values) for values in mesh.cell_data.get(key, [])]
        for tag in np.unique(np.concatenate(data)).tolist() if data else ():
            for name in names.get(tag, [str(tag)] if tag else []):
                groups[str(name)] = [np.flatnonzero(values == tag) for values in data]
    return groups


def _physical_names(mesh: Any) -> dict[int, list[str]]:
    names: dict[int, list[str]] = {}
    for name, (tag, *_) in mesh.field_data.items():
        names.setdefault(int(tag), []).append(str(name))
    return names


def _members(mesh: Any, groups: dict[str, list[Index]], wanted: Any) -> dict[str, Index]:
    """Members of the groups among the joined cells of a kind; empty groups are left out."""
    result: dict[str, Index] = {}
    for name, members in groups.items():
        start, found = 0, []
        for block, some in zip(mesh.cells, members, strict=False):
            if wanted(block.type):
                found.append(start + some)
                start += len(block.data)
        joined = np.concatenate(found) if found else np.zeros(0, dtype=np.int64)
        if joined.size:
            result[name] = joined.astype(np.int64)
    return result
