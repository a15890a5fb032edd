"""ParaView's series files: which file holds the fields of which time."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from xml.sax.saxutils import quoteattr

__all__ = ["write_pvd"]


def write_pvd(path: str | os.PathLike[str], entries: Iterable[tuple[float, str]]) -> None:
    """Write a series; the file is replaced in one go, so that readers always find a complete one.

    Parameters
    ----------
    path : path-like
    entries : iterable of (time, file)
        Files relative to the directory of the series.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    path = Path(path)
    sets = "".join(
        f'    <DataSet timestep="{float(time)!r}" group="" part="0" file={quoteattr(file)}/>\n'
        for time, file in entries
    )
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f"  <Collection>\n{sets}  </Collection>\n</VTKFile>\n"
    )
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)
