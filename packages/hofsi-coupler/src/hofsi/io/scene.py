"""Scene files, read into a `hofsi.case.Case`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from hoblock.io.scene import constants_of, read_mesh_scene
from hoblock.io.table import Table
from hoblock.io.toml import apply_overrides, naming_file, read_toml
from hofsi.case import Case
from hofsi.case_checks import check_case
from hofsi.errors import CaseError
from hofsi.io.materials import read_fluid, read_motion, read_solid
from hofsi.io.movers import read_mover
from hofsi.io.quantities import read_quantity
from hofsi.io.settings import read_coupling, read_linear, read_nonlinear, read_output, read_solid_scheme, read_time

__all__ = ["load_case", "read_case"]

_TABLES = (
    "title",
    "constants",
    "mesh",
    "fluid",
    "solid",
    "motion",
    "mover",
    "time",
    "coupling",
    "nonlinear",
    "linear",
    "output",
    "quantities",
)

_RIVALS = {
    "steps": ("end", "steady"),
    "end": ("steps", "steady"),
    "dt": ("steady",),
    "steady": ("dt", "end", "steps", "start", "tolerance", "halvings", "first", "solid", "spectral_radius"),
}
"""Keys of ``[time]`` that exclude others."""


def load_case(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Case:
    """Read a scene file.

    Parameters
    ----------
    path : path-like
        The TOML file.
    overrides : sequence of str, optional
        Changes such as ``"time.dt=0.01"``, see `hoblock.io.toml.apply_overrides`. One of ``time.steps``, ``time.end``,
        ``time.dt`` and ``time.steady`` takes the place of keys in the file that exclude it.

    Returns
    -------
    Case

    Raises
    ------
    SceneError
        If the file cannot be read, or a key is missing, unknown, of the wrong type or out of range.
    CaseError
        If the scene is well-formed but cannot be simulated; it is a `SceneError` too. Both name file and place.
    """
    data = read_toml(path)
    with naming_file(path):
        data = _without_rivals(apply_overrides(data, overrides), overrides)
    return read_case(data, os.fspath(path))


def _without_rivals(data: dict[str, Any], overrides: Sequence[str]) -> dict[str, Any]:
    """Drop keys of ``[time]`` that exclude a key set by an override: the later word counts."""
    asked = {override.split("=", 1)[0].strip() for override in overrides}
    time = data.get("time")
    if isinstance(time, dict):
        for key, rivals in _RIVALS.items():
            if f"time.{key}" in asked and time.get(key) is not False:
                for rival in rivals:
                    if f"time.{rival}" not in asked:
                        time.pop(rival, None)
    return data


def read_case(data: Mapping[str, Any], file: str) -> Case:
    """Read a parsed scene.

    Parameters
    ----------
    data : mapping
        The whole file as a TOML parser gives it.
    file : str
        Name of the file, for error messages.

    Returns
    -------
    Case
        Complete and checked by `hofsi.case_checks.check_case`.

    Raises
    ------
    SceneError, CaseError
        As `load_case`.
    """
    with naming_file(file):
        whole = Table(data)
        _note_tables(whole)
        whole.finish()
        case = _case(whole, data, file)
        check_case(case)
    return case


def _note_tables(whole: Table) -> None:
    """Make all top-level keys of the format known, so that an unknown one is the first mistake to be reported."""
    for key in _TABLES:
        whole.has(key)


def _case(whole: Table, data: Mapping[str, Any], file: str) -> Case:
    mesh = read_mesh_scene(data, file)
    constants = constants_of(data)
    if not (whole.has("fluid") or whole.has("solid")):
        raise CaseError("there is nothing to simulate: neither [fluid] nor [[solid]]. Add one of them")
    if not whole.has("time"):
        raise CaseError("[time] is missing. Add it with steady = true, or with dt and end", "time")
    times = whole.table("time")
    scheme = read_solid_scheme(times)
    time = read_time(times)
    quantities = tuple(
        read_quantity(name, table, mesh, constants) for name, table in whole.named_tables("quantities").items()
    )
    return Case(
        title=whole.string("title", ""),
        file=file,
        mesh=mesh,
        fluid=read_fluid(whole.table("fluid"), mesh, constants) if whole.has("fluid") else None,
        solids=tuple(read_solid(table, mesh, constants) for table in whole.tables("solid")),
        time=time,
        scheme=scheme,
        motions=tuple(read_motion(table, mesh, constants) for table in whole.tables("motion")),
        mover=read_mover(whole.table("mover", required=False), mesh, constants),
        coupling=read_coupling(whole.table("coupling", required=False), time),
        nonlinear=read_nonlinear(whole.table("nonlinear", required=False)),
        linear=read_linear(whole.table("linear", required=False)),
        output=read_output(whole.table("output", required=False), [quantity.name for quantity in quantities]),
        quantities=quantities,
        tables=tuple(whole),
    )
