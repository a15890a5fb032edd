"""From a restart file to what a run goes on from: whether it is one of the case, and what is different now."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hofsi.build import Problem
from hofsi.case import Unsteady
from hofsi.case_values import Change, case_values, changes
from hofsi.errors import RestartError
from hofsi.io.restart_file import RestartFile, read_restart
from hofsi.io.summary import versions
from hofsi.observers.table import STEP_COLUMNS, check_table, quantity_columns
from hofsi.records import StepRecord

__all__ = ["Resumption", "resumption", "take_tables"]

_NUMERICAL = ("numpy", "scipy", "hoblock", "hofsi")  # packages on which rounding depends


@dataclass(frozen=True, eq=False)
class Resumption:
    """What a run goes on from.

    Attributes
    ----------
    record : StepRecord
        The step to go on after.
    observers : mapping of str to object
        What each of the observers knew then.
    notes : tuple of str
        What is different from the run before; empty if the run goes on to the bit as that one would have.
    """

    record: StepRecord
    observers: Mapping[str, Any]
    notes: tuple[str, ...]


def resumption(problem: Problem, path: Path) -> Resumption:
    """Read a restart file for a problem.

    Parameters
    ----------
    problem : Problem
    path : Path

    Raises
    ------
    RestartError
        If there is no such file, it is damaged or of another format, or the case differs from that of the run in what
        cannot change.
    """
    time = problem.case.time
    if not isinstance(time, Unsteady):
        raise RestartError("time.steady: got true; a steady state has no steps to go on after. Leave --resume out.")
    file = read_restart(path)
    found = changes(file.values, case_values(problem.case))
    if file.mesh != RestartFile.mesh_of(problem):
        raise RestartError(
            f"mesh: its nodes are not those of the run that wrote {path}, although the scene says the same of it; a "
            "file that it names, or the version of hoblock, is another one. Restore it, or run from the start, without "
            "--resume."
        )
    record, observers = file.content(problem)
    if time.end < record.time - 1e-9 * time.dt:
        raise RestartError(
            f"time.end: got {time.end:g}; expected at least {record.time:g}, the time of the restart file. Set a later "
            "end."
        )
    if any(change.of_matrices for change in found):
        record = _without_factors(record)
    return Resumption(record, observers, tuple(_notes(record, found, file.versions)))


def _notes(record: StepRecord, found: list[Change], before: Mapping[str, str]) -> list[str]:
    start = f"resumed after step {record.step}, t = {record.time:g}"
    notes = [f"{start}, with {change}" for change in found]
    now = versions()
    others = [
        f"{name} {now[name]} instead of {before.get(name)}" for name in _NUMERICAL if now[name] != before.get(name)
    ]
    if others:
        notes.append(f"{start}, with {', '.join(others)}: rounding may differ from that of the run before")
    return notes


def _without_factors(record: StepRecord) -> StepRecord:
    """The step without what matrices were made from that are others now."""
    memory = record.memory
    return record if memory is None else replace(record, memory=replace(memory, march=memory.march.without_factors()))


def take_tables(source: Path, folder: Path, start: Resumption, quantities: Iterable[str]) -> None:
    """Check the tables of a run that goes on, and copy them if it does so in another directory.

    Parameters
    ----------
    source, folder : Path
        Where they are, and where they go on; what is in the way there is replaced.
    start : Resumption
    quantities : iterable of str
        Their names.

    Raises
    ------
    RestartError
        If they are not beside the restart file, or are not those that were there when it was written.
    """
    columns = {"quantities": quantity_columns(quantities), "steps": STEP_COLUMNS}
    for name, own in columns.items():
        check_table(source / f"{name}.csv", own, start.observers[name]["size"])
    folder.mkdir(parents=True, exist_ok=True)
    if source.resolve() != folder.resolve():
        for name in columns:
            shutil.copyfile(source / f"{name}.csv", folder / f"{name}.csv")
