"""The live line."""

from __future__ import annotations

import io
from typing import Any

import pytest

from hofsi.observers.progress import Progress
from hofsi.records import CouplingRecord, State, StepRecord


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class Hand:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def record(step: int, **others: Any) -> StepRecord:
    return StepRecord(step, 0.05 * step, 0.05, State(), done=float(step), **others)


def watch(stream: io.StringIO, durations: list[float], steps: int, **others: Any) -> str:
    clock = Hand()
    progress = Progress(stream, steps, clock=clock)
    for step, seconds in enumerate(durations, start=1):
        clock.now += seconds
        progress.observe(record(step, **others))
    progress.close()
    return stream.getvalue()


def test_a_line_has_everything() -> None:
    text = watch(io.StringIO(), [2.0], 40, coupling=CouplingRecord(5, 2e-8, 3.4e-7), min_det_J=1.25e-3)
    assert text == "step 1/40  t 0.05  dt 0.05  5 iterations  residual 3.4e-07  min det J 1.25e-03  1 min 18 s left\n"


def test_what_a_problem_does_not_have_is_left_out() -> None:
    assert watch(io.StringIO(), [2.0], 3) == "step 1/3  t 0.05  dt 0.05  4 s left\n"


def test_elsewhere_than_on_a_terminal_a_line_comes_every_few_seconds_and_at_the_end() -> None:
    lines = watch(io.StringIO(), [1.0] * 13, 13).splitlines()
    assert [line.split()[1] for line in lines] == ["1/13", "6/13", "11/13", "13/13"]
    assert lines[-1].endswith("0 s left")


def test_on_a_terminal_one_line_is_renewed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    text = watch(Terminal(), [1.0] * 4, 4, min_det_J=1.0)
    assert (text.count("\n"), text[-1]) == (1, "\n")
    states = text.strip("\r\n").split("\r")
    assert [state.split()[1] for state in states] == ["1/4", "2/4", "3/4", "4/4"]
    assert {len(state) for state in states} == {59}


def test_fast_steps_do_not_flood_a_terminal() -> None:
    text = watch(Terminal(), [0.001] * 1000, 1000)
    assert text.count("\r") < 20
    assert "step 1000/1000" in text


@pytest.mark.parametrize(("seconds", "left"), [(0.5, "50 s"), (10.0, "16 min 40 s"), (100.0, "2 h 46 min")])
def test_the_time_left_is_the_mean_duration_of_a_step_times_the_steps_left(seconds: float, left: str) -> None:
    last = watch(io.StringIO(), [seconds] * 20, 120).splitlines()[-1]
    assert last.endswith(f"{left} left")


def test_the_time_left_follows_a_run_that_becomes_slower() -> None:
    last = watch(io.StringIO(), [0.1] * 50 + [1.0] * 60, 210).splitlines()[-1]
    assert last.endswith("1 min 40 s left")  # 100 steps of 1 s, not of the mean of the whole run


def test_a_steady_state_has_no_time() -> None:
    stream = io.StringIO()
    progress = Progress(stream, None)
    progress.observe(StepRecord(1, 0.0, 0.0, State(), CouplingRecord(9, 1e-8, 1e-7), 0.5))
    progress.close()
    assert stream.getvalue() == "steady state  9 iterations  residual 1.0e-07  min det J 5.00e-01\n"


@pytest.mark.parametrize("stream", [Terminal(), io.StringIO()])
def test_nothing_is_shown_without_a_step(stream: io.StringIO) -> None:
    Progress(stream, 5).close()
    assert stream.getvalue() == ""


def test_parts_of_divided_steps_are_parts_of_the_time_left() -> None:
    stream, clock = io.StringIO(), Hand()
    progress = Progress(stream, 10, clock=clock)
    for number, done in enumerate((0.5, 1.0, 1.5), start=1):
        clock.now += 3.0
        progress.observe(StepRecord(number, 0.1 * done, 0.05, State(), done=done))
    progress.close()
    lines = stream.getvalue().splitlines()
    assert lines[0].startswith("step 0.50/10")
    assert lines[-1].startswith("step 1.50/10")
    assert lines[-1].endswith("51 s left")  # 8.5 steps of 6 s
