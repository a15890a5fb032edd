"""Work and mass at the interface."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from hofsi.build import build
from hofsi.io.scene import read_case
from hofsi.simulate import simulate


def records(flap, dt, geometry, scheme="bdf2"):
    text = flap
    for old, new in (
        ("sin(t)", "t**2"),
        ("dt = 0.1", f'dt = {dt}\nsolid = "{scheme}"'),
        ("end = 2.0", "end = 1.0"),
        ("[coupling]", f'[coupling]\ngeometry = "{geometry}"\ntolerance = 1e-7'),
    ):
        assert old in text
        text = text.replace(old, new)
    return [record.coupling for record in simulate(build(read_case(tomllib.loads(text), "flap.toml")))]


@pytest.mark.parametrize("scheme", ["bdf2", "generalised-alpha", "energy-momentum"])
def test_work_on_both_sides_agrees_to_second_order(flap, scheme):
    gaps = []
    for dt in (0.05, 0.025):
        found = records(flap, dt, "extrapolated", scheme)
        fluid, solid = (np.array([getattr(record, name) for record in found]) for name in ("work_fluid", "work_solid"))
        late = slice(len(found) // 2, None)
        assert fluid[late].sum() > 0.0  # the flow bends the flap
        gaps.append(abs(fluid[late].sum() - solid[late].sum()) / solid[late].sum())
    assert gaps[0] < 0.02
    assert gaps[1] < 0.35 * gaps[0]


def test_nothing_flows_through_an_interface_that_the_mesh_follows(flap):
    found = records(flap, 0.1, "implicit")
    assert max(abs(record.mass_flux) for record in found) < 1e-7


def test_what_flows_through_an_extrapolated_interface_vanishes_with_the_step(flap):
    flux = [
        max(abs(record.mass_flux) for record in records(flap, dt, "extrapolated")[-4:]) for dt in (0.1, 0.05, 0.025)
    ]
    assert flux[0] > 1e-9
    assert flux[1] < 0.35 * flux[0]
    assert flux[2] < 0.35 * flux[1]


def test_a_steady_state_has_no_work(flap):
    text = flap[: flap.index("[time]")] + "[time]\nsteady = true\n\n" + flap[flap.index("[coupling]") :]
    text = text.replace("*sin(t)", "*0.1").replace('period_of = "u_x"', "")
    (record,) = simulate(build(read_case(tomllib.loads(text), "flap.toml")))
    assert (record.coupling.work_fluid, record.coupling.work_solid, record.coupling.mass_flux) == (None, None, None)
