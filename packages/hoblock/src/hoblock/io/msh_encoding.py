"""Numbers in Gmsh's files, as bytes or as text."""

from __future__ import annotations

import io
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["AsBytes", "AsText", "Encoding"]


class Encoding(Protocol):
    """How to write numbers."""

    mark: bytes
    """What follows the version in the section MeshFormat."""

    def ints(self, *values: int) -> bytes:
        """Write 4-byte integers."""

    def sizes(self, *values: int) -> bytes:
        """Write 8-byte unsigned integers."""

    def floats(self, values: Array) -> bytes:
        """Write numbers, a row a line."""

    def table(self, rows: Index) -> bytes:
        """Write 8-byte unsigned integers, a row a line."""

    def nodes22(self, points: Array) -> bytes:
        """Write tags from 1 on and points (n, 3), as version 2.2 has them."""

    def elements22(self, kind: int, rows: Index) -> bytes:
        """Write elements (number, physical tag, entity, nodes) of one type, as version 2.2 has them."""


class AsBytes:
    """Little-endian binary numbers."""

    mark = b" 1 8\n" + np.array(1, dtype="<i4").tobytes()

    def ints(self, *values: int) -> bytes:
        """Write 4-byte integers."""
        return np.array(values, dtype="<i4").tobytes()

    def sizes(self, *values: int) -> bytes:
        """Write 8-byte unsigned integers."""
        return np.array(values, dtype="<u8").tobytes()

    def floats(self, values: Array) -> bytes:
        """Write 8-byte numbers."""
        return values.astype("<f8").tobytes()

    def table(self, rows: Index) -> bytes:
        """Write 8-byte unsigned integers."""
        return rows.astype("<u8").tobytes()

    def nodes22(self, points: Array) -> bytes:
        """Write records of a 4-byte tag and three 8-byte numbers."""
        records = np.zeros(len(points), dtype=[("tag", "<i4"), ("x", "<f8", 3)])
        records["tag"] = np.arange(1, len(points) + 1)
        records["x"] = points
        return records.tobytes()

    def elements22(self, kind: int, rows: Index) -> bytes:
        """Write a header (type, count, two tags) and the rows."""
        return self.ints(kind, len(rows), 2) + rows.astype("<i4").tobytes()


class AsText:
    """Decimal numbers that are read back to the last bit."""

    mark = b" 0 8"

    def ints(self, *values: int) -> bytes:
        """Write integers."""
        return "".join(f"{value} " for value in values).encode()

    def sizes(self, *values: int) -> bytes:
        """Write integers."""
        return "".join(f"{value} " for value in values).encode()

    def floats(self, values: Array) -> bytes:
        """Write numbers, a row a line."""
        rows = np.atleast_2d(values).tolist()
        return "".join(" ".join(map(repr, row)) + "\n" for row in rows).encode()

    def table(self, rows: Index) -> bytes:
        """Write integers, a row a line."""
        buffer = io.StringIO()
        np.savetxt(buffer, np.atleast_2d(rows), fmt="%d")
        return buffer.getvalue().encode()

    def nodes22(self, points: Array) -> bytes:
        """Write a tag and three numbers a line."""
        rows = points.tolist()
        return "".join(f"{tag} {x!r} {y!r} {z!r}\n" for tag, (x, y, z) in enumerate(rows, start=1)).encode()

    def elements22(self, kind: int, rows: Index) -> bytes:
        """Write number, type, count of tags, tags and nodes a line."""
        return self.table(np.insert(rows, [1, 1], [kind, 2], axis=1))
