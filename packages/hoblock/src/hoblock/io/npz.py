"""hoblock's own mesh files: NumPy archives without pickled objects, exact to the last bit."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.replacing import replacing
from hoblock.mesh import QuadMesh

__all__ = ["read_npz", "write_npz"]

_FORMAT = "hoblock mesh 1"


def write_npz(path: str | Path, mesh: QuadMesh) -> None:
    """Write a mesh with its GLL nodes and all its groups.

    The archive holds ``points`` (n, 2), ``cells`` (e, (p + 1)²), ``order``, ``cell_group_names`` and
    ``edge_group_names`` (texts), and for group k ``cell_group_k`` and ``edge_group_k``.

    Parameters
    ----------
    path : str or Path
        Ends in ``.npz``.
    mesh : QuadMesh
    """
    arrays: dict[str, NDArray[np.generic]] = {
        "format": np.array(_FORMAT),
        "points": mesh.points,
        "cells": mesh.cells,
        "order": np.array(mesh.order),
    }
    for kind, groups in (("cell", mesh.cell_groups), ("edge", mesh.edge_groups)):
        arrays[f"{kind}_group_names"] = np.array(list(groups), dtype=np.str_)
        arrays.update({f"{kind}_group_{k}": members for k, members in enumerate(groups.values())})
    with replacing(path) as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def read_npz(path: str | Path) -> QuadMesh:
    """Read a mesh that `write_npz` wrote.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    QuadMesh

    Raises
    ------
    MeshFileError
        If the file is not such an archive or its parts do not fit together.
    OSError
        If the file cannot be opened.
    """
    try:
        with zipfile.ZipFile(path), np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except (ValueError, EOFError, AttributeError, TypeError, zipfile.BadZipFile, zlib.error) as error:
        raise MeshFileError(f"{path}: not a NumPy archive that can be read ({error}). Write it anew.") from error
    if str(arrays.get("format", "")) != _FORMAT:
        raise MeshFileError(f"{path}: format is {str(arrays.get('format', 'not given'))!r}; expected {_FORMAT!r}.")
    try:
        groups = [
            {str(name): arrays[f"{kind}_group_{k}"] for k, name in enumerate(arrays[f"{kind}_group_names"])}
            for kind in ("cell", "edge")
        ]
        points, cells, order = arrays["points"], arrays["cells"], int(arrays["order"])
    except KeyError as error:
        raise MeshFileError(f"{path}: there is no array {error}; the file is incomplete. Write it anew.") from error
    _check(path, points, cells, order, *groups)
    return QuadMesh(points, cells, order, *groups)


def _check(
    path: str | Path,
    points: NDArray[np.generic],
    cells: NDArray[np.generic],
    order: int,
    cell_groups: Mapping[str, NDArray[np.generic]],
    edge_groups: Mapping[str, NDArray[np.generic]],
) -> None:
    def expect(condition: bool, what: str, got: object, expected: str) -> None:
        if not condition:
            raise MeshFileError(f"{path}: {what} {got}; expected {expected}. Write the file anew.")

    def expect_below(array: NDArray[np.generic], count: int, what: str) -> None:
        expect(np.issubdtype(array.dtype, np.integer), f"{what} have type", array.dtype, "integers")
        if array.size:
            expect(
                int(array.min()) >= 0 and int(array.max()) < count,
                f"{what} run from {array.min()} to",
                array.max(),
                f"0 to {count - 1}",
            )

    expect(order >= 1, "order is", order, "at least 1")
    expect(points.ndim == 2 and points.shape[1] == 2, "points have shape", points.shape, "(n, 2)")
    expect(points.dtype == np.float64, "points have type", points.dtype, "float64")
    size = (order + 1) ** 2
    expect(cells.ndim == 2 and cells.shape[1] == size, "cells have shape", cells.shape, f"(e, {size})")
    expect_below(cells, len(points), "cells")
    for name, members in cell_groups.items():
        expect(members.ndim == 1, f"group {name!r} has shape", members.shape, "(k,)")
        expect_below(members, len(cells), f"elements of group {name!r}")
    for name, members in edge_groups.items():
        expect(members.ndim == 2 and members.shape[1] == 2, f"edge group {name!r} has shape", members.shape, "(k, 2)")
        expect_below(members[:, 0], len(cells), f"elements of edge group {name!r}")
        expect_below(members[:, 1], 4, f"sides of edge group {name!r}")
