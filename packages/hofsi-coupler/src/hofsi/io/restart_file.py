"""Restart files: all that a run goes on from, as arrays and JSON text in a NumPy archive without pickled objects."""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.io.replacing import replacing
from hofsi.build import Problem
from hofsi.case_values import case_values
from hofsi.errors import RestartError
from hofsi.io.restart_tree import TreeReader, TreeWriter
from hofsi.io.summary import versions
from hofsi.records import StepRecord

if TYPE_CHECKING:
    from hofsi.motion import MeshPosition, MeshState

Array = NDArray[np.float64]

__all__ = ["RESTART_FILE", "RestartFile", "read_restart", "write_restart"]

RESTART_FILE = "restart.npz"
"""Its name in the directory of a run."""

_FORMAT = 1  # to be raised when what a run keeps between steps, or what an observer knows, has other fields
_NAME = "hofsi restart"
_BROKEN = (ValueError, KeyError, TypeError, IndexError, AttributeError, zipfile.BadZipFile, zlib.error, EOFError)


@dataclass(frozen=True, eq=False)
class RestartFile:
    """What is in a restart file.

    Attributes
    ----------
    path : Path
    values : mapping of str to str
        Of the case, by `hofsi.case_values.case_values`.
    mesh : str
        What tells the nodes of the meshes from others.
    versions : mapping of str to str
        Of the packages that wrote it.
    """

    path: Path
    values: Mapping[str, str]
    mesh: str
    versions: Mapping[str, str]
    _content: Mapping[str, Any]
    _arrays: list[NDArray[Any]]

    @staticmethod
    def mesh_of(problem: Problem) -> str:
        """What tells the nodes of the meshes of a problem from others."""
        return _digest(problem)

    def content(self, problem: Problem) -> tuple[StepRecord, dict[str, Any]]:
        """The step to go on after, and what the observers know.

        Parameters
        ----------
        problem : Problem
            With the same meshes.

        Raises
        ------
        RestartError
            If the contents are not those of a run of this problem.
        """
        reader = TreeReader(list(self._arrays), _known(problem))
        try:
            position = reader.value(self._content["mesh"])
            mesh = None
            if problem.fluid is not None:
                motion = problem.fluid.motion
                if position is not None and motion is not None:
                    mesh = motion.state_at(position)
                    reader.exchange(position.points, mesh.mesh.points)
                else:
                    mesh = problem.march.initial(0.0).mesh
            record: StepRecord = reader.value(self._content["record"])
            observers: dict[str, Any] = reader.value(self._content["observers"])
            return replace(record, state=replace(record.state, mesh=mesh)), observers
        except _BROKEN as error:
            raise RestartError(
                f"{self.path}: its contents are not those of a run ({type(error).__name__}: {error}); expected what "
                "hofsi wrote. Take another restart file, or run from the start, without --resume."
            ) from error


def write_restart(
    path: str | os.PathLike[str], problem: Problem, record: StepRecord, observers: Mapping[str, object]
) -> None:
    """Write a restart file; it is complete and on the disk when it takes the place of an older one.

    Parameters
    ----------
    path : path-like
    problem : Problem
    record : StepRecord
        The step to go on after.
    observers : mapping of str to object
        What each of the observers knows: plain values and arrays.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    writer = TreeWriter(_known(problem))
    mesh = record.state.mesh
    moving = mesh is not None and problem.fluid is not None and problem.fluid.motion is not None
    content = {
        "mesh": writer.plain(_position(mesh) if mesh is not None and moving else None),
        "record": writer.plain(replace(record, state=replace(record.state, mesh=None))),
        "observers": writer.plain(observers),
    }
    head = {
        "name": _NAME,
        "format": _FORMAT,
        "versions": versions(),
        "values": case_values(problem.case),
        "mesh": _digest(problem),
        "arrays": len(writer.arrays),
    }
    arrays = {f"array_{k}": array for k, array in enumerate(writer.arrays)}
    with replacing(path) as file:
        np.savez(file, allow_pickle=False, head=_bytes(head), content=_bytes(content), **arrays)
        file.flush()
        os.fsync(file.fileno())


def read_restart(path: str | os.PathLike[str]) -> RestartFile:
    """Read a restart file.

    Raises
    ------
    RestartError
        If there is none, it is damaged, or of another format.
    OSError
        If it cannot be read.
    """
    path = Path(path)
    if not path.is_file():
        raise RestartError(
            f"{path}: there is no restart file; expected one that a run wrote. Runs write them when they are broken "
            "off, and as output.checkpoint_every says. Name another file, or run from the start, without --resume."
        )
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            head = _read(archive, "head")
            if head["name"] != _NAME:
                raise ValueError(f"name {head['name']!r}")
            _check_format(path, head)
            arrays = [archive[f"array_{k}"] for k in range(head["arrays"])]
            content = _read(archive, "content")
            return RestartFile(path, dict(head["values"]), str(head["mesh"]), dict(head["versions"]), content, arrays)
    except _BROKEN as error:
        raise RestartError(
            f"{path}: is not a restart file of hofsi, or is damaged ({type(error).__name__}: {error}). Take another "
            "one, or run from the start, without --resume."
        ) from error


def _check_format(path: Path, head: Mapping[str, Any]) -> None:
    if head["format"] != _FORMAT:
        raise RestartError(
            f"{path}: has the format {head['format']}, written by hofsi {head['versions']['hofsi']}; expected format "
            f"{_FORMAT}, which hofsi {versions()['hofsi']} knows. Go on with the version that wrote it, or run from "
            "the start, without --resume."
        )


def _bytes(plain: object) -> NDArray[np.uint8]:
    return np.frombuffer(json.dumps(plain, allow_nan=False).encode("utf-8"), dtype=np.uint8)


def _read(archive: Any, name: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(archive[name].tobytes().decode("utf-8"))
    return data


def _position(mesh: MeshState) -> MeshPosition:
    from hofsi.motion import MeshPosition

    return MeshPosition.of(mesh)


def _meshes(problem: Problem) -> dict[str, QuadMesh]:
    parts = {"fluid": problem.fluid, "solid": problem.solid}
    return {name: part.mesh for name, part in parts.items() if part is not None}


def _known(problem: Problem) -> dict[str, Array]:
    """Arrays of the problem that a state may hold."""
    return {name: mesh.points for name, mesh in _meshes(problem).items()}


def _digest(problem: Problem) -> str:
    """What tells the meshes of a problem from others."""
    digest = hashlib.sha256()
    for name, mesh in _meshes(problem).items():
        for array in (mesh.points, mesh.cells):
            digest.update(f"{name} {array.shape}".encode())
            digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
