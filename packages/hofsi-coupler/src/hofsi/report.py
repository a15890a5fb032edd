"""What a run leaves behind: its observers, and the summary in the end."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal, TextIO, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hofsi.build import Problem
from hofsi.case import Steady, TimeSettings
from hofsi.errors import ConvergenceError
from hofsi.interruptions import Interruptions
from hofsi.io.summary import count_summary, machine, phase_seconds, versions, write_summary
from hofsi.observers.checkpoint import CheckpointWriter
from hofsi.observers.divisions import DivisionWatch
from hofsi.observers.observer import Observer
from hofsi.observers.progress import Progress
from hofsi.observers.quality import MeshQuality
from hofsi.observers.table import QuantityTable, StepTable
from hofsi.records import StepRecord
from hofsi.resume import Resumption
from hofsi.statistics import statistics
from hofsi.timestepping.control import StepControl

if TYPE_CHECKING:
    from hofsi.observers.resolution import FlowResolutionWatch

Array = NDArray[np.float64]
Status: TypeAlias = Literal["completed", "failed", "interrupted", "running"]

__all__ = ["Report", "Result"]


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


def _step_count(time: TimeSettings, start: Resumption | None) -> int | None:
    """How many of the scene's steps a run has in all; None if it is steady."""
    if isinstance(time, Steady):
        return None
    if start is None or start.record.memory is None:
        return time.steps
    return StepControl.resumed(time, start.record.memory.control, start.record.time, start.record.dt).total


class Report:
    """The observers of one run and its summary.

    Parameters
    ----------
    problem : Problem
    folder : Path
        For the results; it exists.
    read : mapping of str to callable
        The quantities, see `hofsi.quantities.evaluators`.
    progress : text file or None
        Where to show a live line.
    began : float
        When the run began, by `time.perf_counter`.
    changes : sequence of str
        That were made to the scene.
    start : Resumption or None
        What the run goes on from; None if it starts anew.
    """

    def __init__(
        self,
        problem: Problem,
        folder: Path,
        read: Mapping[str, Callable[[StepRecord], float]],
        progress: TextIO | None,
        began: float,
        changes: Sequence[str],
        start: Resumption | None,
    ) -> None:
        self._problem, self._folder, self._began, self._changes = problem, folder, began, changes
        kept = {} if start is None else start.observers
        sizes = {name: None if start is None else kept[name]["size"] for name in ("quantities", "steps")}
        time, output = problem.case.time, problem.case.output
        self._last: StepRecord | None = None
        self._quality = MeshQuality(None if problem.fluid is not None or problem.solid is None else problem.solid.mesh)
        self._quantities = QuantityTable(folder / "quantities.csv", read, sizes["quantities"])
        energies = None
        if output.energy:
            from hofsi.quantities.energy import EnergyBudget

            energies = EnergyBudget(problem).follow
        self._steps = StepTable(folder / "steps.csv", problem.counts, kept=sizes["steps"], energies=energies)
        self._notes: list[str] = []
        self._live = None if progress is None else Progress(progress, _step_count(time, start))
        self._observers: dict[str, tuple[str, Observer]] = {}  # with the phase that their time counts for
        if self._live is not None:
            self._observers["progress"] = ("tables", self._live)
        # What is cheap and must not be lost comes first.
        self._observers["quantities"] = ("quantities", self._quantities)
        self._observers["steps"] = ("tables", self._steps)
        self._observers["quality"] = ("quality", self._quality)
        if output.fields:
            with problem.clock.phase("fields"):
                from hofsi.observers.fields import FieldWriter

                self._observers["fields"] = ("fields", FieldWriter(problem, folder, output.every))
        self._divisions = None if isinstance(time, Steady) else DivisionWatch(time, self.note)
        if self._divisions is not None:
            self._observers["divisions"] = ("tables", self._divisions)
        self._resolution: FlowResolutionWatch | None = None
        if problem.fluid is not None and problem.fluid.solver.convecting:
            from hofsi.observers.resolution import FlowResolutionWatch

            self._resolution = FlowResolutionWatch(problem.fluid, self.note)
            self._observers["resolution"] = ("quality", self._resolution)
        self._checkpoint = CheckpointWriter(problem, folder, output.checkpoint_every, self._memory)
        self._observers["checkpoint"] = ("checkpoints", self._checkpoint)
        if start is None:
            self._checkpoint.path.unlink(missing_ok=True)  # of an earlier run: it would not go on with this one
        else:
            self._recall(start)

    def _memory(self) -> dict[str, Any]:
        """What the observers know, and this report."""
        own = {
            "notes": list(self._notes),
            "seconds": dict(self._problem.clock.seconds),
            "total": perf_counter() - self._began,
        }
        return {"report": own, **{name: observer.memory() for name, (_, observer) in self._observers.items()}}

    def _recall(self, start: Resumption) -> None:
        """Go on from what was known when the restart file was written."""
        own = start.observers["report"]
        self._last, self._notes, seconds = start.record, list(own["notes"]), self._problem.clock.seconds
        for name, spent in own["seconds"].items():
            seconds[name] = seconds.get(name, 0.0) + spent
        self._began -= own["total"]
        for name, (_, observer) in self._observers.items():
            if name in start.observers:
                observer.recall(start.observers[name], start.record)

    def note(self, text: str) -> None:
        """Tell the user something, and keep it for the summary."""
        self._notes.append(text)
        if self._live is not None:
            self._live.say(f"note: {text}.")

    def follow(self, steps: Iterable[StepRecord]) -> Result:
        """Observe every step, and leave everything written whatever happens."""
        status: Status = "failed"
        reason = ""
        self._write("running", "")
        with Interruptions() as interruptions:
            try:
                for record in steps:
                    with interruptions.held():
                        self._observe(record)
                if self._problem.case.output.checkpoint_every is not None:
                    self._checkpoint.write()
                steady = isinstance(self._problem.case.time, Steady)
                status, reason = "completed", "steady state found" if steady else "end of the time interval reached"
            except ConvergenceError as error:
                reason = str(error)
                if self._last is not None and self._checkpoint.write():
                    reason += f" The last good state, t = {self._last.time:g}, is in {self._checkpoint.path}."
            except KeyboardInterrupt:
                interruptions.hold()
                status, reason = "interrupted", f"interrupted {self._when()}"
                self._checkpoint.write()
                raise
            except BaseException as error:
                reason = f"{type(error).__name__}: {error}"
                raise
            finally:
                interruptions.hold()
                summary = self._finish(status, reason)
        return Result(status, reason, self._folder, summary, self._quantities.times, self._quantities.series)

    def _observe(self, record: StepRecord) -> None:
        self._last = record
        for phase, observer in self._observers.values():
            with self._problem.clock.phase(phase):
                observer.observe(record)

    def _when(self) -> str:
        if self._last is None:
            return "before the first step was finished"
        return f"after step {self._last.step}, t = {self._last.time:g}"

    def _finish(self, status: Status, reason: str) -> dict[str, Any]:
        try:
            self._close([*self._observers.values()])
        finally:
            summary = self._write(status, reason)
        if self._problem.case.output.plots and self._last is not None:
            with self._problem.clock.phase("plots"):
                self._plot(self._last)
            summary = self._write(status, reason)
        return summary

    def _close(self, observers: Sequence[tuple[str, Observer]]) -> None:
        """Close observers, the others even if one of them fails."""
        if observers:
            phase, observer = observers[0]
            try:
                with self._problem.clock.phase(phase):
                    observer.close()
            finally:
                self._close(observers[1:])

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
            "seconds": phase_seconds(self._problem.clock, perf_counter() - self._began),
            "counts": count_summary(self._problem, self._steps.sums),
            "t": None if self._last is None else self._last.time,
            "time_steps": {} if self._divisions is None else self._divisions.summary(),
            "notes": list(self._notes),
            "quality": self._quality.summary(),
            "resolution": {} if self._resolution is None else self._resolution.summary(),
            "period_of": case.output.period_of,
            "quantities": {name: asdict(values) for name, values in numbers.items()},
        }
