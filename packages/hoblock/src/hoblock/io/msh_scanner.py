"""Numbers of Gmsh's files, one after the other, from text or bytes; never more than the file holds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["Binary", "Scanner", "ScanError", "Text"]


class ScanError(Exception):
    """The data end too early or are no numbers; the reader says where."""


class Scanner(Protocol):
    """Source of numbers."""

    def ints(self, count: int) -> Index:
        """Read the next ``count`` 4-byte integers, or integers of the text."""

    def sizes(self, count: int) -> Index:
        """Read the next ``count`` 8-byte unsigned integers, or integers of the text."""

    def floats(self, count: int) -> Array:
        """Read the next ``count`` 8-byte floating-point numbers, or numbers of the text."""

    def rest(self) -> Index:
        """View what is left, as 4-byte integers or as integers of the text, without moving on."""

    def skip(self, count: int) -> None:
        """Move on by ``count`` 4-byte integers, or numbers of the text."""


class Binary:
    """Numbers in bytes.

    Parameters
    ----------
    data : memoryview
    place : int
        Where to begin.
    byte_order : {"<", ">"}
    """

    def __init__(self, data: memoryview, place: int, byte_order: str) -> None:
        self._data = data
        self.place = place
        self._byte_order = byte_order

    def _take(self, kind: str, size: int, count: int) -> NDArray[np.generic]:
        end = self.place + size * count
        if count < 0 or end > len(self._data):
            raise ScanError("the file ends too early")
        values: NDArray[np.generic] = np.frombuffer(self._data[self.place : end], dtype=self._byte_order + kind)
        self.place = end
        return values

    def ints(self, count: int) -> Index:
        """Read the next integers."""
        return self._take("i4", 4, count).astype(np.int64)

    def sizes(self, count: int) -> Index:
        """Read the next integers, 8 bytes each."""
        values = self._take("u8", 8, count)
        if values.size and values.max() > 2**62:
            raise ScanError("a number is out of range")
        return values.astype(np.int64)

    def floats(self, count: int) -> Array:
        """Read the next numbers."""
        return self._take("f8", 8, count).astype(np.float64)

    def rest(self) -> Index:
        """View what is left as integers, without moving on."""
        count = (len(self._data) - self.place) // 4
        view: Index = np.frombuffer(
            self._data[self.place : self.place + 4 * count], dtype=self._byte_order + "i4"
        )  # not copied
        return view

    def skip(self, count: int) -> None:
        """Move on."""
        self._take("i4", 4, count)

    def records(self, fields: Sequence[tuple[str, str] | tuple[str, str, int]], count: int) -> NDArray[np.void]:
        """Read the next ``count`` records of the given fields."""
        dtype = np.dtype(list(fields)).newbyteorder("<" if self._byte_order == "<" else ">")
        end = self.place + count * dtype.itemsize
        if end > len(self._data):
            raise ScanError("the file ends too early")
        rows: NDArray[np.void] = np.frombuffer(self._data[self.place : end], dtype=dtype)
        self.place = end
        return rows


class Text:
    """Numbers in text, separated by white space.

    Parameters
    ----------
    data : bytes
    """

    def __init__(self, data: bytes) -> None:
        words = data.split()
        try:
            self._values = np.fromiter(map(float, words), dtype=np.float64, count=len(words))
        except ValueError as error:
            raise ScanError(f"there should be a number: {error}") from error
        self._whole: Index | None = None
        self._place = 0

    def _take(self, count: int) -> Array:
        if count < 0 or self._place + count > len(self._values):
            raise ScanError("the section ends too early")
        values = self._values[self._place : self._place + count]
        self._place += count
        return values

    def ints(self, count: int) -> Index:
        """Read the next integers."""
        return _whole(self._take(count))

    sizes = ints

    def floats(self, count: int) -> Array:
        """Read the next numbers."""
        return self._take(count)

    def rest(self) -> Index:
        """View what is left as integers, without moving on."""
        if self._whole is None:
            self._whole = _whole(self._values)
        return self._whole[self._place :]

    def skip(self, count: int) -> None:
        """Move on."""
        self._take(count)


def _whole(values: Array) -> Index:
    if values.size and not (np.abs(values) <= 2.0**53).all():
        raise ScanError("a number is out of range")
    whole = values.astype(np.int64)
    if (whole != values).any():
        raise ScanError("there should be an integer")
    return whole
