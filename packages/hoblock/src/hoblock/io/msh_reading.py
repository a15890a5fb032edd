"""The contents of Gmsh's MSH files, versions 2.2 and 4.1, text and binary."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hoblock.io.msh_scanner import Binary, ScanError, Scanner, Text
from hoblock.io.msh_types import NODES, describe

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["MshContent", "MshElements", "scan"]

_MOST_GROUPS = 256  # of an entity; so that a small file cannot ask for endless memory
_NAME = re.compile(rb'\s*(\d+)\s+(-?\d+)\s+"(.*)"\s*')


@dataclass(frozen=True, eq=False)
class MshElements:
    """Elements of one type.

    Attributes
    ----------
    kind : int
        Gmsh's element type.
    numbers : ndarray, shape (k,)
    nodes : ndarray, shape (k, m)
        Node tags, in Gmsh's order.
    physical : ndarray, shape (k, r)
        Tags of the physical groups; 0 is none.
    """

    kind: int
    numbers: Index
    nodes: Index
    physical: Index


@dataclass(eq=False)
class MshContent:
    """What a file holds, as far as meshes are concerned.

    Attributes
    ----------
    tags : ndarray, shape (n,)
        Of the nodes.
    points : ndarray, shape (n, 3)
    elements : list of MshElements
    names : dict of (int, int) to str
        Name of each physical group, by dimension and tag.
    """

    tags: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    elements: list[MshElements] = field(default_factory=list)
    names: dict[tuple[int, int], str] = field(default_factory=dict)


def scan(data: bytes) -> MshContent:
    """Take a file apart.

    Raises
    ------
    ScanError
        If that is not possible; the message begins with the section where reading stopped.
    """
    version, binary, byte_order, place = _header(data)
    content = MshContent()
    entities: dict[tuple[int, int], list[int]] = {}
    view = memoryview(data)
    while (found := _section(data, place)) is not None:
        name, place = found
        try:
            if name == b"PartitionedEntities":
                raise ScanError("the mesh is partitioned. In Gmsh: remove the partition and save it anew")
            if name in (b"Nodes", b"Elements") or (name == b"Entities" and version == "4.1"):
                count, place = _count(data, place) if version == "2.2" else (0, place)
                scanner = Binary(view, place, byte_order) if binary else Text(data[place : _end(data, name, place)])
                if name == b"Entities":
                    entities = _entities(scanner)
                elif name == b"Nodes":
                    content.tags, content.points = _nodes22(scanner, count) if count else _nodes41(scanner)
                elif version == "2.2":
                    content.elements = _elements22(scanner, count)
                else:
                    content.elements = _elements41(scanner, entities)
                place = scanner.place if isinstance(scanner, Binary) else place
            elif name == b"PhysicalNames":
                content.names = _names(data[place : _end(data, name, place)])
            place = _end(data, name, place) + len(b"$End" + name)
        except ScanError as error:
            raise ScanError(f"${name.decode(errors='replace')}: {error}") from error
    return content


def _header(data: bytes) -> tuple[str, bool, str, int]:
    """Version (2.2 or 4.1), whether binary, byte order, and where the sections begin."""
    start = data.find(b"$MeshFormat")
    if start < 0:
        raise ScanError("there is no section $MeshFormat; expected a mesh file of Gmsh")
    line, place = _line(data, _line(data, start)[1])
    words = line.decode("ascii", errors="replace").split()
    if len(words) != 3 or words[1] not in ("0", "1"):
        raise ScanError(f"$MeshFormat: the line is {' '.join(words)[:80]!r}; expected a version, 0 or 1, and 8")
    version = {"2": "2.2", "2.0": "2.2", "2.1": "2.2", "2.2": "2.2", "4.1": "4.1"}.get(words[0])
    if version is None or words[2] != "8":
        raise ScanError(
            f"$MeshFormat: version {words[0][:20]} with data of {words[2][:20]} bytes; expected 2.2 or 4.1 with 8 "
            "bytes. In Gmsh: Mesh.MshFileVersion = 4.1"
        )
    byte_order = "<"
    if words[1] == "1":
        one = data[place : place + 4]
        byte_order = {b"\1\0\0\0": "<", b"\0\0\0\1": ">"}.get(one, "")
        if not byte_order:
            raise ScanError(f"$MeshFormat: the number that shows the byte order is {one!r}; expected a 4-byte 1")
        place += 4
    place = _end(data, b"MeshFormat", place) + len(b"$EndMeshFormat")
    return version, words[1] == "1", byte_order, place


def _line(data: bytes, place: int) -> tuple[bytes, int]:
    end = data.find(b"\n", place)
    end = len(data) if end < 0 else end
    return data[place:end].strip(), end + 1


def _section(data: bytes, place: int) -> tuple[bytes, int] | None:
    """Name of the next section and where its data begin."""
    start = data.find(b"$", place)
    if start < 0:
        return None
    line, place = _line(data, start)
    return line[1:], place


def _end(data: bytes, name: bytes, place: int) -> int:
    end = data.find(b"$End" + name, place)
    if end < 0:
        raise ScanError(f"there is no $End{name.decode(errors='replace')[:40]}; the file ends too early")
    return end


def _count(data: bytes, place: int) -> tuple[int, int]:
    line, place = _line(data, place)
    if not re.fullmatch(rb"\d{1,18}", line) or int(line) == 0:
        raise ScanError(f"the number of rows is {line[:40].decode(errors='replace')!r}; expected a positive integer")
    return int(line), place


def _names(data: bytes) -> dict[tuple[int, int], str]:
    names = {}
    for line in data.split(b"\n")[1:]:
        if line.strip():
            match = _NAME.fullmatch(line)
            if match is None:
                raise ScanError(f'a line is {line.decode(errors="replace")[:80]!r}; expected dimension, tag and "name"')
            names[int(match[1]), abs(int(match[2]))] = match[3].decode("utf-8", errors="replace")
    return names


def _nodes22(scanner: Scanner, count: int) -> tuple[Index, Array]:
    if isinstance(scanner, Binary):
        rows = scanner.records([("tag", "i4"), ("x", "f8", 3)], count)
        return rows["tag"].astype(np.int64), rows["x"].astype(np.float64)
    values = scanner.floats(4 * count).reshape(-1, 4)
    return values[:, 0].astype(np.int64), values[:, 1:]


def _elements22(scanner: Scanner, count: int) -> list[MshElements]:
    elements: list[MshElements] = []
    while count > 0:
        if isinstance(scanner, Binary):
            kind, follow, tags = scanner.rest()[:3].tolist() if len(scanner.rest()) >= 3 else scanner.ints(3).tolist()
            width = _width(kind, tags)
            if follow < 1:
                raise ScanError(f"a block holds {follow} elements; expected at least one")
            if follow > 1:
                scanner.skip(3)
                rows = scanner.ints(follow * width).reshape(-1, width)
            else:
                rows = _run(scanner, 3 + width, [0, 1, 2], count)[:, 3:]
        else:
            _, kind, tags = scanner.rest()[:3].tolist() if len(scanner.rest()) >= 3 else scanner.ints(3).tolist()
            rows = np.delete(_run(scanner, 2 + _width(kind, tags), [1, 2], count), [1, 2], axis=1)
        physical = np.abs(rows[:, 1:2]) if tags else np.zeros((len(rows), 1), dtype=np.int64)
        elements.append(MshElements(kind, rows[:, 0], rows[:, 1 + tags :], physical))
        count -= len(rows)
    return elements


def _width(kind: int, tags: int) -> int:
    """Numbers of an element: its own, its tags, its nodes."""
    if kind not in NODES:
        raise ScanError(f"there are {describe(kind)[0]}. {describe(kind)[1]}")
    if not 0 <= tags <= 1000:
        raise ScanError(f"an element has {tags} tags; expected 0 to 1000")
    return 1 + tags + NODES[kind]


def _run(scanner: Scanner, width: int, key: list[int], count: int) -> Index:
    """Rows from here on that agree with the first one in some columns."""
    rest = scanner.rest()
    rows = rest[: min(count, len(rest) // width) * width].reshape(-1, width)
    if not len(rows):
        raise ScanError("the file ends too early")
    size = 1
    while size < len(rows):
        begin, size = size, min(2 * size, len(rows))
        other = (rows[begin:size, key] != rows[0, key]).any(axis=1)
        if other.any():
            size = begin + int(np.argmax(other))
            break
    scanner.skip(size * width)
    return rows[:size].astype(np.int64)


def _entities(scanner: Scanner) -> dict[tuple[int, int], list[int]]:
    """Physical tags of each entity, by dimension and tag."""
    physical = {}
    for dimension, count in enumerate(scanner.sizes(4).tolist()):
        for _ in range(count):
            tag = int(scanner.ints(1)[0])
            scanner.floats(6 if dimension else 3)
            groups = int(scanner.sizes(1)[0])
            if groups > _MOST_GROUPS:
                raise ScanError(f"entity {tag} is in {groups} physical groups; expected at most {_MOST_GROUPS}")
            physical[dimension, tag] = np.abs(scanner.ints(groups)).tolist()
            if dimension:
                scanner.ints(int(scanner.sizes(1)[0]))
    return physical


def _nodes41(scanner: Scanner) -> tuple[Index, Array]:
    tags, points = [np.zeros(0, dtype=np.int64)], [np.zeros((0, 3))]
    for _ in range(int(scanner.sizes(4)[0])):
        dimension, _entity, parametric = scanner.ints(3).tolist()
        if not 0 <= dimension <= 3 or parametric not in (0, 1):
            raise ScanError(f"a block of dimension {dimension}, parametric {parametric}; expected 0 to 3, 0 or 1")
        count = int(scanner.sizes(1)[0])
        tags.append(scanner.sizes(count))
        width = 3 + parametric * dimension
        points.append(scanner.floats(count * width).reshape(-1, width)[:, :3])
    return np.concatenate(tags), np.concatenate(points)


def _elements41(scanner: Scanner, entities: dict[tuple[int, int], list[int]]) -> list[MshElements]:
    elements = []
    for _ in range(int(scanner.sizes(4)[0])):
        dimension, entity, kind = scanner.ints(3).tolist()
        width = _width(kind, 0)
        rows = scanner.sizes(int(scanner.sizes(1)[0]) * width).reshape(-1, width)
        tags = entities.get((dimension, entity), [])
        physical = np.broadcast_to(np.array(tags, dtype=np.int64), (len(rows), len(tags)))
        elements.append(MshElements(kind, rows[:, 0], rows[:, 1:], physical))
    return elements
