"""Conditions that contradict where edges meet are told with place and values."""

from __future__ import annotations

import re

import pytest

OUTLET = ('on = "right"\ntype = "do-nothing"', 'on = "right"\ntype = "velocity"\nx = "4*y*(1 - y)"\ny = 0')


def test_a_scene_without_contradictions_has_no_notes(noted):
    assert noted() == ()


def test_a_uniform_inflow_meets_walls(noted):
    (note,) = noted(('x = "4*y*(1 - y)"', "x = 2"))
    assert re.match(
        r"fluid.boundary\[1\]: at \(0, [01]\) and 1 more node it gives the velocity 2, and a .* there 0,", note
    )


def test_given_velocities_that_differ_at_a_corner(noted):
    walls = (
        'on = ["bottom", "top"]\ntype = "no-slip"',
        'on = ["bottom", "top"]\ntype = "velocity"\nx = "0.1*x"\ny = 0',
    )
    late = noted(walls, ('x = "4*y*(1 - y)"', 'x = "4*y*(1 - y) + 0.3*(y > 0.99)"'))
    assert len(late) == 1
    assert (
        "fluid.boundary[1]: at (0, 1) it gives the velocity 0.3, and a condition that comes first there 0," in late[0]
    )


def test_slip_beside_a_velocity_that_crosses_it(noted):
    slip = ('on = ["bottom", "top"]\ntype = "no-slip"', 'on = ["bottom", "top"]\ntype = "slip"')
    assert noted(slip) == ()
    (note,) = noted(slip, ("y = 0\n", "y = 0.5\n"))
    assert note.startswith("fluid.boundary[0]: at (0, ")
    assert re.search(r"it gives the velocity 0, and a condition that comes first there -?0\.5,", note)


@pytest.mark.parametrize("value", ["0.1*t", "-0.1*t"])
def test_walls_that_a_motion_drives_are_not_judged(noted, value):
    motion = ("[time]", f'[[motion]]\non = ["top"]\nx = 0\ny = "{value}*x"\n\n[time]')
    assert noted(motion) == ()
