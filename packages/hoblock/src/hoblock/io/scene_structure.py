"""`mesh.structure`: a mesh file whose elements are the blocks of a scene."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from hoblock.errors import MeshFileError, SceneError
from hoblock.io.block_file import read_quads
from hoblock.io.table import Table
from hoblock.scene import QuadsScene

__all__ = ["read_quads_of"]


def read_quads_of(mesh: Table, folder: Path) -> QuadsScene:
    """Read the file that ``structure`` names, relative to the folder of the scene.

    Raises
    ------
    SceneError
        If there are vertices, blocks or a template beside it, or the file cannot be read.
    """
    for key in ("vertices", "blocks", "template"):
        if mesh.has(key):
            raise SceneError(
                f"got this beside {mesh.place_of('structure')}, a mesh file that brings vertices and blocks; expected "
                "one of them",
                mesh.place_of(key),
            )
    place = mesh.place_of("structure")
    path = folder / mesh.string("structure")
    try:
        found = read_quads(path)
    except MeshFileError as error:
        raise SceneError(str(error).rstrip("."), place) from error
    except OSError as error:
        problem = f"{path}: cannot be read ({error.strerror}); expected the file of a coarse quad mesh"
        raise SceneError(problem, place) from error
    return replace(found, place=place)
