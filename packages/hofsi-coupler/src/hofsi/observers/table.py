"""Tables that grow by a line in every step: ``quantities.csv`` and ``steps.csv``."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import astuple, fields
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hofsi.counts import Counts
from hofsi.errors import RestartError
from hofsi.records import CouplingRecord, StepRecord

Array = NDArray[np.float64]

__all__ = ["QuantityTable", "STEP_COLUMNS", "StepTable", "check_table", "quantity_columns"]

STEP_COLUMNS = (
    "step",
    "t",
    "dt",
    "coupling_iterations",
    "displacement_residual",
    "force_residual",
    "interface_work_fluid",
    "interface_work_solid",
    "interface_mass_flux",
    "min_det_J",
    "blocks_regenerated",
    "mesh_substeps",
    "mesh_amplification",
    "factorisations",
    "factorised_because",
    "assemblies",
    "preconditioners",
    "linear_iterations",
    "kinetic_energy",
    "strain_energy",
    "dissipation",
    "power",
    "energy_defect",
    "local_error",
    "rejected",
    "rejected_because",
    "seconds",
)
"""Columns of ``steps.csv``; those that a problem does not have stay empty."""


_COUNTED = ("assemblies", "preconditioners", "linear_iterations")
"""Columns with sums of the fields' counts so far."""


class _Lines:
    """A CSV file whose lines are on disk as soon as they are written."""

    def __init__(self, path: str | os.PathLike[str], columns: Sequence[str], kept: int | None = None) -> None:
        path = Path(path)
        if kept is not None:
            os.truncate(path, kept)
        self._file = path.open("w" if kept is None else "a", encoding="utf-8", newline="")
        self._writer = csv.writer(self._file, lineterminator="\n")
        if kept is None:
            self.write(columns)

    @property
    def size(self) -> int:
        """Bytes so far, which are on the disk then."""
        self._file.flush()
        os.fsync(self._file.fileno())
        return os.fstat(self._file.fileno()).st_size

    def write(self, cells: Sequence[object]) -> None:
        """Write a line; None is an empty cell, and numbers keep all their digits."""
        self._writer.writerow(cells)
        self._file.flush()

    def close(self) -> None:
        self._file.close()


def check_table(path: Path, columns: Sequence[str], kept: int) -> None:
    """Check that a table can be cut off after some bytes and continued.

    Raises
    ------
    RestartError
        If it has not so many, or other columns.
    """
    size = path.stat().st_size if path.is_file() else 0
    if size < kept:
        raise RestartError(
            f"{path}: has {size} bytes; expected at least the {kept} that it had when the restart file was written. Go "
            "on in the directory of that run, or in a new one, or run from the start, without --resume."
        )
    with path.open("rb") as file:
        head = file.readline().decode("utf-8", "replace").rstrip()
    if head != ",".join(columns):
        raise RestartError(
            f"{path}: has the columns {head!r}; expected {','.join(columns)!r}. Go on in the directory of the run, or "
            "run from the start, without --resume."
        )


def _rounded(time: float) -> float:
    """A time without the rounding error of its last digits: 0.3 and not 0.30000000000000004."""
    return float(f"{time:.12g}")


def quantity_columns(names: Iterable[str]) -> tuple[str, ...]:
    """Columns of ``quantities.csv``."""
    return ("step", "t", *names)


class QuantityTable:
    """Evaluates the quantities of every step, writes them down and keeps them.

    Parameters
    ----------
    path : path-like
        Of a CSV file with the columns step, t and the names; it is flushed in every step.
    evaluators : mapping of str to callable
        See `hofsi.quantities.evaluators`.
    kept : int, optional
        Bytes of the file that are kept, in a run that goes on, see `check_table`; by default it is written anew.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        evaluators: Mapping[str, Callable[[StepRecord], float]],
        kept: int | None = None,
    ) -> None:
        self._evaluators = dict(evaluators)
        self._times: list[float] = []
        self._values: dict[str, list[float]] = {name: [] for name in evaluators}
        self._lines = _Lines(path, quantity_columns(evaluators), kept)

    @property
    def times(self) -> Array:
        """Times of the steps so far, shape (n,)."""
        return np.array(self._times)

    @property
    def series(self) -> dict[str, Array]:
        """Values of each quantity so far, shape (n,) each."""
        return {name: np.array(values) for name, values in self._values.items()}

    def observe(self, record: StepRecord) -> None:
        """Write the line of a step."""
        row = {name: float(evaluate(record)) for name, evaluate in self._evaluators.items()}
        self._times.append(record.time)
        for name, value in row.items():
            self._values[name].append(value)
        self._lines.write((record.step, _rounded(record.time), *row.values()))

    def memory(self) -> dict[str, Any]:
        """The series so far, and the size of the file."""
        return {"times": self.times, "series": self.series, "size": self._lines.size}

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Go on with the series."""
        self._times = memory["times"].tolist()
        self._values = {name: values.tolist() for name, values in memory["series"].items()}

    def close(self) -> None:
        """Close the file."""
        self._lines.close()


class StepTable:
    """Writes down how each step went, and adds up what the summary tells.

    Parameters
    ----------
    path : path-like
    counts : mapping of str to Counts
        Of each field, live: what is written of them is as it stands after the step; the reasons for factorisations are
        the step's own.
    clock : callable
        Seconds; those since the table was opened are written.
    kept : int, optional
        As of `QuantityTable`.
    energies : callable, optional
        What is to be written of energies: kinetic, strain, dissipation, power, and what is left of their balance. It is
        called for every step, and first for the step that a run goes on after.

    Attributes
    ----------
    steps, coupling_iterations : int
        So far.
    blocks_regenerated : int
        Blocks whose mesh was generated anew, summed over the meshes of the finished steps.
    mesh_jumps : int
        Steps in which the mesh probably jumped: see `hoblock.motion.MeshState.snapped`.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        counts: Mapping[str, Counts],
        clock: Callable[[], float] = perf_counter,
        kept: int | None = None,
        energies: Callable[[StepRecord], Sequence[float | None]] | None = None,
    ) -> None:
        self._energies = energies or (lambda record: (None,) * 5)
        self._counts, self._clock = counts, clock
        self._opened = clock()
        self._mesh: object = None
        self._reasons: dict[str, int] = {}
        self._lines = _Lines(path, STEP_COLUMNS, kept)
        self.steps = self.coupling_iterations = self.blocks_regenerated = self.mesh_jumps = 0

    def observe(self, record: StepRecord) -> None:
        """Write the line of a step."""
        coupling, mesh = record.coupling, record.state.mesh
        moved = mesh is not None and mesh is not self._mesh
        blocks = None if mesh is None else mesh.regenerated if moved else 0
        motion = (mesh.substeps, float(f"{mesh.amplification:.4g}")) if mesh is not None and moved else (None, None)
        self.mesh_jumps += mesh is not None and moved and mesh.snapped
        self._mesh = mesh
        self.steps += 1
        self.coupling_iterations += 0 if coupling is None else coupling.iterations
        self.blocks_regenerated += blocks or 0
        self._lines.write(
            (
                record.step,
                _rounded(record.time),
                _rounded(record.dt),
                *((None,) * len(fields(CouplingRecord)) if coupling is None else astuple(coupling)),
                record.min_det_J,
                blocks,
                *motion,
                sum(count.factorisations for count in self._counts.values()),
                self._because(),
                *(sum(getattr(count, name) for count in self._counts.values()) for name in _COUNTED),
                *self._energies(record),
                record.local_error,
                len(record.rejected),
                ", ".join(dict.fromkeys(rejection.error for rejection in record.rejected)) or None,
                round(self._clock() - self._opened, 4),
            )
        )

    @property
    def sums(self) -> dict[str, int]:
        """What was added up, by name."""
        return {
            "steps": self.steps,
            "coupling_iterations": self.coupling_iterations,
            "blocks_regenerated": self.blocks_regenerated,
            "mesh_jumps": int(self.mesh_jumps),
        }

    def memory(self) -> dict[str, Any]:
        """What was added up, the reasons told so far, the seconds, and the size of the file."""
        return {
            **self.sums,
            "reasons": self._reasons,
            "seconds": self._clock() - self._opened,
            "size": self._lines.size,
        }

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Go on with the sums."""
        self.steps, self.coupling_iterations = memory["steps"], memory["coupling_iterations"]
        self.blocks_regenerated, self.mesh_jumps = memory["blocks_regenerated"], memory["mesh_jumps"]
        self._reasons, self._mesh = dict(memory["reasons"]), record.state.mesh
        self._opened = self._clock() - memory["seconds"]
        self._energies(record)

    def _because(self) -> str | None:
        """Reasons for the factorisations of this step, with their numbers."""
        reasons: dict[str, int] = {}
        for count in self._counts.values():
            for reason, number in count.reasons.items():
                reasons[reason] = reasons.get(reason, 0) + number
        new = {reason: number - self._reasons.get(reason, 0) for reason, number in reasons.items()}
        self._reasons = reasons
        return ", ".join(f"{reason} {number}" for reason, number in sorted(new.items()) if number) or None

    def close(self) -> None:
        """Close the file."""
        self._lines.close()
