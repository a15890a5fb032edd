"""``kind = "level-set"`` of a ``[[mesh.curve]]``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from hoblock.errors import FieldError, MeshFileError, SceneError
from hoblock.io.field_file import read_field
from hoblock.io.table import Table
from hoblock.io.values import Limits, number_or_constant_of
from hoblock.scene.curves import Isoline

__all__ = ["read_isoline"]


def read_isoline(table: Table, constants: Mapping[str, float], folder: Path) -> Isoline:
    """Read the function or the values, level, reach and whether vertices are moved; files are sought in ``folder``."""

    def number(key: str, default: float, limits: Limits | None = None) -> float:
        if not table.has(key):
            return default
        return number_or_constant_of(table.raw(key), table.place_of(key), constants, limits)

    by_formula, by_values = table.has("function"), table.has("values")
    if by_formula == by_values:
        got = "both 'function' and 'values'" if by_formula else "neither 'function' nor 'values'"
        raise SceneError(f"a level set with {got}; expected exactly one of them", table.place)
    level, reach = number("level", 0.0), number("reach", 0.5, Limits(above=0.0))
    project = table.boolean("project", False)
    if by_formula:
        return Isoline(table.expression("function", ("x", "y"), constants), level, reach, project)
    place, path = table.place_of("values"), folder / table.string("values")
    degree = table.integer("degree", 3, minimum=1, maximum=5)
    try:
        return Isoline(read_field(path, degree), level, reach, project)
    except OSError as error:
        raise SceneError(f"the file {path} cannot be read: {error.strerror or error}", place) from error
    except (FieldError, MeshFileError) as error:
        raise SceneError(str(error).removesuffix("."), place) from error
