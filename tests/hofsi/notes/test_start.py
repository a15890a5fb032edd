"""Initial velocities against the boundary and continuity."""

from __future__ import annotations

import pytest

VISCOSITY = "viscosity = 0.1"


def starting(x, y):
    return VISCOSITY, f'viscosity = 0.1\ninitial_velocity = ["{x}", "{y}"]'


def test_a_start_that_fits_needs_no_note(noted):
    assert noted(starting("4*y*(1 - y)", "0")) == ()


def test_a_start_that_the_boundary_contradicts_is_impulsive(noted):
    (note,) = noted(starting("0.25", "0"))
    assert note.startswith("fluid.initial_velocity: at (0, 0.5) it differs by 0.75 from what the boundary has there")


def test_a_start_with_divergence(noted):
    (note,) = noted(starting("4*y*(1 - y)*(1 + x*(2 - x))", "0"))
    assert note.startswith("fluid.initial_velocity: its divergence is ")
    share = float(note.split("its divergence is ")[1].split(" %")[0])
    # ∂u/∂x = 8 y (1 - y)(1 - x), ∂u/∂y = 4 (1 - 2y)(1 + 2x - x²)
    along, across = 64.0 / 30.0 * 2.0 / 3.0, 16.0 / 3.0 * (2.0 + 8.0 / 3.0 + 16.0 / 15.0)
    assert share == pytest.approx(100.0 * (along / (along + across)) ** 0.5, rel=0.05)


def test_a_start_that_differs_between_periodic_sides(noted, periodic_channel):
    (_, note, *_) = noted(starting("y*(1 - y)*(1 + x)", "0"), text=periodic_channel)
    assert note.startswith(
        "fluid.initial_velocity: it differs by 0.5 between (0, 0.5) and (2, 0.5), which are the same"
    )
    assert "by fluid.boundary[1]: the velocity at one of them is taken" in note
    (enclosed,) = noted(starting("y*(1 - y)*(2 + sin(pi*x))", "pi*cos(pi*x)*(y**3/3 - y**2/2)"), text=periodic_channel)[
        :1
    ]
    assert "periodic" in enclosed


def test_a_steady_scene_only_starts_from_it(noted):
    assert noted(starting("0.25", "0"), ("dt = 0.1\nsteps = 5", "steady = true")) == ()
