"""Mesh files of all formats, told apart by their suffix or by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from hoblock.errors import MeshFileError
from hoblock.io.abaqus import write_abaqus
from hoblock.io.ism import write_ism
from hoblock.io.mfem import read_mfem, write_mfem
from hoblock.io.msh import read_msh, write_msh
from hoblock.io.npz import read_npz, write_npz
from hoblock.io.vtu import read_vtu, write_vtu
from hoblock.mesh import QuadMesh
from hoblock.spelling import suggestion

__all__ = ["FORMATS", "Format", "read_mesh", "write_mesh"]


@dataclass(frozen=True)
class Format:
    """How to write and read a format.

    Attributes
    ----------
    suffix : str or None
        None where another format is meant by the suffix of its files.
    write : callable
        Takes a path, a mesh and options by keyword.
    read : callable or None
        Takes a path; None if the format cannot be read.
    """

    suffix: str | None
    write: Callable[..., None]
    read: Callable[[str | Path], QuadMesh] | None = None


FORMATS: Mapping[str, Format] = {
    "abaqus": Format(".inp", write_abaqus),
    "gmsh": Format(".msh", write_msh, read_msh),
    "gmsh22": Format(None, partial(write_msh, version="2.2"), read_msh),
    "gmsh41": Format(None, partial(write_msh, version="4.1"), read_msh),
    "ism": Format(None, write_ism),
    "ism-mm": Format(None, partial(write_ism, version="ISM-MM")),
    "ism-v2": Format(None, partial(write_ism, version="ISM-V2")),
    "mfem": Format(".mesh", write_mfem, read_mfem),
    "npz": Format(".npz", write_npz, read_npz),
    "vtu": Format(".vtu", write_vtu, read_vtu),
}
"""Mesh files by the name of their format."""


def write_mesh(path: str | Path, mesh: QuadMesh, *, format: str | None = None, **options: Any) -> None:
    """Write a mesh in the format that the suffix names.

    Parameters
    ----------
    path : str or Path
        ``.msh`` (Gmsh), ``.vtu`` (VTK, ParaView), ``.mesh`` (MFEM), ``.inp`` (Abaqus) or ``.npz`` (hoblock's own).
        An existing file is overwritten.
    mesh : QuadMesh
    format : str, optional
        One of `FORMATS`, instead of the suffix: ``"ism"`` for HOHQMesh's ``.mesh`` files, ``"gmsh22"`` or
        ``"gmsh41"`` for a certain version.
    **options
        Keywords of the format's own function, for example ``point_data`` of `hoblock.io.vtu.write_vtu`.

    Raises
    ------
    MeshFileError
        If suffix or format are unknown or the format cannot hold the mesh.
    OSError
        If the file cannot be written.
    """
    _format(path, format, readable=False).write(path, mesh, **options)


def read_mesh(path: str | Path, *, format: str | None = None) -> QuadMesh:
    """Read a mesh with its groups, in the format that the suffix names.

    Parameters
    ----------
    path : str or Path
        ``.msh``, ``.vtu``, ``.mesh`` (MFEM) or ``.npz``.
    format : str, optional
        One of the `FORMATS` that can be read, instead of the suffix.

    Returns
    -------
    QuadMesh

    Raises
    ------
    MeshFileError
        If suffix or format are unknown, the file cannot be understood or holds something else than quadrilaterals of
        one order in the plane.
    OSError
        If the file cannot be opened.
    """
    read = _format(path, format, readable=True).read
    if read is None:
        raise MeshFileError(
            f"{path}: files of format {format!r} can only be written; "
            f"expected one of {', '.join(_names(readable=True))}."
        )
    return read(path)


def _names(*, readable: bool) -> list[str]:
    return [name for name, form in FORMATS.items() if form.read is not None or not readable]


_SERIES = {
    ".pvd": "A .pvd file lists the .vtu files of a series: take one of these; hoblock.io.pvd.PvdSeries writes series.",
    ".vtkhdf": "hoblock.io.vtkhdf.VtkhdfSeries writes these series; they cannot be read back.",
}


def _format(path: str | Path, name: str | None, *, readable: bool) -> Format:
    if name is not None:
        if name not in FORMATS:
            known = _names(readable=readable)
            raise MeshFileError(
                f"{path}: format is {name!r}; expected one of {', '.join(known)}. {suggestion(name, known)}".rstrip()
            )
        return FORMATS[name]
    suffix = Path(path).suffix.lower()
    suffixes = {form.suffix: form for form in FORMATS.values() if form.suffix and (form.read or not readable)}
    if suffix not in suffixes:
        raise MeshFileError(
            f"{path}: suffix is {suffix!r}; expected one of {', '.join(sorted(map(str, suffixes)))}. "
            + _SERIES.get(suffix, "For a file of another name say the format (format=…, --format on the command line).")
        )
    return suffixes[suffix]
