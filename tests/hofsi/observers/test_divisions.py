"""What a run tells of steps that were divided."""

from __future__ import annotations

from hofsi.case import Unsteady
from hofsi.observers.divisions import DivisionWatch
from hofsi.records import Rejection, State, StepRecord


def observed(tolerance: float | None, *steps: tuple[float, float | None, list[str]]) -> tuple[DivisionWatch, list[str]]:
    notes: list[str] = []
    watch = DivisionWatch(Unsteady(0.1, 0.0, 1.0, 10, tolerance=tolerance), notes.append)
    for number, (dt, error, kinds) in enumerate(steps, start=1):
        rejected = tuple(Rejection(2.0 * dt, kind, "fluid, t = 1: it failed.") for kind in kinds)
        watch.observe(StepRecord(number, 0.1 * number, dt, State(), local_error=error, rejected=rejected))
    watch.close()
    return watch, notes


def test_failures_are_told_a_few_times_and_counted() -> None:
    watch, notes = observed(None, (0.1, None, []), *[(0.05, None, ["NewtonError"])] * 5)
    assert len(notes) == 3
    assert notes[0] == "fluid, t = 1: it failed. The step of 0.1 was divided"
    assert notes[2].endswith("steps.csv")
    assert watch.summary() == {"dt_min": 0.05, "dt_max": 0.1, "rejected": {"NewtonError": 5}, "inaccurate": 0}


def test_inaccurate_attempts_are_what_the_user_asked_for() -> None:
    watch, notes = observed(1e-3, (0.1, 9e-4, []), (0.05, 1e-4, ["LocalError", "LocalError"]))
    assert notes == []
    assert watch.summary()["rejected"] == {"LocalError": 2}


def test_an_error_that_stays_too_large_is_told_once() -> None:
    watch, notes = observed(1e-3, (0.1, 2e-3, []), (0.1, 3e-3, []))
    (note,) = notes
    assert "local error is 0.002" in note
    assert "time.tolerance = 0.001" in note
    assert "time.halvings" in note
    assert watch.summary()["inaccurate"] == 2


def test_there_is_nothing_to_say_before_the_first_step() -> None:
    assert observed(None)[0].summary() == {}
