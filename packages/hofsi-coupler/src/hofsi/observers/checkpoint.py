"""Restart files, written while a run goes on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hofsi.build import Problem
from hofsi.io.restart_file import RESTART_FILE, write_restart
from hofsi.records import StepRecord

__all__ = ["CheckpointWriter"]


class CheckpointWriter:
    """Writes ``restart.npz`` every N-th step, in place of the last one, and whenever it is asked to.

    It is the last of the observers, so that the others have seen the step.

    Parameters
    ----------
    problem : Problem
    directory : path-like
        Where the file goes.
    every : int or None
        Steps of the scene's ``dt`` between files; None for none but those that are asked for.
    gather : callable
        Returns what the other observers know, by name.
    """

    def __init__(
        self, problem: Problem, directory: Path, every: int | None, gather: Callable[[], Mapping[str, object]]
    ) -> None:
        self.path = directory / RESTART_FILE
        self.path.with_name(f"{RESTART_FILE}.part").unlink(missing_ok=True)  # of a run that was killed while it wrote
        self._problem, self._every, self._gather = problem, every, gather
        self._last: StepRecord | None = None
        self._written = False

    def observe(self, record: StepRecord) -> None:
        """Write the file if it is time to."""
        self._last, self._written = record, False
        if self._every is not None and record.memory is not None and not record.done % self._every:
            self.write()

    def write(self) -> bool:
        """Write the file for the last step, if there is one to go on after; return whether there is."""
        if self._last is None or self._last.memory is None:
            return False
        if not self._written:
            write_restart(self.path, self._problem, self._last, self._gather())
            self._written = True
        return True

    def close(self) -> None:
        """Nothing to do: what the other observers know is not complete any more."""

    def memory(self) -> dict[str, Any]:
        """Nothing."""
        return {}

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Take the step as the last one."""
        self._last = record
