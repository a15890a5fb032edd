"""Expressions that the time steps cannot follow."""

from __future__ import annotations

import pytest

INFLOW = 'x = "4*y*(1 - y)"'


def inflow(factor):
    return INFLOW, f'x = "4*y*(1 - y)*({factor})"'


@pytest.mark.parametrize("period", [0.03, 0.1, 0.05, 0.21])
def test_a_period_of_few_steps_or_less_than_one(noted, period):
    (note,) = noted(inflow(f"sin(2*pi*t/{period})"), ("steps = 5", "steps = 40"))
    assert note.startswith('fluid.boundary[1].x: "4*y*(1 - y)*(sin(2*pi*t/')
    assert "changes within the time steps of 0.1" in note


@pytest.mark.parametrize("factor", ["sin(2*pi*t/2)", "t if t < 1 else 1", "1 if t < 0.23 else 0", "exp(-t)"])
def test_what_the_steps_follow_is_not_told(noted, factor):
    assert noted(inflow(factor), ("steps = 5", "steps = 40")) == ()


def test_motions_and_forces_are_looked_at_too(noted):
    motion = ("[time]", '[[motion]]\non = "right"\nx = "0.1*sin(60*t)"\ny = 0\n\n[time]')
    force = ("viscosity = 0.1", 'viscosity = 0.1\nbody_force = ["cos(90*t)", 0]')
    places = [note.split(":")[0] for note in noted(motion, force, ("steps = 5", "steps = 40"))]
    assert places == ["fluid.body_force[0]", "motion[0].x"]


def test_what_is_not_defined_at_some_time_is_left_to_the_run(noted):
    assert noted(inflow("sqrt(0.25 - t)*sin(99*t)")) == ()
