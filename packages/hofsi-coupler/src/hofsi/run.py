"""From a case to a folder of results."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal, TextIO, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MissingExtraError, SceneError
from hofsi.build import Problem, build
from hofsi.case import Case, OutputSettings, Steady
from hofsi.errors import ConvergenceError
from hofsi.io.summary import machine, versions, write_summary
from hofsi.memory import keep_freed_memory
from hofsi.notes import notes
from hofsi.observers.divisions import DivisionWatch
from hofsi.observers.observer import Observer
from hofsi.observers.progress import Progress
from hofsi.observers.quality import MeshQuality
from hofsi.observers.table import QuantityTable, StepTable
from hofsi.quantities import evaluators
from hofsi.records import StepRecord
from hofsi.simulate import simulate
from hofsi.statistics import statistics

if TYPE_CHECKING:
    from hofsi.observers.resolution import FlowResolutionWatch

Array = NDArray[np.float64]
Status: TypeAlias = Literal["completed", "failed", "interrupted", "running"]

__all__ = ["Result", "run"]


@dataclass(frozen=True, eq=False)
class Result:
    """How a run went and what came out.

    Attributes
    ----------
    status : {"completed", "failed"}
    reason : str
        Why it ended.
    directory : Path
        With the files.
    summary : mapping
        The contents of ``summary.json``.
    times : ndarray, shape (n,)
        Of the finished steps.
    series : mapping of str to ndarray, shape (n,)
        The quantities.
    """

    status: Status
    reason: str
    directory: Path
    summary: Mapping[str, Any]
    times: Array
    series: Mapping[str, Array]


def run(
    case: Case, directory: str | os.PathLike[str], *, progress: TextIO | None = None, changes: Sequence[str] = ()
) -> Result:
    """Build a case, simulate it, and write what comes out.

    The directory gets ``quantities.csv`` and ``steps.csv``, which grow during the run, ``summary.json``, and, as the
    case asks for them, ``fluid.pvd``, ``solid.pvd`` and plots. All of them are written for a run that fails or is
    interrupted, too, with what was computed until then.

    Parameters
    ----------
    case : Case
    directory : path-like
        Made if it does not exist; files of an earlier run in it are replaced.
    progress : text file, optional
        Where to show a live line, for example ``sys.stderr``.
    changes : sequence of str, optional
        The changes that were made to the scene, ``"mesh.order=6"`` for example; they are noted in the summary.

    Returns
    -------
    Result
        With the status "failed" if a step did not converge.

    Raises
    ------
    HoblockError, CaseError
        If the case cannot be built; nothing is written then.
    MissingExtraError
        If a package for fields or plots is missing; nothing is computed then.
    OSError
        If the directory cannot be written.
    KeyboardInterrupt
        After everything has been written, with the status "interrupted".
    """
    began = perf_counter()
    keep_freed_memory()
    _check_plotting(case.output)
    try:
        problem = build(case)
        with problem.clock.phase("build"):
            read, known = evaluators(problem), notes(problem)
    except SceneError as error:
        error.file = error.file or case.file
        raise
    folder = Path(directory)
    folder.mkdir(parents=True, exist_ok=True)
    report = _Report(problem, folder, read, progress, began, changes)
    for text in known:
        report.note(text)
    return report.follow()


def _check_plotting(output: OutputSettings) -> None:
    """Drawing is the last thing in a run; that it is not possible should be known before the first."""
    if output.plots and find_spec("matplotlib") is None:
        raise MissingExtraError(
            "plots need matplotlib, which is not installed. Install it with\n    python -m pip install "
            '"hofsi-coupler[plot]"\nor set output.plots = false',
            "matplotlib",
            "plot",
        )


class _Report:
    """The observers of one run and its summary."""

    def __init__(
        self,
        problem: Problem,
        folder: Path,
        read: Mapping[str, Callable[[StepRecord], float]],
        progress: TextIO | None,
        began: float,
        changes: Sequence[str],
    ) -> None:
        self._problem, self._folder, self._began, self._changes = problem, folder, began, changes
        time, output = problem.case.time, problem.case.output
        self._last: StepRecord | None = None
        self._quality = MeshQuality(None if problem.fluid is not None or problem.solid is None else problem.solid.mesh)
        self._observers: list[tuple[str, Observer]] = []
        if output.fields:
            with problem.clock.phase("fields"):
                from hofsi.observers.fields import FieldWriter

                self._observers.append(("fields", FieldWriter(problem, folder, output.every)))
        self._quantities = QuantityTable(folder / "quantities.csv", read)
        self._steps = StepTable(folder / "steps.csv", problem.counts)
        # What is cheap and must not be lost comes first.
        self._observers[:0] = [("quantities", self._quantities), ("tables", self._steps), ("quality", self._quality)]
        self._notes: list[str] = []
        self._live = None if progress is None else Progress(progress, None if isinstance(time, Steady) else time.steps)
        if self._live is not None:
            self._observers.insert(0, ("tables", self._live))
        self._divisions = None if isinstance(time, Steady) else DivisionWatch(time, self.note)
        if self._divisions is not None:
            self._observers.append(("tables", self._divisions))
        self._resolution: FlowResolutionWatch | None = None
        if problem.fluid is not None and problem.fluid.solver.convecting:
            from hofsi.observers.resolution import FlowResolutionWatch

            self._resolution = FlowResolutionWatch(problem.fluid, self.note)
            self._observers.append(("quality", self._resolution))

    def note(self, text: str) -> None:
        """Tell the user something, and keep it for the summary."""
        self._notes.append(text)
        if self._live is not None:
            self._live.say(f"note: {text}.")

    def follow(self) -> Result:
        """Simulate, observe every step, and leave everything written whatever happens."""
        status: Status = "failed"
        reason = ""
        self._write("running", "")
        try:
            for record in simulate(self._problem):
                self._last = record
                for phase, observer in self._observers:
                    with self._problem.clock.phase(phase):
                        observer.observe(record)
            steady = isinstance(self._problem.case.time, Steady)
            status, reason = "completed", "steady state found" if steady else "end of the time interval reached"
        except ConvergenceError as error:
            reason = str(error)
        except KeyboardInterrupt:
            status, reason = "interrupted", f"interrupted {self._when()}"
            raise
        except BaseException as error:
            reason = f"{type(error).__name__}: {error}"
            raise
        finally:
            summary = self._finish(status, reason)
        return Result(status, reason, self._folder, summary, self._quantities.times, self._quantities.series)

    def _when(self) -> str:
        if self._last is None:
            return "before the first step was finished"
        return f"after step {self._last.step}, t = {self._last.time:g}"

    def _finish(self, status: Status, reason: str) -> dict[str, Any]:
        try:
            self._close(0)
        finally:
            summary = self._write(status, reason)
        if self._problem.case.output.plots and self._last is not None:
            with self._problem.clock.phase("plots"):
                self._plot(self._last)
            summary = self._write(status, reason)
        return summary

    def _close(self, first: int) -> None:
        """Close all observers, the others even if one of them fails."""
        if first < len(self._observers):
            phase, observer = self._observers[first]
            try:
                with self._problem.clock.phase(phase):
                    observer.close()
            finally:
                self._close(first + 1)

    def _plot(self, record: StepRecord) -> None:
        from hofsi.plot import plot_run

        plot_run(self._problem, record, {"t": self._quantities.times, **self._quantities.series}, self._folder)

    def _write(self, status: Status, reason: str) -> dict[str, Any]:
        summary = self._summary(status, reason)
        write_summary(self._folder / "summary.json", summary)
        return summary

    def _summary(self, status: Status, reason: str) -> dict[str, Any]:
        case = self._problem.case
        numbers = statistics(self._quantities.times, self._quantities.series, case.output.period_of)
        return {
            "status": status,
            "reason": reason,
            "scene": {"title": case.title, "file": Path(case.file).name, "changes": list(self._changes)},
            "versions": versions(),
            "machine": machine(),
            "seconds": self._seconds(),
            "counts": self._counts(),
            "t": None if self._last is None else self._last.time,
            "time_steps": {} if self._divisions is None else self._divisions.summary(),
            "notes": list(self._notes),
            "quality": self._quality.summary(),
            "resolution": {} if self._resolution is None else self._resolution.summary(),
            "period_of": case.output.period_of,
            "quantities": {name: asdict(values) for name, values in numbers.items()},
        }

    def _seconds(self) -> dict[str, float]:
        total = perf_counter() - self._began
        phases = dict(self._problem.clock.seconds)
        phases["other"] = max(0.0, total - sum(phases.values()))
        return {name: round(seconds, 4) for name, seconds in {"total": total, **phases}.items()}

    def _counts(self) -> dict[str, Any]:
        steps, problem = self._steps, self._problem
        counts: dict[str, Any] = {
            "steps": steps.steps,
            "coupling_iterations": steps.coupling_iterations,
            "assemblies": sum(count.assemblies for count in problem.counts.values()),
            "factorisations": sum(count.factorisations for count in problem.counts.values()),
            "blocks_regenerated": steps.blocks_regenerated,
            "mesh_jumps": steps.mesh_jumps,
        }
        if problem.fluid is not None:
            fluid = problem.fluid
            size = {"elements": len(fluid.mesh.cells), "unknowns": fluid.solver.space.size}
            moving = {} if fluid.motion is None else {f"moving_{name}": n for name, n in fluid.motion.moving.items()}
            counts["fluid"] = {**size, **moving, **asdict(fluid.solver.counts)}
        if problem.solid is not None:
            solid = problem.solid
            size = {"elements": len(solid.mesh.cells), "unknowns": 2 * len(solid.mesh.points)}
            counts["solid"] = {**size, **asdict(solid.solver.counts)}
        return counts
