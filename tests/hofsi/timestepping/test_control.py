"""Which step comes next."""

from __future__ import annotations

import itertools

import pytest

from hofsi.case import Unsteady
from hofsi.timestepping.control import StepControl


def walk(control: StepControl, fails=lambda time, size: False, error=lambda time, size: None):
    """All accepted steps as (time, size, done), and how often a step was tried in vain."""
    steps, tried = [], 0
    while not control.finished:
        time, size = control.time, control.size
        estimate = error(time, size)
        if fails(time, size) or not control.suffices(estimate):
            tried += 1
            assert control.halve(failed=fails(time, size))
            continue
        steps.append((time, size, control.done))
        control.advance(estimate)
    return steps, tried


@pytest.mark.parametrize("time", [Unsteady(0.1, 0.0, 1.0, 10), Unsteady(0.3, 0.2, 1.0, 3), Unsteady(0.1, 5.0, 5.1, 1)])
def test_without_trouble_the_steps_are_those_of_the_case(time):
    steps, tried = walk(StepControl(time))
    assert [(end, size) for end, size, _ in steps] == [time.step(k) for k in range(1, time.steps + 1)]
    assert [done for *_, done in steps] == list(range(1, time.steps + 1))
    assert tried == 0


def test_a_failed_step_is_halved_until_it_succeeds_and_doubled_again():
    time = Unsteady(1.0, 0.0, 4.0, 4)
    steps, _ = walk(
        StepControl(time), fails=lambda end, size: (1.2 < end < 1.5 and size > 0.25) or (end == 2.0 and size > 0.5)
    )
    assert [(end, size) for end, size, _ in steps] == [
        (1.0, 1.0),
        (1.5, 0.5),
        (2.0, 0.5),
        (3.0, 1.0),
        (4.0, 1.0),
    ]


def test_times_are_sums_of_the_sizes_and_meet_the_ends_of_the_whole_steps_exactly():
    time = Unsteady(0.1, 0.3, 1.25, 10)
    steps, _ = walk(StepControl(time), fails=lambda end, size: size > 0.1 * abs(end - 0.71) + 0.01)
    ends = [0.3, *(end for end, *_ in steps)]
    for (before, end), (_, size, _) in zip(itertools.pairwise(ends), steps, strict=True):
        assert end - before == pytest.approx(size, rel=1e-12)
    assert {time.step(k)[0] for k in range(1, 11)} <= set(ends)
    assert ends[-1] == 1.25
    ratios = [later[1] / earlier[1] for earlier, later in itertools.pairwise(steps)]
    assert max(ratios) == pytest.approx(2.0)
    assert min(size for _, size, _ in steps) < 0.0126


def test_what_failed_after_doubling_is_tried_again_later_and_later():
    time = Unsteady(1.0, 0.0, 1000.0, 1000)
    steps, tried = walk(StepControl(time), fails=lambda end, size: size == 1.0)
    assert len(steps) == 2000
    assert 5 < tried < 20


def test_there_is_an_end_to_halving():
    control = StepControl(Unsteady(1.0, 0.0, 1.0, 1, halvings=2))
    assert [control.halve(failed=True) for _ in range(4)] == [True, True, False, False]
    assert control.size == 0.25
    assert not StepControl(Unsteady(1.0, 0.0, 1.0, 1, halvings=0)).halve(failed=False)


def test_steps_keep_the_tolerance_and_are_not_much_smaller_than_that_needs():
    time = Unsteady(1.0, 0.0, 8.0, 8, halvings=10, tolerance=1e-4, first=1.0)

    def error(end, size):
        return (size / (1.0 if end > 5.0 else 4.0)) ** 3  # what the third derivative of the solution makes of a step

    steps, _ = walk(StepControl(time), error=error)
    assert all(error(end, size) <= 1e-4 for end, size, _ in steps)
    assert all(error(end, size) >= 1e-4 / 8.0 / 10.0 for end, size, _ in steps)
    assert {size for end, size, _ in steps if end < 4.9} == {0.125}
    assert {size for end, size, _ in steps if end > 5.1} == {0.03125}


def test_without_an_estimate_steps_do_not_grow_if_there_is_a_tolerance():
    time = Unsteady(1.0, 0.0, 1.0, 1, halvings=4, tolerance=1e-4, first=0.125)
    steps, _ = walk(StepControl(time))
    assert [size for _, size, _ in steps] == [0.125] * 8


def test_small_first_steps_grow_at_once_if_there_is_no_tolerance():
    time = Unsteady(1.0, 0.0, 3.0, 3, halvings=4, first=0.13)
    steps, _ = walk(StepControl(time))
    assert [size for _, size, _ in steps] == [0.125, 0.125, 0.25, 0.5, 1.0, 1.0]


def half_way(time, steps, fails=lambda time, size: False):
    """A control that has made some steps, with the end and size of the last one."""
    control, end, size = StepControl(time), time.start, time.dt
    for _ in range(steps):
        while fails(control.time, control.size):
            assert control.halve(failed=True)
        end, size = control.time, control.size
        control.advance(None)
    return control, end, size


@pytest.mark.parametrize("steps", range(1, 14))
def test_a_control_that_is_resumed_goes_on_as_it_would_have(steps):
    """Whatever it has divided: the second whole step fails until its parts are an eighth."""

    def fails(time, size):
        return 0.1 < time < 0.2 and size > 0.013

    time = Unsteady(0.1, 0.0, 0.45, 5)
    control, end, size = half_way(time, steps, fails)
    resumed = StepControl.resumed(time, control.memory(), end, size)
    assert walk(resumed, fails) == walk(control, fails)
    assert resumed.total == 5


def test_with_another_size_steps_are_counted_from_where_the_run_was():
    control, end, size = half_way(Unsteady(0.1, 0.0, 1.0, 10), 3)
    time = Unsteady(0.04, 0.0, 0.5, 13)
    steps, _ = walk(StepControl.resumed(time, control.memory(), end, size))
    assert [end for end, _, _ in steps] == pytest.approx([0.34, 0.38, 0.42, 0.46, 0.5])
    assert [done for _, _, done in steps] == [4, 5, 6, 7, 8]


def test_with_another_size_a_divided_step_counts_as_a_whole_one():
    control, end, size = half_way(Unsteady(0.1, 0.0, 1.0, 10), 2, lambda time, size: time > 0.1 and size > 0.06)
    assert end == pytest.approx(0.15)
    steps, _ = walk(StepControl.resumed(Unsteady(0.05, 0.0, 0.25, 5), control.memory(), end, size))
    assert [(end, done) for end, _, done in steps] == [(pytest.approx(0.2), 3.0), (pytest.approx(0.25), 4.0)]


def test_a_run_that_was_resumed_with_another_size_can_be_resumed_again():
    control, end, size = half_way(Unsteady(0.1, 0.0, 1.0, 10), 3)
    time = Unsteady(0.04, 0.0, 0.5, 13)
    second = StepControl.resumed(time, control.memory(), end, size)
    end, size = second.time, second.size
    second.advance(None)
    third = StepControl.resumed(time, second.memory(), end, size)
    assert third.total == second.total == 8
    assert walk(third) == walk(second)


def test_after_a_last_step_that_was_short_steps_are_counted_from_its_end():
    control, end, size = half_way(Unsteady(0.1, 0.0, 0.25, 3), 3)
    assert control.finished
    steps, _ = walk(StepControl.resumed(Unsteady(0.1, 0.0, 0.4, 4), control.memory(), end, size))
    assert [time for time, _, _ in steps] == pytest.approx([0.35, 0.4])
    assert StepControl.resumed(Unsteady(0.1, 0.0, 0.25, 3), control.memory(), end, size).finished


def test_with_a_tolerance_and_another_size_steps_begin_as_small_as_they_were():
    time = Unsteady(0.1, 0.0, 1.0, 10, halvings=10, tolerance=1e-3, first=0.1 / 16)
    control, end, size = half_way(time, 3)
    assert size == 0.1 / 16
    other = Unsteady(0.4, 0.0, 1.0, 3, halvings=10, tolerance=1e-3, first=0.4 / 16)
    assert StepControl.resumed(other, control.memory(), end, size).size == 0.4 / 64
