"""ParaView's series files: which file holds which time."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from xml.sax.saxutils import quoteattr

from hoblock.io.replacing import replacing
from hoblock.io.vtk_arrays import Data
from hoblock.io.vtu import write_vtu
from hoblock.mesh import QuadMesh

__all__ = ["PvdSeries", "write_pvd"]


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
    sets = "".join(
        f'    <DataSet timestep="{float(time)!r}" group="" part="0" file={quoteattr(file)}/>\n'
        for time, file in entries
    )
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f"  <Collection>\n{sets}  </Collection>\n</VTKFile>\n"
    )
    with replacing(path) as file:
        file.write(text.encode("utf-8"))


class PvdSeries:
    """A moving mesh as a series of .vtu files that ParaView opens as one, with times.

    ``flap.pvd`` lists ``flap_00000.vtu``, ``flap_00001.vtu`` … beside it. After every step the series is complete as
    far as it goes, so that it can be watched while it grows. The mesh may change from step to step.

    Parameters
    ----------
    path : path-like
        Ends in ``.pvd``. A series of that name is replaced at the first step.

    Examples
    --------
    >>> series = PvdSeries("flap.pvd")  # doctest: +SKIP
    >>> for time, mesh in meshes:  # doctest: +SKIP
    ...     series.write(time, mesh)
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self._entries: list[tuple[float, str]] = []

    @property
    def times(self) -> tuple[float, ...]:
        """Times written so far."""
        return tuple(time for time, _ in self._entries)

    def write(
        self, time: float, mesh: QuadMesh, *, point_data: Data | None = None, cell_data: Data | None = None
    ) -> None:
        """Add a step.

        Parameters
        ----------
        time : float
            Later than the last one.
        mesh : QuadMesh
        point_data, cell_data : mapping of str to array_like, optional
            As for `hoblock.io.vtu.write_vtu`.

        Raises
        ------
        ValueError
            If the time is not later, or as for `hoblock.io.vtu.write_vtu`.
        OSError
            If a file cannot be written; the series then is what it was.
        """
        check_time(time, self._entries[-1][0] if self._entries else None)
        name = f"{self.path.stem}_{len(self._entries):05d}.vtu"
        write_vtu(self.path.with_name(name), mesh, point_data=point_data, cell_data=cell_data)
        entries = [*self._entries, (float(time), name)]
        write_pvd(self.path, entries)
        self._entries = entries


def check_time(time: float, last: float | None) -> None:
    """Refuse a time that is not later than the last one.

    Raises
    ------
    ValueError
    """
    if not (time > (float("-inf") if last is None else last)) or time == float("inf"):
        raise ValueError(f"time is {time!r}; expected a finite number{'' if last is None else f' above {last!r}'}.")
