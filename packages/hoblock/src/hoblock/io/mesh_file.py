"""Mesh files of all formats, told apart by their suffix."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hoblock.errors import MeshFileError
from hoblock.io.msh import write_msh
from hoblock.io.npz import write_npz
from hoblock.io.vtu import write_vtu
from hoblock.mesh import QuadMesh

__all__ = ["write_mesh"]

_WRITERS: dict[str, Callable[[str | Path, QuadMesh], None]] = {".msh": write_msh, ".npz": write_npz, ".vtu": write_vtu}


def write_mesh(path: str | Path, mesh: QuadMesh) -> None:
    """Write a mesh in the format that the suffix names.

    Parameters
    ----------
    path : str or Path
        ``.msh`` (Gmsh 2.2), ``.vtu`` (VTK, ParaView) or ``.npz`` (hoblock's own, read by `hoblock.io.npz.read_npz`).
        An existing file is overwritten.
    mesh : QuadMesh

    Raises
    ------
    MeshFileError
        If the suffix is unknown or the format cannot hold the mesh.
    OSError
        If the file cannot be written.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in _WRITERS:
        raise MeshFileError(f"{path}: suffix is {suffix!r}; expected one of {', '.join(sorted(_WRITERS))}.")
    _WRITERS[suffix](path, mesh)
