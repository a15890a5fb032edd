"""The `[mesh]` part of a scene file, read into plain data."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path as FilePath
from types import MappingProxyType
from typing import Any

from hoblock.building.quads import build_quads
from hoblock.building.template import build_template
from hoblock.errors import SceneError
from hoblock.expressions import RESERVED_NAMES, compile_expression
from hoblock.io.scene_curves import read_curve
from hoblock.io.scene_gradings import read_grading
from hoblock.io.scene_paths import check_paths, check_vertices, paths_on_or_leaving
from hoblock.io.scene_structure import read_quads_of
from hoblock.io.scene_template import names_of, read_template
from hoblock.io.table import Table
from hoblock.io.toml import apply_overrides, naming_file, read_toml
from hoblock.io.values import describe
from hoblock.scene import HIGHEST_ORDER, CountScene, MeshScene, Path, Quad, TemplateScene
from hoblock.spelling import suggestion

__all__ = ["constants_of", "load_mesh_scene", "read_mesh_scene"]


def load_mesh_scene(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> MeshScene:
    """Read the mesh of a scene file.

    Parameters
    ----------
    path : path-like
        The TOML file.
    overrides : sequence of str, optional
        Changes such as ``"mesh.order=6"``, see `hoblock.io.toml.apply_overrides`.

    Returns
    -------
    MeshScene
        Plain data.

    Raises
    ------
    SceneError
        If the file cannot be read or anything in its mesh part is wrong; `SceneError.file` names the file.
    """
    data = read_toml(path)
    with naming_file(path):
        data = apply_overrides(data, overrides)
    return read_mesh_scene(data, os.fspath(path))


def read_mesh_scene(data: Mapping[str, Any], file: str) -> MeshScene:
    """Read the mesh of a parsed scene; tables other than `title`, `[constants]` and `[mesh]` are ignored.

    Parameters
    ----------
    data : mapping
        The whole file as a TOML parser gives it.
    file : str
        Name of the file, for error messages.

    Returns
    -------
    MeshScene
        Plain data. Names of vertices are checked; whether the blocks fit together is not.

    Raises
    ------
    SceneError
        If a key is missing, unknown, of the wrong type or out of range, or names a vertex that does not exist.
    """
    with naming_file(file):
        folder = FilePath(file).parent
        whole = Table(data)
        title = whole.string("title", "")
        constants = constants_of(data)
        mesh = whole.table("mesh")
        template = _template(mesh, constants) if mesh.has("template") else None
        quads = read_quads_of(mesh, folder) if mesh.has("structure") else None
        if quads is not None:
            vertices, blocks, edges = names_of(build_quads(quads))
        elif template is None:
            _check_blocks_given(mesh)
            vertices = _vertices(mesh.table("vertices"), constants)
            blocks = _blocks(mesh.table("blocks"), vertices)
            edges = {}
        else:
            vertices, blocks, edges = names_of(build_template(template))
        edges |= _edges(mesh.table("edges", required=False), vertices)
        scene = MeshScene(
            order=mesh.integer("order", minimum=1, maximum=HIGHEST_ORDER),
            vertices=MappingProxyType(vertices),
            blocks=MappingProxyType(blocks),
            edges=MappingProxyType(edges),
            curves=tuple(read_curve(table, vertices, edges, constants, folder) for table in mesh.tables("curve")),
            counts=tuple(_count(table, vertices, edges, blocks) for table in mesh.tables("count")),
            gradings=tuple(read_grading(table, vertices, edges, blocks, constants) for table in mesh.tables("grading")),
            elements=mesh.integer("elements", 1, minimum=1),
            title=title,
            file=file,
            template=template,
            quads=quads,
        )
        mesh.finish()
    return scene


def constants_of(data: Mapping[str, Any]) -> dict[str, float]:
    """Values of `[constants]`, each a number or an expression of the constants above it.

    Parameters
    ----------
    data : mapping
        The whole file as a TOML parser gives it.

    Returns
    -------
    dict of str to float
        In the order of the file.

    Raises
    ------
    SceneError
        If a name cannot be used in expressions, or a value is not a finite number or an expression of
        earlier constants.
    """
    table = Table(data).table("constants", required=False)
    constants: dict[str, float] = {}
    names = tuple(table)
    for name in names:
        place = table.place_of(name)
        value = table.raw(name)
        _check_constant_name(name, place)
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise SceneError(f"got {describe(value)}; expected a number or an expression of earlier constants", place)
        try:
            constants[name] = compile_expression(value, (), constants, place).value
        except SceneError as error:
            later = [other for other in names if other not in constants and f"{other!r} is not known" in error.problem]
            if not later:
                raise
            problem = f"{value!r} uses {later[0]!r}, which is not known yet; move it below that constant"
            if later[0] == name:
                problem = f"{value!r} uses the constant itself; expected a number or constants above it"
            raise SceneError(problem, place) from error
    return constants


def _check_constant_name(name: str, place: str) -> None:
    if name in RESERVED_NAMES:
        raise SceneError(f"{name!r} has a meaning of its own in expressions; choose another name", place)
    if not (name.isascii() and name.isidentifier()):
        raise SceneError(
            f"got the name {name!r}; expected letters a-z, digits and underscores, beginning with a letter", place
        )


def _template(mesh: Table, constants: Mapping[str, float]) -> TemplateScene:
    for key in ("structure", "vertices", "blocks", "elements"):
        if mesh.has(key):
            raise SceneError(
                "got this beside [mesh.template], which brings vertices, blocks and numbers of elements of its own; "
                "expected one of them. Refine a template with its parameters, [[mesh.count]], [[mesh.grading]], "
                "[[mesh.curve]] and [mesh.edges]",
                mesh.place_of(key),
            )
    return read_template(mesh.table("template"), constants)


def _check_blocks_given(mesh: Table) -> None:
    """An error that lists the ways to give blocks, if there are none and nothing looks like a misspelt one of them."""
    ways = ("vertices", "blocks", "template", "structure")
    if any(mesh.has(key) or suggestion(key, mesh) for key in ways):
        return
    raise SceneError(
        "there are no blocks; expected [mesh.vertices] and [mesh.blocks], or [mesh.template], or structure, the name "
        "of a file with a coarse quad mesh",
        mesh.place,
    )


def _vertices(table: Table, constants: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    vertices = {name: table.pair(name, constants=constants) for name in table}
    if not vertices:
        raise SceneError("there are no vertices; expected lines such as a = [0, 0]", table.place)
    return vertices


def _blocks(table: Table, vertices: Mapping[str, Any]) -> dict[str, tuple[Quad, ...]]:
    blocks: dict[str, tuple[Quad, ...]] = {}
    expected = 'a list of quads such as [["a", "b", "c", "d"]]'
    for group in table:
        place = table.place_of(group)
        quads = table.raw(group)
        if not isinstance(quads, list) or not quads:
            raise SceneError(f"got {describe(quads)}; expected {expected}", place)
        blocks[group] = tuple(_quad(quad, vertices, f"{place}[{k}]") for k, quad in enumerate(quads))
    if not blocks:
        raise SceneError(f"there are no blocks; expected groups, each {expected}", table.place)
    return blocks


def _quad(value: object, vertices: Mapping[str, Any], place: str) -> Quad:
    if not isinstance(value, list) or len(value) != 4 or not all(isinstance(name, str) for name in value):
        raise SceneError(f"got {describe(value)}; expected the names of four vertices, counter-clockwise", place)
    check_vertices(value, vertices, place)
    a, b, c, d = value
    twice = [name for name in value if value.count(name) > 1]
    if twice:
        raise SceneError(f"the vertex {twice[0]!r} occurs more than once; a block has four different vertices", place)
    return a, b, c, d


def _edges(table: Table, vertices: Mapping[str, Any]) -> dict[str, tuple[Path, ...]]:
    edges = {}
    for name in table:
        edges[name] = table.paths(name)
        check_paths(edges[name], vertices, table.place_of(name))
    return edges


def _count(
    table: Table,
    vertices: Mapping[str, Any],
    edges: Mapping[str, tuple[Path, ...]],
    blocks: Mapping[str, tuple[Quad, ...]],
) -> CountScene:
    on = paths_on_or_leaving(table, vertices, edges, blocks)
    count = CountScene(on, table.integer("elements", minimum=1), table.place)
    table.finish()
    return count
