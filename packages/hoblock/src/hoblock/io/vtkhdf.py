"""Moving meshes in one VTKHDF file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.extras import import_extra
from hoblock.io.group_names import check_names
from hoblock.io.pvd import check_time
from hoblock.io.vtk_arrays import Data, VtkCells, cell_arrays, group_arrays, point_arrays
from hoblock.mesh import QuadMesh

AnyArray = NDArray[np.generic]

__all__ = ["VtkhdfSeries"]

_OFFSETS = ("PointDataOffsets", "CellDataOffsets")


class VtkhdfSeries:
    """A moving mesh as one file that ParaView opens with times; needs the extra ``hdf`` (h5py).

    Elements and groups are stored once, positions and data for each step. Between steps the file is closed and
    complete as far as it goes.

    Parameters
    ----------
    path : path-like
        Usually ends in ``.vtkhdf``. A file of that name is replaced at the first step.

    Raises
    ------
    MissingExtraError
        If h5py is not installed.

    References
    ----------
    https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.html
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._h5py = import_extra("h5py", "hdf")
        self.path = Path(path)
        self._mesh: QuadMesh | None = None
        self._names: tuple[dict[str, tuple[int, ...]], ...] = ()
        self._times: list[float] = []

    @property
    def times(self) -> tuple[float, ...]:
        """Times written so far."""
        return tuple(self._times)

    def write(
        self, time: float, mesh: QuadMesh, *, point_data: Data | None = None, cell_data: Data | None = None
    ) -> None:
        """Add a step.

        Parameters
        ----------
        time : float
            Later than the last one.
        mesh : QuadMesh
            With the cells of the first step; its points and the data may differ.
        point_data, cell_data : mapping of str to array_like, optional
            As for `hoblock.io.vtu.write_vtu`; with the same names and shapes at every step.

        Raises
        ------
        MeshFileError
            If the cells or the names and shapes of the data are not those of the first step.
        ValueError
            If the time is not later, or as for `hoblock.io.vtu.write_vtu`.
        OSError
            If the file cannot be written.
        """
        check_time(time, self._times[-1] if self._times else None)
        check_names(self.path, [*mesh.cell_groups, *mesh.edge_groups, *(point_data or {}), *(cell_data or {})])
        arrays = {"PointData": point_arrays(mesh, point_data), "CellData": cell_arrays(mesh, cell_data)}
        cells = VtkCells.of(mesh)
        names = tuple({name: values.shape for name, values in group.items()} for group in arrays.values())
        if self._mesh is None:
            part = self.path.with_name(self.path.name + ".part")
            try:
                with self._h5py.File(part, "w") as file:
                    _start(file.create_group("VTKHDF", track_order=True), mesh, cells, arrays)
                    _append(file["VTKHDF"], float(time), cells.points, arrays)
                os.replace(part, self.path)
            finally:
                part.unlink(missing_ok=True)
            self._mesh, self._names = mesh, names
        else:
            self._check(mesh, names)
            with self._h5py.File(self.path, "r+") as file:
                _append(file["VTKHDF"], float(time), cells.points, arrays)
        self._times.append(float(time))

    def _check(self, mesh: QuadMesh, names: tuple[dict[str, tuple[int, ...]], ...]) -> None:
        first = self._mesh
        if first is None or not (mesh.cells is first.cells or np.array_equal(mesh.cells, first.cells)):
            raise MeshFileError(
                f"{self.path}: the mesh has other cells than that of the first step; only points may change. "
                "Write a series of .vtu files (PvdSeries)."
            )
        if names != self._names:
            raise MeshFileError(
                f"{self.path}: data are {_listed(names)}; expected those of the first step, {_listed(self._names)}."
            )


def _listed(names: tuple[dict[str, tuple[int, ...]], ...]) -> str:
    return ", ".join(f"{name} {shape}" for group in names for name, shape in group.items()) or "none"


def _start(root: Any, mesh: QuadMesh, cells: VtkCells, arrays: dict[str, dict[str, AnyArray]]) -> None:
    """Everything that does not change, and empty data sets for the rest."""
    root.attrs["Version"] = np.array([2, 1])
    root.attrs["Type"] = np.bytes_(b"UnstructuredGrid")
    sizes = {
        "NumberOfPoints": len(cells.points),
        "NumberOfCells": len(cells.types),
        "NumberOfConnectivityIds": len(cells.connectivity),
    }
    for name, size in sizes.items():
        root.create_dataset(name, data=np.array([size]))
    root.create_dataset("Connectivity", data=cells.connectivity)
    root.create_dataset("Offsets", data=cells.offsets)
    root.create_dataset("Types", data=cells.types)
    _extensible(root, "Points", cells.points)
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    _extensible(steps, "Values", np.zeros(1))
    for name in ("PartOffsets", "NumberOfParts", "PointOffsets"):
        _extensible(steps, name, np.zeros(1, dtype=np.int64))
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        _extensible(steps, name, np.zeros((1, 1), dtype=np.int64))
    for (group, members), offsets in zip(arrays.items(), _OFFSETS, strict=True):
        root.create_group(group)
        steps.create_group(offsets)
        for name, values in members.items():
            _extensible(root[group], _path(name), values)
            _extensible(steps[offsets], _path(name), np.zeros(1, dtype=np.int64))
    fields = root.create_group("FieldData")
    steps.create_group("FieldDataOffsets")
    steps.create_group("FieldDataSizes")
    for name, sides in group_arrays(mesh).items():
        fields.create_dataset(_path(name), data=sides)
        _extensible(steps["FieldDataOffsets"], _path(name), np.zeros(1, dtype=np.int64))
        _extensible(steps["FieldDataSizes"], _path(name), np.zeros((1, 2), dtype=np.int64))


def _path(name: str) -> str:
    """Name of a data set; a slash would make groups."""
    return name.replace("/", "∕")


def _extensible(group: Any, name: str, like: AnyArray) -> None:
    rows = max(64, min(len(like), (1 << 18) // max(1, like.itemsize * int(np.prod(like.shape[1:])))))
    group.create_dataset(
        name,
        shape=(0, *like.shape[1:]),
        maxshape=(None, *like.shape[1:]),
        chunks=(rows, *like.shape[1:]),
        dtype=like.dtype,
    )


def _append(root: Any, time: float, points: AnyArray, arrays: dict[str, dict[str, AnyArray]]) -> None:
    """Add a step. The number of steps comes last: what a failure left behind is overwritten or passed over."""
    steps = root["Steps"]
    number = int(steps.attrs["NSteps"])
    entries = {"Values": time, "PartOffsets": 0, "NumberOfParts": 1, "CellOffsets": 0, "ConnectivityIdOffsets": 0}
    entries["PointOffsets"] = _extended(root["Points"], points)
    for (group, members), offsets in zip(arrays.items(), _OFFSETS, strict=True):
        for name, values in members.items():
            entries[f"{offsets}/{_path(name)}"] = _extended(root[group][_path(name)], values)
    for name, value in entries.items():
        _set(steps[name], number, value)
    for name, members in root["FieldData"].items():
        _set(steps["FieldDataOffsets"][name], number, 0)
        _set(steps["FieldDataSizes"][name], number, [members.shape[1] if members.ndim > 1 else 1, members.shape[0]])
    steps.attrs["NSteps"] = number + 1


def _extended(data: Any, values: AnyArray) -> int:
    """Append rows and return where they begin."""
    count = int(data.shape[0])
    data.resize(count + len(values), axis=0)
    data[count:] = values
    return count


def _set(data: Any, number: int, value: float | list[int]) -> None:
    data.resize(number + 1, axis=0)
    data[number] = value
