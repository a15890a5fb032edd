"""The time loop and nothing else."""

from __future__ import annotations

from collections.abc import Iterator

from hofsi import case
from hofsi.build import Problem
from hofsi.records import CouplingRecord, State, StepRecord
from hofsi.threads import one_thread

__all__ = ["simulate"]

_STEPS = 4  # step sizes remembered, for multi-step schemes and predictors


def simulate(problem: Problem) -> Iterator[StepRecord]:
    """Run a problem and yield every finished step; a steady problem yields one.

    While a step is computed the BLAS works with one thread, see `hofsi.threads`.

    Parameters
    ----------
    problem : Problem
        Made by `hofsi.build.build`.

    Yields
    ------
    StepRecord
        What was yielded stays valid whatever happens later.

    Raises
    ------
    ConvergenceError
        If a step does not succeed.
    """
    times = problem.case.time
    alone = one_thread()
    if isinstance(times, case.Steady):
        with alone():
            state, coupling = problem.march.steady(problem.march.initial(0.0))
        yield _record(1, 0.0, 0.0, state, coupling)
        return
    state = problem.march.initial(times.start)
    sizes: list[float] = []
    for step in range(1, times.steps + 1):
        time, size = times.step(step)
        sizes = [size, *sizes][:_STEPS]
        with alone():
            state, coupling = problem.march.step(state, sizes, time)
        yield _record(step, time, size, state, coupling)


def _record(step: int, time: float, dt: float, state: State, coupling: CouplingRecord | None) -> StepRecord:
    bound = None if state.mesh is None else state.mesh.min_det_J
    return StepRecord(step, time, dt, state, coupling, bound)
