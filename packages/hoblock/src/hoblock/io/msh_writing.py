"""The parts of Gmsh's MSH files, versions 2.2 and 4.1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.io.assembly import directed_sides
from hoblock.io.equispaced import equispaced_points
from hoblock.io.group_sets import group_sets, named_sides
from hoblock.io.msh_encoding import Encoding
from hoblock.io.msh_types import LINES, QUADS
from hoblock.mesh import QuadMesh
from hoblock.node_order import line_node_order, node_order

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["msh22", "msh41"]


@dataclass(frozen=True)
class _Elements:
    """Elements of one dimension, sorted into entities by the set of groups they belong to.

    Attributes
    ----------
    dimension, kind : int
        Gmsh's element type.
    nodes : ndarray, shape (k, m)
        In Gmsh's order, counted from 0.
    tags : tuple of int
        Physical tag of each group.
    sets : list of tuple of int
        Groups of each entity; some entities may be empty.
    entities : ndarray, shape (k,)
    """

    dimension: int
    kind: int
    nodes: Index
    tags: tuple[int, ...]
    sets: list[tuple[int, ...]]
    entities: Index


def msh22(mesh: QuadMesh, encoding: Encoding) -> Iterator[bytes]:
    """Yield the parts of a file of version 2.2; no element may be in two groups."""
    lines, quads = _elements(mesh)
    yield b"$MeshFormat\n2.2" + encoding.mark + b"\n$EndMeshFormat\n"
    yield _physical_names(mesh)
    points = np.pad(equispaced_points(mesh), ((0, 0), (0, 1)))
    yield b"$Nodes\n%d\n" % len(points) + encoding.nodes22(points) + b"\n$EndNodes\n"
    blocks = list(_blocks22(lines, quads))
    yield b"$Elements\n%d\n" % sum(len(rows) for _, rows in blocks)
    number = 1
    for kind, rows in blocks:
        if len(rows):
            rows[:, 0] = np.arange(number, number + len(rows))
            number += len(rows)
            yield encoding.elements22(kind, rows)
    yield b"\n$EndElements\n"


def msh41(mesh: QuadMesh, encoding: Encoding) -> Iterator[bytes]:
    """Yield the parts of a file of version 4.1."""
    parts = _elements(mesh)
    points = np.pad(equispaced_points(mesh), ((0, 0), (0, 1)))
    yield b"$MeshFormat\n4.1" + encoding.mark + b"\n$EndMeshFormat\n"
    yield _physical_names(mesh)
    yield b"$Entities\n" + encoding.sizes(0, len(parts[0].sets), len(parts[1].sets), 0)
    for part in parts:
        yield from (_entity(part, entity, points, encoding) for entity in range(len(part.sets)))
    yield b"\n$EndEntities\n"
    yield from _nodes41(parts, points, encoding)
    yield from _elements41(parts, encoding)


def _elements(mesh: QuadMesh) -> tuple[_Elements, _Elements]:
    """Lines and quads of a mesh; the groups' tags number sides first, then elements."""
    sides, members = named_sides(mesh)
    nodes = directed_sides(mesh, sides)[:, line_node_order(mesh.order, "gmsh")]
    tags = tuple(range(1, len(members) + 1))
    lines = _Elements(1, _type(LINES, mesh.order), nodes, tags, *group_sets(members, len(sides)))
    nodes = mesh.cells[:, node_order(mesh.order, "gmsh")]
    tags = tuple(range(len(tags) + 1, len(tags) + len(mesh.cell_groups) + 1))
    quads = _Elements(2, _type(QUADS, mesh.order), nodes, tags, *group_sets(mesh.cell_groups, len(mesh.cells)))
    return lines, quads


def _type(types: Mapping[int, int], order: int) -> int:
    return next(kind for kind, other in types.items() if other == order)


def _physical_names(mesh: QuadMesh) -> bytes:
    names = [(1, name) for name in mesh.edge_groups] + [(2, name) for name in mesh.cell_groups]
    if not names:
        return b""
    rows = "".join(f'{dimension} {tag} "{name}"\n' for tag, (dimension, name) in enumerate(names, start=1))
    return b"$PhysicalNames\n%d\n" % len(names) + rows.encode() + b"$EndPhysicalNames\n"


def _blocks22(lines: _Elements, quads: _Elements) -> Iterator[tuple[int, Index]]:
    """Records (number to be filled in, physical tag, entity, nodes): a line once for each of its groups."""
    for k, tag in enumerate(lines.tags):
        held = np.array([k in members for members in lines.sets], dtype=bool)
        inside = held[lines.entities] if len(lines.nodes) else np.zeros(0, dtype=bool)
        yield lines.kind, _rows22(lines.nodes[inside], tag, k + 1)
    physical = np.array([quads.tags[members[0]] if members else 0 for members in quads.sets], dtype=np.int64)
    yield quads.kind, _rows22(quads.nodes, physical[quads.entities], quads.entities + 1)


def _rows22(nodes: Index, physical: int | Index, entity: int | Index) -> Index:
    rows = np.empty((len(nodes), 3 + nodes.shape[1]), dtype=np.int64)
    rows[:, 1], rows[:, 2], rows[:, 3:] = physical, entity, nodes + 1
    return rows


def _entity(part: _Elements, entity: int, points: Array, encoding: Encoding) -> bytes:
    """Tag, box, physical tags; no bounding entities."""
    nodes = part.nodes[part.entities == entity]
    places = points[nodes.ravel()] if len(nodes) else np.zeros((1, 3))
    box = encoding.floats(np.concatenate([places.min(axis=0), places.max(axis=0)]))
    physical = [part.tags[k] for k in part.sets[entity]]
    numbers = encoding.sizes(len(physical)) + encoding.ints(*physical) + encoding.sizes(0)
    return encoding.ints(entity + 1) + box + numbers


def _nodes41(parts: tuple[_Elements, _Elements], points: Array, encoding: Encoding) -> Iterator[bytes]:
    """Nodes by the entity they lie on: a curve if there is one, else a surface."""
    owner = np.zeros(len(points), dtype=np.int64)
    shift = len(parts[0].sets)
    owner[parts[1].nodes] = shift + parts[1].entities[:, None]
    owner[parts[0].nodes] = parts[0].entities[:, None]
    order = np.argsort(owner, kind="stable")
    ends = np.cumsum(np.bincount(owner, minlength=shift + len(parts[1].sets)))
    blocks = [(k, order[end - size : end]) for k, (end, size) in enumerate(_pairs(ends)) if size]
    yield b"$Nodes\n" + encoding.sizes(len(blocks), len(points), 1, len(points))
    for entity, nodes in blocks:
        yield encoding.ints(*((1, entity + 1) if entity < shift else (2, entity - shift + 1)), 0) + encoding.sizes(
            len(nodes)
        )
        yield encoding.table(nodes[:, None] + 1) + encoding.floats(points[nodes])
    yield b"\n$EndNodes\n"


def _pairs(ends: Index) -> list[tuple[int, int]]:
    return list(zip(ends.tolist(), np.diff(ends, prepend=0).tolist(), strict=True))


def _elements41(parts: tuple[_Elements, _Elements], encoding: Encoding) -> Iterator[bytes]:
    blocks = [
        (part, entity, np.flatnonzero(part.entities == entity), first)
        for part, first in zip(parts, (1, 1 + len(parts[0].nodes)), strict=True)
        for entity in range(len(part.sets))
    ]
    blocks = [block for block in blocks if block[2].size]
    count = sum(len(part.nodes) for part in parts)
    yield b"$Elements\n" + encoding.sizes(len(blocks), count, 1, count)
    for part, entity, members, first in blocks:
        yield encoding.ints(part.dimension, entity + 1, part.kind) + encoding.sizes(len(members))
        yield encoding.table(np.column_stack([members + first, part.nodes[members] + 1]))
    yield b"\n$EndElements\n"
