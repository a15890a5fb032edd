"""The `[mesh]` part of a scene file, read into plain data."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal

from hoblock.errors import SceneError
from hoblock.expressions import RESERVED_NAMES, compile_expression
from hoblock.io.table import Table
from hoblock.io.toml import apply_overrides, naming_file, read_toml
from hoblock.io.values import describe, path_of
from hoblock.scene import (
    HIGHEST_ORDER,
    ArcAbout,
    ArcThrough,
    CountScene,
    CurveScene,
    Formula,
    GradingScene,
    MeshScene,
    Path,
    Quad,
)
from hoblock.spelling import listing, suggestion

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
        whole = Table(data)
        title = whole.string("title", "")
        constants = constants_of(data)
        mesh = whole.table("mesh")
        vertices = _vertices(mesh.table("vertices"), constants)
        blocks = _blocks(mesh.table("blocks"), vertices)
        edges = _edges(mesh.table("edges", required=False), vertices)
        scene = MeshScene(
            order=mesh.integer("order", minimum=1, maximum=HIGHEST_ORDER),
            vertices=MappingProxyType(vertices),
            blocks=MappingProxyType(blocks),
            edges=MappingProxyType(edges),
            curves=tuple(_curve(table, vertices, edges, constants) for table in mesh.tables("curve")),
            counts=tuple(_count(table, vertices, edges) for table in mesh.tables("count")),
            gradings=tuple(_grading(table, vertices, edges) for table in mesh.tables("grading")),
            elements=mesh.integer("elements", 1, minimum=1),
            title=title,
            file=file,
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
            raise SceneError(problem, place) from error
    return constants


def _check_constant_name(name: str, place: str) -> None:
    if name in RESERVED_NAMES:
        raise SceneError(f"{name!r} has a meaning of its own in expressions; choose another name", place)
    if not (name.isascii() and name.isidentifier()):
        raise SceneError(
            f"got the name {name!r}; expected letters a-z, digits and underscores, beginning with a letter", place
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
    _check_vertices(value, vertices, place)
    a, b, c, d = value
    twice = [name for name in value if value.count(name) > 1]
    if twice:
        raise SceneError(f"the vertex {twice[0]!r} occurs more than once; a block has four different vertices", place)
    return a, b, c, d


def _edges(table: Table, vertices: Mapping[str, Any]) -> dict[str, tuple[Path, ...]]:
    edges = {}
    for name in table:
        edges[name] = table.paths(name)
        _check_paths(edges[name], vertices, table.place_of(name))
    return edges


def _on(table: Table, vertices: Mapping[str, Any], edges: Mapping[str, tuple[Path, ...]]) -> tuple[Path, ...]:
    """Read the paths at ``on``: paths, the names of named edges, or a list of both."""
    place = table.place_of("on")
    asked = table.raw("on")
    if isinstance(asked, str):
        return _named(asked, edges, place)
    lone_path = isinstance(asked, list) and all(isinstance(part, str) and part in vertices for part in asked)
    if lone_path or not isinstance(asked, list):
        table.paths("on")  # says what is wrong with it
    found: list[Path] = []
    for k, part in enumerate(asked):
        where = f"{place}[{k}]"
        if isinstance(part, str):
            found += _named(part, edges, where)
        else:
            path = path_of(part, where)
            _check_vertices(path, vertices, where)
            found.append(path)
    return tuple(found)


def _named(name: str, edges: Mapping[str, tuple[Path, ...]], place: str) -> tuple[Path, ...]:
    if name not in edges:
        raise SceneError(
            f"got {name!r}. {suggestion(name, edges)}Expected a list of paths such as "
            f'[["a", "b"]] or one of the names of [mesh.edges]: {listing(edges)}',
            place,
        )
    return edges[name]


def _check_paths(paths: Iterable[Path], vertices: Mapping[str, Any], place: str) -> None:
    for k, path in enumerate(paths):
        _check_vertices(path, vertices, f"{place}[{k}]")


def _check_vertices(names: Iterable[str], vertices: Mapping[str, Any], place: str) -> None:
    for name in names:
        if name not in vertices:
            raise SceneError(
                f"unknown vertex {name!r}. {suggestion(name, vertices)}Expected names from [mesh.vertices]", place
            )


def _curve(
    table: Table, vertices: Mapping[str, Any], edges: Mapping[str, tuple[Path, ...]], constants: Mapping[str, float]
) -> CurveScene:
    on = _on(table, vertices, edges)
    kind = table.string("kind", choices=("arc", "parametric"))
    shape = _arc(table, constants) if kind == "arc" else _formula(table, constants)
    table.finish()
    return CurveScene(on, shape, table.place)


def _arc(table: Table, constants: Mapping[str, float]) -> ArcAbout | ArcThrough:
    about, through = table.has("center"), table.has("through")
    if about == through:
        got = "both 'center' and 'through'" if about else "neither 'center' nor 'through'"
        raise SceneError(f"an arc with {got}; expected exactly one of them", table.place)
    if about:
        return ArcAbout(table.pair("center", constants=constants))
    return ArcThrough(table.pair("through", constants=constants))


def _formula(table: Table, constants: Mapping[str, float]) -> Formula:
    return Formula(table.expression("x", ("s",), constants), table.expression("y", ("s",), constants))


def _count(table: Table, vertices: Mapping[str, Any], edges: Mapping[str, tuple[Path, ...]]) -> CountScene:
    count = CountScene(_on(table, vertices, edges), table.integer("elements", minimum=1), table.place)
    table.finish()
    return count


def _grading(table: Table, vertices: Mapping[str, Any], edges: Mapping[str, tuple[Path, ...]]) -> GradingScene:
    on = _on(table, vertices, edges)
    name = table.string("kind", choices=("uniform", "quadratic", "cubic", "exponential"))
    kind: Literal["uniform", "quadratic", "cubic", "exponential"]
    parameter = 0.0
    match name:
        case "quadratic":
            kind, parameter = "quadratic", table.number("m", above=-1.0, below=1.0)
        case "cubic":
            kind, parameter = "cubic", table.number("m", minimum=0.0, below=1.0)
        case "exponential":
            kind, parameter = "exponential", table.number("a", minimum=-50.0, maximum=50.0)
        case _:
            kind = "uniform"
    table.finish()
    return GradingScene(on, kind, parameter, table.place)
