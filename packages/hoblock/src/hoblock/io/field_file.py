"""Fields in files: values on a grid as text or NumPy archive, values at the nodes of a mesh as NumPy archive."""

from __future__ import annotations

import re
import zipfile
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import FieldError
from hoblock.fields import GridField, MeshField
from hoblock.io.npz import read_npz, write_npz
from hoblock.io.replacing import replacing

Array = NDArray[np.float64]

__all__ = ["read_field", "write_field"]

_VALUES = "values"
_SUFFIXES = (".csv", ".npz", ".txt")


def read_field(path: str | Path, degree: int = 3) -> GridField | MeshField:
    """Read a field from a file.

    Parameters
    ----------
    path : str or Path
        ``.npz`` with the arrays ``x`` (m,), ``y`` (n,), ``values`` (m, n) of a grid, or with a mesh as `write_npz`
        writes it and ``values`` at its nodes; ``.csv`` or ``.txt`` with the columns x, y, value and a line for each
        point of a grid, in any order, separated by commas, semicolons or blanks; one line of headings before them and
        ``#`` comments are skipped.
    degree : int
        Of the spline through values on a grid.

    Returns
    -------
    GridField or MeshField

    Raises
    ------
    FieldError
        If the file does not hold such values.
    MeshFileError
        If the mesh in the file is incomplete.
    OSError
        If the file cannot be read.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        raise FieldError(f"{path}: suffix is {suffix!r}; expected one of {', '.join(_SUFFIXES)}.")
    if suffix != ".npz":
        return _gridded(path, _table(path), degree)
    try:
        with zipfile.ZipFile(path), np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files if name in ("x", "y", _VALUES, "cells")}
    except (ValueError, EOFError, AttributeError, TypeError, zipfile.BadZipFile, zlib.error) as error:
        raise FieldError(f"{path}: not a NumPy archive that can be read ({error}). Write it anew.") from error
    missing = {_VALUES, *(() if "cells" in arrays else ("x", "y"))} - arrays.keys()
    if missing:
        raise FieldError(
            f"{path}: there is no array {', '.join(map(repr, sorted(missing)))}; expected 'x', 'y' and 'values' of a "
            "grid, or a mesh and 'values' at its nodes."
        )
    for name in ("x", "y", _VALUES):
        if name in arrays and arrays[name].dtype.kind not in "fiu":
            raise FieldError(f"{path}: the array {name!r} has type {arrays[name].dtype}; expected real numbers.")
    try:
        if "cells" in arrays:
            return MeshField(read_npz(path), arrays[_VALUES])
        return GridField(arrays["x"], arrays["y"], arrays[_VALUES], degree)
    except FieldError as error:
        raise FieldError(f"{path}: {error}") from error


def write_field(path: str | Path, field: GridField | MeshField) -> None:
    """Write a field as a NumPy archive that `read_field` reads.

    Parameters
    ----------
    path : str or Path
        Ends in ``.npz``.
    field : GridField or MeshField

    Raises
    ------
    FieldError
        If the suffix is another one.
    OSError
        If the file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != ".npz":
        raise FieldError(f"{path}: suffix is {path.suffix!r}; expected '.npz'.")
    if isinstance(field, GridField):
        with replacing(path) as file:
            np.savez_compressed(file, allow_pickle=False, x=field.x, y=field.y, values=field.values)
        return
    write_npz(path, field.mesh)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive, archive.open(f"{_VALUES}.npy", "w") as file:
        np.lib.format.write_array(file, field.values, allow_pickle=False)


def _table(path: Path) -> Array:
    """Three columns of numbers."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise FieldError(f"{path}: not a text file; expected the columns x, y, value.") from error
    rows: list[list[float]] = []
    headed = False
    for number, line in enumerate(lines, start=1):
        text = line.split("#", 1)[0].strip()
        if not text:
            continue
        words = re.split(r"\s*[,;]\s*|\s+", text)
        try:
            x, y, value = (float(word) for word in words)
        except ValueError:
            if not rows and not headed and not re.match(r"[-+.0-9]", text):
                headed = True
                continue
            raise FieldError(f"{path}, line {number}: got {line.strip()!r}; expected x, y and a value.") from None
        rows.append([x, y, value])
    return np.array(rows, dtype=float).reshape(-1, 3)


def _gridded(path: Path, table: Array, degree: int) -> GridField:
    """Put the lines of a table where they belong in the grid that their coordinates make."""
    x, column = np.unique(table[:, 0], return_inverse=True)
    y, row = np.unique(table[:, 1], return_inverse=True)
    uses = np.zeros((len(x), len(y)), dtype=int)
    np.add.at(uses, (column, row), 1)
    if not len(table) or (uses != 1).any():
        where = "nothing"
        if len(table):
            i, j = np.argwhere(uses != 1)[0]
            where = f"{uses[i, j] or 'none'} at ({x[i]:.6g}, {y[j]:.6g})"
        raise FieldError(
            f"{path}: {len(table)} values at {len(x)} different x and {len(y)} different y, {where}; expected one "
            "value at every point of a rectangular grid. Round the coordinates so that equal ones are equal."
        )
    values = np.empty(uses.shape)
    values[column, row] = table[:, 2]
    try:
        return GridField(x, y, values, degree)
    except FieldError as error:
        raise FieldError(f"{path}: {error}") from error
