"""Reading MFEM's mesh files."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError
from hoblock.io.assembly import assembled
from hoblock.io.equispaced import resampled
from hoblock.mesh import QuadMesh
from hoblock.node_order import node_order
from hoblock.numbering import number_nodes
from hoblock.reference import gauss_legendre, gauss_lobatto

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["read_mfem"]

_HEAD = re.compile(r"MFEM mesh v1\.([0-3])")
_COLLECTION = re.compile(r"(?P<kind>L2_T1|L2|H1)_2D_P(?P<order>\d{1,2})|(?P<old>Linear|Quadratic)")
_OLD = {"Linear": 1, "Quadratic": 2}
_GEOMETRIES = {0: "points", 2: "triangles", 4: "tetrahedra", 5: "cubes", 6: "prisms", 7: "pyramids"}
_SEGMENT, _SQUARE = 1, 3
_CORNERS = {_SEGMENT: 2, _SQUARE: 4}


def read_mfem(path: str | Path) -> QuadMesh:
    """Read a mesh of quadrilaterals in MFEM's formats v1.0 to v1.3.

    The geometry may be straight (vertices only) or a grid function: continuous (``H1_2D_P<p>``, ``Linear``,
    ``Quadratic``) or discontinuous (``L2_T1_2D_P<p>``, ``L2_2D_P<p>``); where a discontinuous one has jumps, the last
    element wins. Attribute sets become groups; where a file has none, each attribute makes a group called by its
    number.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    QuadMesh

    Raises
    ------
    MeshFileError
        If the file cannot be understood, or holds something else.
    OSError
        If the file cannot be opened.
    """
    lines = Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    head = lines[0].strip() if lines else ""
    if _HEAD.fullmatch(head) is None:
        raise MeshFileError(
            f"{path}: the first line is {head[:60]!r}; expected 'MFEM mesh v1.0' to 'v1.3'. "
            "Non-conforming and NURBS meshes cannot be read."
        )
    rows = [text for line in lines[1:] if (text := line.strip()) and not text.startswith("#")]
    try:
        return _mesh(path, _Rows(rows))
    except (ValueError, IndexError, OverflowError) as error:
        raise MeshFileError(f"{path}: {error}. Write the file anew.") from error


class _Rows:
    """The lines of a file without comments and empty lines, one after the other."""

    def __init__(self, rows: list[str]) -> None:
        self._rows, self._place = rows, 0

    def left(self) -> int:
        return len(self._rows) - self._place

    def next(self) -> str:
        if not self.left():
            raise ValueError("the file ends too early")
        self._place += 1
        return self._rows[self._place - 1]

    def number(self, what: str) -> int:
        text = self.next()
        if not re.fullmatch(r"\d{1,12}", text):
            raise ValueError(f"the number of {what} is {text[:40]!r}; expected an integer")
        return int(text)

    def take(self, count: int) -> list[str]:
        if count > self.left():
            raise ValueError("the file ends too early")
        self._place += count
        return self._rows[self._place - count : self._place]

    def at_word(self) -> bool:
        return not self.left() or self._rows[self._place][0].isalpha()

    def numbers(self) -> Array:
        """All numbers from here to the next word, or to the end."""
        start = self._place
        while not self.at_word():
            self._place += 1
        words = " ".join(self._rows[start : self._place]).split()
        return np.fromiter(map(float, words), dtype=np.float64, count=len(words))


@dataclass(eq=False)
class _Elements:
    """Elements of one dimension: attributes, vertices, and sets of attributes by name (none if not in the file)."""

    attributes: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    vertices: Index = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    sets: dict[str, Index] | None = None

    def groups(self) -> dict[str, Index]:
        sets = self.sets
        if sets is None:
            sets = {str(k): np.array([k]) for k in np.unique(self.attributes).tolist()}
        return {name: np.flatnonzero(np.isin(self.attributes, members)) for name, members in sets.items()}


def _mesh(path: str | Path, rows: _Rows) -> QuadMesh:
    parts = {"elements": _Elements(), "boundary": _Elements()}
    collection, points, dimension, count = "", np.zeros((0, 2)), 2, 0
    while rows.left() and (section := rows.next()) != "mfem_mesh_end":
        if section == "dimension":
            dimension = rows.number("dimensions")
        elif section in parts:
            part = _elements(rows, section)
            parts[section].attributes, parts[section].vertices = part
        elif section in ("attribute_sets", "bdr_attribute_sets"):
            parts["elements" if section == "attribute_sets" else "boundary"].sets = _sets(rows)
        elif section == "vertices":
            count = rows.number("vertices")
            if not rows.at_word():
                width = rows.number("coordinates")
                points = rows.numbers().reshape(count, width)
        elif section == "nodes":
            collection, points = _nodes(rows)
        else:
            raise ValueError(f"there is a section {section[:40]!r}; expected a conforming mesh in the plane")
    if dimension != 2:
        raise ValueError(f"the dimension is {dimension}; expected 2")
    quads, sides = parts["elements"], parts["boundary"]
    if not len(quads.attributes):
        raise ValueError("there are no elements")
    order, values, local = _geometry(collection, points, quads.vertices, count)
    cells, total = number_nodes(quads.vertices, order)
    scattered = np.zeros((total, points.shape[1]))
    scattered[cells] = values[local]
    ends = np.full(max(count, int(quads.vertices.max()) + 1, int(sides.vertices.max(initial=0)) + 1), -1)
    ends[quads.vertices] = cells[:, [0, order, (order + 1) ** 2 - 1, order * (order + 1)]]
    lines = {name: ends[sides.vertices[members]] for name, members in sides.groups().items()}
    return assembled(path, scattered, cells, order, gauss_lobatto(order), cell_groups=quads.groups(), lines=lines)


def _elements(rows: _Rows, section: str) -> tuple[Index, Index]:
    geometry = _SQUARE if section == "elements" else _SEGMENT
    width = 2 + _CORNERS[geometry]
    count = rows.number(section)
    lines = [line.split() for line in rows.take(count)]
    for k, words in enumerate(lines):
        if len(words) != width or words[1] != str(geometry):
            kinds = [int(words[1]) for words in lines if len(words) > 1]
            others = [_GEOMETRIES.get(kind, f"elements of type {kind}") for kind in kinds if kind != geometry]
            what = (
                f"{len(others)} {others[0]} in the section {section}, the first" if others else f"a line of {section}"
            )
            raise ValueError(
                f"there are {what} in row {k}; expected {'quadrilaterals' if geometry == _SQUARE else 'segments'} only"
            )
    table = np.array(lines, dtype=np.int64).reshape(count, width)
    if table.size and (table.min() < 0 or table.max() > 2**40):
        raise ValueError(f"a number in the section {section} is out of range")
    return table[:, 0], table[:, 2:]


def _sets(rows: _Rows) -> dict[str, Index]:
    sets = {}
    for _ in range(rows.number("attribute sets")):
        name = rows.next()
        if len(name) > 1 and name[0] == name[-1] == '"':
            name = re.sub(r"\\(.)", r"\1", name[1:-1])
        count = rows.number("attributes")
        members: list[int] = []
        while len(members) < count:
            members.extend(map(int, rows.next().split()))
        sets[name] = np.array(members, dtype=np.int64)
    return sets


def _nodes(rows: _Rows) -> tuple[str, Array]:
    words = [line.partition(":")[2].strip() for line in rows.take(4)]
    if words[2] not in ("2", "3") or words[3] not in ("0", "1"):
        raise ValueError(f"nodes have VDim {words[2][:20]!r} and Ordering {words[3][:20]!r}; expected 2 and 0 or 1")
    width = int(words[2])
    values = rows.numbers()
    if len(values) % width:
        raise ValueError(f"nodes have {len(values)} values; expected a multiple of {width}")
    return words[1], values.reshape(-1, width) if words[3] == "1" else values.reshape(width, -1).T


def _geometry(collection: str, points: Array, quads: Index, count: int) -> tuple[int, Array, Index]:
    """Order, values at GLL nodes, and where those of each element are."""
    if quads.max() >= max(count, 1):
        raise ValueError(f"an element uses vertex {quads.max()}; there are {count}")
    if not collection:
        return 1, points, quads[:, [0, 1, 3, 2]]
    match = _COLLECTION.fullmatch(collection)
    if match is None or not 1 <= (order := _OLD.get(match["old"]) or int(match["order"] or 0)) <= 50:
        raise ValueError(
            f"nodes are {collection[:60]!r}; expected H1_2D_P<p>, L2_2D_P<p> or L2_T1_2D_P<p>, p from 1 to 50. "
            "In MFEM: mesh.SetCurvature(order, true)"
        )
    size = (order + 1) ** 2
    if (match["kind"] or "H1") == "H1":
        local = _continuous(quads, order, count)
    else:
        local = np.arange(len(quads) * size).reshape(-1, size)
    if local.max() + 1 != len(points):
        raise ValueError(f"there are {len(points)} nodes; expected {local.max() + 1} for {len(quads)} elements")
    if match["kind"] == "L2":
        points = resampled(points, local, order, gauss_legendre(order + 1)[0], gauss_lobatto(order))
    return order, points, local


def _continuous(quads: Index, order: int, count: int) -> Index:
    """Degrees of freedom of each element, lexicographic: vertices, then edges, then interiors.

    Edges are numbered as they first appear and directed from the smaller to the larger vertex number.
    """
    ends = quads[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2)
    keys = ends.min(axis=1) * count + ends.max(axis=1)
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    edges = np.argsort(np.argsort(first))[which.ravel()]
    inner = np.arange(order - 1)
    along = np.where((ends[:, 0] < ends[:, 1])[:, None], inner, inner[::-1])
    on_edges = count + edges[:, None] * (order - 1) + along
    start = count + len(first) * (order - 1)
    interior = start + np.arange(len(quads) * (order - 1) ** 2).reshape(len(quads), -1)
    dofs = np.concatenate([quads, on_edges.reshape(len(quads), -1), interior], axis=1)
    return np.asarray(dofs[:, np.argsort(node_order(order, "mfem"))])
