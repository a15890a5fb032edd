"""Paths along block edges in a scene, checked against its vertices and names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import Any

from hoblock.errors import SceneError
from hoblock.io.table import Table
from hoblock.io.values import path_of
from hoblock.scene import Path, Quad
from hoblock.spelling import listing, suggestion

__all__ = ["check_paths", "check_vertices", "paths_on", "paths_on_or_leaving"]


def paths_on(table: Table, vertices: Mapping[str, Any], edges: Mapping[str, tuple[Path, ...]]) -> tuple[Path, ...]:
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
            check_vertices(path, vertices, where)
            found.append(path)
    return tuple(found)


def paths_on_or_leaving(
    table: Table,
    vertices: Mapping[str, Any],
    edges: Mapping[str, tuple[Path, ...]],
    blocks: Mapping[str, tuple[Quad, ...]],
) -> tuple[Path, ...]:
    """Read the paths at ``on``, or the name at ``leaving``: all block edges with just one end on the named edges.

    Those begin at that end.
    """
    if not table.has("leaving"):
        return paths_on(table, vertices, edges)
    if table.has("on"):
        raise SceneError("got both 'on' and 'leaving'; expected one of them", table.place)
    place, name = table.place_of("leaving"), table.string("leaving")
    wall = {vertex for path in _named(name, edges, place) for vertex in path}
    sides = [side for quads in blocks.values() for quad in quads for side in pairwise((*quad, quad[0]))]
    found = dict.fromkeys((a, b) if a in wall else (b, a) for a, b in sides if (a in wall) != (b in wall))
    if not found:
        raise SceneError(f"no block edge has just one end on {name!r}; name paths by 'on' instead", place)
    return tuple(found)


def _named(name: str, edges: Mapping[str, tuple[Path, ...]], place: str) -> tuple[Path, ...]:
    if name not in edges:
        raise SceneError(
            f"got {name!r}. {suggestion(name, edges)}Expected a list of paths such as "
            f'[["a", "b"]] or one of the names of [mesh.edges]: {listing(edges)}',
            place,
        )
    return edges[name]


def check_paths(paths: Iterable[Path], vertices: Mapping[str, Any], place: str) -> None:
    """Every vertex of the paths must exist."""
    for k, path in enumerate(paths):
        check_vertices(path, vertices, f"{place}[{k}]")


def check_vertices(names: Iterable[str], vertices: Mapping[str, Any], place: str) -> None:
    """Every name must be that of a vertex."""
    for name in names:
        if name not in vertices:
            raise SceneError(
                f"unknown vertex {name!r}. {suggestion(name, vertices)}Expected names from [mesh.vertices]", place
            )
