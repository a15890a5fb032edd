"""Data arrays in VTK's XML files: text, base64 and raw bytes, compressed or not."""

from __future__ import annotations

import base64
import binascii
import lzma
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

AnyArray = NDArray[np.generic]

__all__ = ["VtkXml", "VtkXmlError", "data_array"]

_BLOCK = 1 << 20
_TYPES = {
    f"{prefix}{8 * size}": f"{kind}{size}"
    for prefix, kind, sizes in (("Int", "i", (1, 2, 4, 8)), ("UInt", "u", (1, 2, 4, 8)), ("Float", "f", (4, 8)))
    for size in sizes
}
_NAMES = {kind: name for name, kind in _TYPES.items()}


class VtkXmlError(Exception):
    """A file that cannot be understood; the reader says which."""


def data_array(name: str, values: AnyArray, *, tuples: bool = False) -> bytes:
    """Write a DataArray element: little-endian, zlib, base64, headers of type UInt64.

    Parameters
    ----------
    name : str
    values : ndarray, shape (n,) or (n, k)
        Integers or floating-point numbers.
    tuples : bool, optional
        Say how many rows there are; field data need it.
    """
    values = np.ascontiguousarray(values)
    little = values.astype(values.dtype.newbyteorder("<"), copy=False)
    data = memoryview(little.tobytes())
    blocks = [zlib.compress(data[k : k + _BLOCK], 1) for k in range(0, len(data), _BLOCK)]
    header = [len(blocks), _BLOCK, len(data) % _BLOCK, *map(len, blocks)] if blocks else [0, 0, 0]
    components = values.shape[1] if values.ndim == 2 else 1
    count = f' NumberOfTuples="{len(values)}"' if tuples else ""
    start = (
        f'<DataArray type="{_NAMES[values.dtype.str[1:]]}" Name={quoteattr(name)} '
        f'NumberOfComponents="{components}"{count} format="binary">'
    )
    text = base64.b64encode(np.array(header, dtype="<u8").tobytes()) + base64.b64encode(b"".join(blocks))
    return start.encode() + text + b"</DataArray>\n"


@dataclass(frozen=True, eq=False)
class VtkXml:
    """A file in memory.

    Attributes
    ----------
    root : Element
        VTKFile.
    appended : bytes
        Data behind the underscore of the section AppendedData.
    raw : bool
        Whether these are bytes, not base64.
    offsets : tuple of int
        Where arrays begin in them, ascending.
    """

    root: ElementTree.Element
    appended: bytes
    raw: bool
    offsets: tuple[int, ...]

    @classmethod
    def parse(cls, data: bytes) -> VtkXml:
        """Take a file apart.

        Raises
        ------
        VtkXmlError
        """
        start = data.find(b"<AppendedData")
        text, appended, raw = data, b"", False
        if start >= 0:
            text = data[:start] + b"</VTKFile>"
            begin, stop = data.find(b"_", data.find(b">", start)), data.rfind(b"</AppendedData>")
            if begin < 0 or stop < begin:
                raise VtkXmlError("the section AppendedData has no end; the file ends too early")
            appended, raw = data[begin + 1 : stop], b"raw" in data[start:begin]
        if b"<!DOCTYPE" in text[:10000] or b"<!ENTITY" in text:
            raise VtkXmlError("there is a document type; expected a plain file of VTK")
        try:
            root = ElementTree.fromstring(text)
        except (ElementTree.ParseError, ValueError, LookupError) as error:
            raise VtkXmlError(f"this is no XML that can be read ({error})") from error
        if root.tag != "VTKFile":
            raise VtkXmlError(f"the outermost element is {root.tag[:40]!r}; expected 'VTKFile'")
        offsets = {_integer(array, "offset") for array in root.iter("DataArray") if array.get("format") == "appended"}
        return cls(root, appended, raw, tuple(sorted(offsets)))

    def array(self, element: ElementTree.Element) -> AnyArray:
        """Values of a DataArray element, shape (n,) or (n, k).

        Raises
        ------
        VtkXmlError
        """
        name, kind = element.get("Name", "without a name"), element.get("type", "")
        if kind not in _TYPES:
            raise VtkXmlError(f"array {name!r} has type {kind[:20]!r}; expected numbers")
        try:
            values = self._values(element, _TYPES[kind])
        except VtkXmlError as error:
            raise VtkXmlError(f"array {name!r}: {error}") from error
        components = _integer(element, "NumberOfComponents", 1)
        if components < 1 or values.size % components:
            raise VtkXmlError(f"array {name!r} has {values.size} values; expected a multiple of {components}")
        return values.reshape(-1, components) if components > 1 else values

    def _values(self, element: ElementTree.Element, kind: str) -> AnyArray:
        style = element.get("format", "ascii")
        if style == "ascii":
            words = (element.text or "").split()
            convert: Callable[[str], float | int] = float if kind[0] == "f" else int
            try:
                return np.array(list(map(convert, words)), dtype=kind)
            except (ValueError, OverflowError) as error:
                raise VtkXmlError(str(error)[:80]) from error
        if style == "appended":
            begin = _integer(element, "offset")
            end = next((offset for offset in self.offsets if offset > begin), len(self.appended))
            data = self.appended[begin:end] if self.raw else _decoded(self.appended[begin:end])
        elif style == "binary":
            data = _decoded((element.text or "").encode("ascii", errors="replace"))
        else:
            raise VtkXmlError(f"format is {style[:20]!r}; expected 'ascii', 'binary' or 'appended'")
        return self._numbers(data, kind)

    def _numbers(self, data: bytes, kind: str) -> AnyArray:
        byte_order = ">" if self.root.get("byte_order") == "BigEndian" else "<"
        header = np.dtype(byte_order + ("u8" if self.root.get("header_type") == "UInt64" else "u4"))
        compressor = self.root.get("compressor")
        data = _expand(data, header, compressor) if compressor else _plain(data, header)
        if len(data) % int(kind[1:]):
            raise VtkXmlError(f"there are {len(data)} bytes; expected a multiple of {kind[1:]}")
        return np.frombuffer(data, dtype=byte_order + kind).astype(kind)


def _integer(element: ElementTree.Element, key: str, default: int | None = None) -> int:
    text = element.get(key, "" if default is None else str(default))
    if not re.fullmatch(r"\s*\d{1,18}\s*", text):
        raise VtkXmlError(f"{element.tag}: {key} is {text[:20]!r}; expected an integer")
    return int(text)


def _decoded(text: bytes) -> bytes:
    """Bytes of base64 texts that follow each other, each with its own padding."""
    try:
        return b"".join(
            base64.b64decode(part, validate=True) for part in re.findall(rb"[^=]+=*", b"".join(text.split()))
        )
    except binascii.Error as error:
        raise VtkXmlError(f"no base64: {error}") from error


def _head(data: bytes, header: np.dtype[np.generic], count: int) -> list[int]:
    size = count * header.itemsize
    if count < 0 or len(data) < size:
        raise VtkXmlError("the data end too early")
    values: list[int] = np.frombuffer(data[:size], dtype=header).tolist()
    return values


def _plain(data: bytes, header: np.dtype[np.generic]) -> bytes:
    (size,) = _head(data, header, 1)
    if len(data) < header.itemsize + size:
        raise VtkXmlError("the data end too early")
    return data[header.itemsize : header.itemsize + size]


def _expand(data: bytes, header: np.dtype[np.generic], compressor: str) -> bytes:
    if compressor not in ("vtkZLibDataCompressor", "vtkLZMADataCompressor"):
        raise VtkXmlError(
            f"the data are compressed by {compressor[:40]!r}; write them with zlib or without compression"
        )
    (count,) = _head(data, header, 1)
    if count == 0:
        return b""
    _, size, last, *sizes = _head(data, header, 3 + count)
    place = (3 + count) * header.itemsize
    parts = []
    for k, length in enumerate(sizes):
        limit = last if k == count - 1 and last else size
        parts.append(_inflate(data[place : place + length], limit, compressor))
        if len(parts[-1]) != limit:
            raise VtkXmlError(f"a compressed block has {len(parts[-1])} bytes; expected {limit}")
        place += length
    return b"".join(parts)


def _inflate(data: bytes, limit: int, compressor: str) -> bytes:
    """Decompress, but never more than ``limit`` bytes, whatever the data claim to hold."""
    try:
        if compressor == "vtkZLibDataCompressor":
            return zlib.decompressobj().decompress(data, min(limit, 2**62) or 1)
        return lzma.LZMADecompressor(memlimit=1 << 28).decompress(data, min(limit, 2**62) or 1)
    except (zlib.error, lzma.LZMAError) as error:
        raise VtkXmlError(f"a compressed block cannot be read ({error})") from error
