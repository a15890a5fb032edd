"""From a case to a folder of results."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import TextIO

from hoblock.errors import MissingExtraError, SceneError
from hofsi.build import build
from hofsi.case import Case, OutputSettings
from hofsi.memory import keep_freed_memory
from hofsi.notes import notes
from hofsi.quantities import evaluators
from hofsi.report import Report, Result
from hofsi.resume import resumption, take_tables
from hofsi.simulate import simulate

__all__ = ["Result", "run"]


def run(
    case: Case,
    directory: str | os.PathLike[str],
    *,
    progress: TextIO | None = None,
    changes: Sequence[str] = (),
    resume: str | os.PathLike[str] | None = None,
) -> Result:
    """Build a case, simulate it, and write what comes out.

    The directory gets ``quantities.csv`` and ``steps.csv``, which grow during the run, ``summary.json``, and, as the
    case asks for them, ``fluid.pvd``, ``solid.pvd`` and plots. All of them are written for a run that fails or is
    interrupted, too, with what was computed until then; it then leaves ``restart.npz`` as well, from which the run can
    be resumed after its last finished step. Resumed without changes it ends with the same files, to the bit, as if it
    had never stopped, but for the seconds it took. Files of steps after that of the restart file are removed.

    Parameters
    ----------
    case : Case
    directory : path-like
        Made if it does not exist; files of an earlier run in it are replaced.
    progress : text file, optional
        Where to show a live line, for example ``sys.stderr``.
    changes : sequence of str, optional
        The changes that were made to the scene, ``"mesh.order=6"`` for example; they are noted in the summary.
    resume : path-like, optional
        A restart file to go on from, usually ``restart.npz`` in the directory. Times, settings and values of the case
        may be others than in the run that wrote it; the notes list them.

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
    RestartError
        If the restart file cannot be read, or the case cannot go on from it; nothing is written then.
    OSError
        If the directory cannot be written.
    KeyboardInterrupt
        After everything has been written, with the status "interrupted"; for SIGTERM it is
        `hofsi.interruptions.Terminated`.
    """
    began = perf_counter()
    keep_freed_memory()
    _check_plotting(case.output)
    try:
        problem = build(case)
        with problem.clock.phase("build"):
            read, known = evaluators(problem), notes(problem)
            start = None if resume is None else resumption(problem, Path(resume))
    except SceneError as error:
        error.file = error.file or case.file
        raise
    folder = Path(directory)
    if start is not None and resume is not None:
        take_tables(Path(resume).parent, folder, start, read)
    folder.mkdir(parents=True, exist_ok=True)
    report = Report(problem, folder, read, progress, began, changes, start)
    for text in known if start is None else start.notes:
        report.note(text)
    return report.follow(simulate(problem, None if start is None else start.record))


def _check_plotting(output: OutputSettings) -> None:
    """Drawing is the last thing in a run; that it is not possible should be known before the first."""
    if output.plots and find_spec("matplotlib") is None:
        raise MissingExtraError(
            "plots need matplotlib, which is not installed. Install it with\n    python -m pip install "
            '"hofsi-coupler[plot]"\nor set output.plots = false',
            "matplotlib",
            "plot",
        )
