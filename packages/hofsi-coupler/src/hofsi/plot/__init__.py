"""Pictures of a run: its mesh and fields at one time, its quantities over time."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hofsi.build import Problem
from hofsi.case import Case, Probe
from hofsi.plot.pictures import plot_fields
from hofsi.plot.series import plot_series
from hofsi.records import StepRecord

__all__ = ["plot_run"]


def plot_run(
    problem: Problem,
    last_record: StepRecord,
    series: Mapping[str, NDArray[np.float64]],
    directory: str | os.PathLike[str],
) -> list[Path]:
    """Draw the last step and the quantities as PNG files.

    ``mesh.png``; ``velocity.png`` and ``pressure.png`` with the solid drawn over them, or ``displacement.png`` of a
    solid alone; unless the case is steady, ``quantities.png``, and the quantity that defines the period in a file of
    its own.

    Parameters
    ----------
    problem : Problem
    last_record : StepRecord
        The step whose fields are drawn.
    series : mapping of str to ndarray, shape (n,)
        The quantities by name, and their times as ``"t"``.
    directory : path-like
        Made if it does not exist.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    ValueError
        If the series have different lengths.
    """
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    written = plot_fields(problem, last_record, directory)
    if last_record.dt and len(series) > 1:
        written += plot_series(
            series, directory, problem.case.title, _first(problem.case), alone=problem.case.output.period_of
        )
    return written


def _first(case: Case) -> str | None:
    """The quantity to look at first: that of the period, or the first transverse displacement."""
    if case.output.period_of is not None:
        return case.output.period_of
    for quantity in case.quantities:
        if isinstance(quantity, Probe) and (quantity.field, quantity.component) == ("displacement", "y"):
            return quantity.name
    return None
