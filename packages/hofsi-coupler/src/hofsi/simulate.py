"""The time loop and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.build import Problem
from hofsi.errors import AddedMassError, ConvergenceError
from hofsi.fem.nodal_weights import nodal_weights
from hofsi.records import CouplingRecord, Rejection, RunMemory, State, StepRecord
from hofsi.threads import one_thread
from hofsi.timestepping.control import StepControl
from hofsi.timestepping.local_error import LocalErrors

__all__ = ["simulate"]

Array = NDArray[np.float64]

_SAME_GAIN = 0.9  # of the gain with twice the step, which differs a little from step to step
_STEPS = 4  # step sizes remembered, for multi-step schemes and predictors


def simulate(problem: Problem, after: StepRecord | None = None) -> Iterator[StepRecord]:
    """Run a problem and yield every finished step; a steady problem yields one.

    A step that fails, or is not accurate enough if the case has a tolerance, is tried again with half its size. While a
    step is computed the BLAS works with one thread, see `hofsi.threads`.

    Parameters
    ----------
    problem : Problem
        Made by `hofsi.build.build`.
    after : StepRecord, optional
        A step of the same problem, to go on after it to the bit as the run did that yielded it. The times and settings
        of the problem's case may be others.

    Yields
    ------
    StepRecord
        What was yielded stays valid whatever happens later.

    Raises
    ------
    ConvergenceError
        If a step does not succeed however small it is made.
    ValueError
        If ``after`` is a steady state.
    """
    times = problem.case.time
    alone = one_thread()
    if isinstance(times, case.Steady):
        with alone():
            state, coupling = problem.march.steady(problem.march.initial(0.0))
        yield _record(1, 0.0, 0.0, state, coupling)
        return
    errors = None if times.tolerance is None else _local_errors(problem)
    if after is None:
        state, sizes, control, number = problem.march.initial(times.start), [], StepControl(times), 1
    else:
        with alone():
            control = _resumed(problem, times, after, errors)
        state, sizes, number = after.state, [] if after.memory is None else list(after.memory.sizes), after.step + 1
    rejected: list[Rejection] = []
    last: ConvergenceError | None = None
    while not control.finished:
        time, size = control.time, control.size
        steps = [size, *sizes][:_STEPS]
        try:
            with alone():
                new, coupling = problem.march.step(state, steps, time)
                error = None if errors is None else errors.estimate(_fields(new), steps)
        except ConvergenceError as failure:
            if failure.reason == "rounding":
                raise  # half the step has four times as much of it
            if _is_worse(failure, last):
                raise _got_worse(failure, size) from failure
            last = failure
            if control.halve(failed=True):
                rejected.append(Rejection(size, type(failure).__name__, str(failure)))
                continue
            raise _given_up(failure, size, times) from failure
        if error is not None and not control.suffices(error) and control.halve(failed=False):
            rejected.append(Rejection(size, "LocalError", f"local error {error:.2g}, expected {times.tolerance:g}"))
            continue
        if errors is not None:
            errors.keep(_fields(new))
        record = _record(number, time, size, new, coupling, control.done, error, tuple(rejected))
        control.advance(error)
        state, sizes, rejected, last, number = new, steps, [], None, number + 1
        kept = None if errors is None else errors.memory()
        yield replace(record, memory=RunMemory(tuple(sizes), control.memory(), kept, problem.march.memory()))


def _resumed(problem: Problem, times: case.Unsteady, after: StepRecord, errors: LocalErrors | None) -> StepControl:
    """Let the solvers become what they were after a step; return what says which step comes next."""
    memory = after.memory
    if memory is None:
        raise ValueError(f"after: step {after.step} is a steady state; expected a time step.")
    problem.march.resume(after.state, memory.march)
    if errors is not None and memory.errors is not None:
        errors.recall(memory.errors)
    return StepControl.resumed(times, memory.control, after.time, after.dt)


def _record(
    number: int,
    time: float,
    dt: float,
    state: State,
    coupling: CouplingRecord | None,
    done: float = 1.0,
    error: float | None = None,
    rejected: tuple[Rejection, ...] = (),
) -> StepRecord:
    bound = None if state.mesh is None else state.mesh.min_det_J
    return StepRecord(number, time, dt, state, coupling, bound, done, error, rejected)


def _is_worse(failure: ConvergenceError, last: ConvergenceError | None) -> bool:
    """Whether a step failed for the added mass, as the one of twice its size did before, and came no further."""
    if not isinstance(failure, AddedMassError) or not isinstance(last, AddedMassError):
        return False
    no_nearer = failure.residual >= last.residual or failure.reason == last.reason == "diverged"
    return no_nearer and failure.gain >= _SAME_GAIN * last.gain


def _got_worse(failure: ConvergenceError, size: float) -> ConvergenceError:
    """The error of a step that half the size did not help."""
    return failure.extended(f"Half of the step, {size:.6g}, came no further than the whole; it is not halved again.")


def _given_up(failure: ConvergenceError, size: float, times: case.Unsteady) -> ConvergenceError:
    """The error of the smallest step."""
    if not times.halvings:
        return failure
    return failure.extended(
        f"That was the smallest step, {size:.6g}: dt, halved time.halvings = {times.halvings} times."
    )


def _local_errors(problem: Problem) -> LocalErrors:
    parts = {"fluid": problem.fluid, "solid": problem.solid}
    return LocalErrors({name: nodal_weights(part.mesh) for name, part in parts.items() if part is not None})


def _fields(state: State) -> dict[str, Array]:
    """What the local error is measured in: the fluid's velocity and the solid's displacement."""
    fields = {}
    if state.fluid is not None:
        fields["fluid"] = state.fluid.velocity
    if state.solid is not None:
        fields["solid"] = state.solid.displacement
    return fields
