"""Runs of scenes, and numbers that judge them."""

from __future__ import annotations

import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hofsi.build import Problem, build
from hofsi.case import Case
from hofsi.errors import ConvergenceError
from hofsi.io.scene import load_case, read_case
from hofsi.notes import notes
from hofsi.quantities import evaluators
from hofsi.quantities.body import solid_state
from hofsi.records import StepRecord
from hofsi.report import Report
from hofsi.simulate import simulate
from hofsi.solvers import solid_integrals

Array = NDArray[np.float64]

__all__ = ["EXAMPLES", "Run", "difference", "example", "marched", "read", "reported", "teeth"]

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@dataclass(frozen=True, eq=False)
class Run:
    """What is left of a run.

    Attributes
    ----------
    problem : Problem
    last : StepRecord
    times, iterations : ndarray, shape (n,)
        Of all steps; iterations are 0 without coupling.
    series : mapping of str to ndarray, shape (n,)
        Quantities.
    whole : ndarray of bool, shape (n,)
        Steps that end at a multiple of ``dt``.
    """

    problem: Problem
    last: StepRecord
    times: Array
    iterations: Array
    series: Mapping[str, Array]
    whole: NDArray[np.bool_]

    @property
    def mean(self) -> float:
        """Mean coupling iterations for each multiple of ``dt``."""
        return float(self.iterations.sum() / self.whole.sum())

    def at_whole_steps(self, name: str) -> Array:
        """A quantity at multiples of ``dt``."""
        return self.series[name][self.whole]


def read(scene: str) -> Case:
    """The case of a scene."""
    return read_case(tomllib.loads(scene), "scene.toml")


def example(name: str, *changes: str) -> Case:
    """The case of an example with changes."""
    return load_case(EXAMPLES / f"{name}.toml", changes)


def marched(asked: str | Case) -> Run:
    """All steps of a scene or a case; a solid alone has the series ``strain`` and ``kinetic`` of its energies too."""
    problem = build(read(asked) if isinstance(asked, str) else asked)
    wanted = {**evaluators(problem), **_energies(problem)}
    rows, times, iterations, whole = [], [], [], []
    for record in simulate(problem):
        last = record
        rows.append([evaluate(record) for evaluate in wanted.values()])
        times.append(record.time)
        iterations.append(0 if record.coupling is None else record.coupling.iterations)
        whole.append(abs(record.done - round(record.done)) < 1e-9)
    columns = np.array(rows, dtype=float).reshape(len(rows), -1).T
    series = dict(zip(wanted, columns, strict=True))
    return Run(problem, last, np.array(times), np.array(iterations, dtype=float), series, np.array(whole))


def _energies(problem: Problem) -> dict[str, Callable[[StepRecord], float]]:
    if problem.fluid is not None or problem.solid is None:
        return {}
    solver = problem.solid.solver
    return {
        "strain": lambda record: solid_integrals.strain_energy(solver, solid_state(record)),
        "kinetic": lambda record: solid_integrals.kinetic_energy(solver, solid_state(record)),
    }


def reported(asked: str | Case) -> tuple[Mapping[str, Any], Mapping[str, Array]]:
    """Summary and quantities of a run as a user has it; the error that ended it is raised."""
    problem = build(read(asked) if isinstance(asked, str) else asked)
    failures: list[ConvergenceError] = []

    def steps() -> Iterator[StepRecord]:
        try:
            yield from simulate(problem)
        except ConvergenceError as error:
            failures.append(error)
            raise

    with tempfile.TemporaryDirectory() as folder:
        report = Report(problem, Path(folder), evaluators(problem), None, perf_counter(), (), None)
        for text in notes(problem):
            report.note(text)
        result = report.follow(steps())
    if failures:
        raise failures[0]
    return result.summary, result.series


def difference(series: Array | Sequence[float], reference: Array | Sequence[float]) -> float:
    """Largest difference of two series, relative to the largest value of the second."""
    a, b = np.asarray(series, dtype=float), np.asarray(reference, dtype=float)
    return float(np.abs(a - b).max() / np.abs(b).max())


def teeth(values: Array) -> tuple[float, float]:
    """Amplitude of what changes its sign from step to step, in the first and the second half of a series."""
    saw = np.abs(values[:-2] - 2.0 * values[1:-1] + values[2:]) / 4.0
    half = len(saw) // 2
    return float(saw[:half].max()), float(saw[half:].max())
