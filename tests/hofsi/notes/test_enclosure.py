"""Enclosed fluids: the level of the pressure is told, given velocities must balance."""

from __future__ import annotations

import pytest

from hofsi.errors import CaseError

OPEN = 'on = "right"\ntype = "do-nothing"'


def closed(profile):
    return OPEN, f'on = "right"\ntype = "velocity"\nx = "{profile}"\ny = 0'


def test_the_pressure_of_an_enclosed_fluid_has_the_mean_zero_and_that_is_said(noted):
    (note,) = noted(closed("4*y*(1 - y)"))
    assert note.startswith("The fluid is enclosed by given velocities")
    assert "the one with the mean 0 is taken" in note


@pytest.mark.parametrize("time", ["dt = 0.1\nsteps = 5", "steady = true"])
def test_velocities_that_do_not_balance_are_an_error_before_the_first_step(noted, time):
    times = ("dt = 0.1\nsteps = 5", time)
    with pytest.raises(CaseError, match=r"fluid.boundary: the velocities .* bring in 0\.6667 per unit time more than"):
        noted((OPEN, 'on = "right"\ntype = "no-slip"'), times)


def test_what_is_left_over_is_told(noted):
    first, second = noted(closed("4.04*y*(1 - y)"))
    assert "enclosed" in first
    assert second.startswith("The velocities around the enclosed fluid let out 0.006667 per unit time more")
    assert "evenly spread source" in second


def test_with_a_motion_the_balance_is_left_to_the_steps(noted):
    motion = ("[time]", '[[motion]]\non = "right"\nx = "-0.1*t"\ny = 0\n\n[time]')
    notes = noted((OPEN, 'on = "right"\ntype = "no-slip"'), motion)
    assert len(notes) == 1


def test_periodic_sides_enclose(noted, periodic_channel):
    (note,) = noted(text=periodic_channel)
    assert note.startswith("The fluid is enclosed by given velocities or periodic sides: the pressure is determined")
    assert noted(("dt = 0.1\nsteps = 5", "steady = true"), text=periodic_channel) == (note,)


def test_a_steady_flow_that_nothing_holds_is_an_error_before_the_run(noted, periodic_channel):
    slip = ('type = "no-slip"', 'type = "slip"')
    with pytest.raises(CaseError, match=r"nothing holds a uniform velocity along \(1, 0\): the steady velocity"):
        noted(slip, ("dt = 0.1\nsteps = 5", "steady = true"), text=periodic_channel)
    assert len(noted(slip, text=periodic_channel)) == 1


def test_sides_that_cannot_be_paired_are_an_error_before_the_run(noted, periodic_channel):
    with pytest.raises(CaseError, match=r"fluid.boundary\[1\].with: 'left' and 'right' are no translation"):
        noted(("c = [2, 1]", "c = [2, 1.5]"), text=periodic_channel)
