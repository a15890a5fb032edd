"""Flow rates, their balance, moments and integrals as a scene asks for them."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

import numpy as np
import pytest

from hofsi.build import build
from hofsi.case import Case, TimeFunction
from hofsi.errors import CaseError
from hofsi.io.scene import read_case
from hofsi.quantities import evaluators
from hofsi.simulate import simulate

Read = Callable[..., Case]

# A piston at the right end of a channel that is open at the left.
PISTON = """
[mesh]
order = 3
elements = 3

[mesh.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]

[mesh.blocks]
fluid = [["a", "b", "c", "d"]]

[mesh.edges]
bottom = [["a", "b"]]
right = [["b", "c"]]
top = [["c", "d"]]
left = [["d", "a"]]

[fluid]
density = 1.0
viscosity = 0.5

[[fluid.boundary]]
on = ["bottom", "top", "right"]
type = "no-slip"

[[fluid.boundary]]
on = "left"
type = "do-nothing"

[[motion]]
on = "right"
x = "-0.3*t"
y = 0

[time]
dt = 0.1
steps = 3

[quantities.out]
type = "flow-rate"
on = "left"

[quantities.swept]
type = "flow-rate"
on = "right"

[quantities.through]
type = "flow-rate"
on = "right"
relative_to = "mesh"

[quantities.balance]
type = "flow-balance"

[quantities.area]
type = "area"

[quantities.residual]
type = "continuity-residual"

[quantities.energy]
type = "kinetic-energy"

[quantities.push]
type = "force"
on = "right"
component = "x"

[quantities.pressure]
type = "mean-pressure"
on = "right"

[quantities.turn]
type = "moment"
on = "right"
about = "b"

[quantities.turn_fixed]
type = "moment"
on = "right"
about = ["2 - 0.3*t", 0]

[quantities.turn_elsewhere]
type = "moment-coefficient"
on = "right"
about = [0, 0]
density = 2.0
velocity = 1.0
length = 0.5

[quantities.motion]
type = "expression"
value = "-0.3*t"
"""


def test_a_piston_moves_what_it_sweeps() -> None:
    problem = build(read_case(tomllib.loads(PISTON), "piston.toml"))
    read = evaluators(problem)
    for record in simulate(problem):
        found = {name: evaluate(record) for name, evaluate in read.items()}
        assert found["swept"] == pytest.approx(-0.3, rel=1e-12)
        assert found["out"] == pytest.approx(0.3, rel=1e-12)
        assert abs(found["through"]) < 1e-15
        assert abs(found["balance"]) < 1e-12
        assert abs(found["residual"]) < 1e-14
        assert found["area"] == pytest.approx(2.0 - 0.3 * record.time, rel=1e-13)
        assert found["motion"] == pytest.approx(-0.3 * record.time, rel=1e-15)
        assert found["energy"] > 0.0
        assert found["push"] > 0.0
        # The resultant acts at half of the height, on the piston's way too.
        assert found["turn"] == pytest.approx(-0.5 * found["push"], rel=1e-9)
        assert found["turn_fixed"] == pytest.approx(found["turn"], rel=1e-12)
        # About the origin the lever of a force along x is the same; shear on the piston has no resultant.
        assert found["turn_elsewhere"] == pytest.approx(4.0 * found["turn"], rel=1e-9)


def test_the_flow_past_a_deforming_flap_is_balanced(flap: str) -> None:
    text = flap.replace("[quantities.lift]", '[quantities.net]\ntype = "flow-balance"\n\n[quantities.lift]')
    text += '\n[quantities.swept]\ntype = "flow-rate"\non = "flap"\n'
    data = tomllib.loads(text)
    data["time"], data["output"] = {"dt": 0.1, "steps": 4}, {}
    problem = build(read_case(data, "flap.toml"))
    read = evaluators(problem)
    swept = []
    for record in simulate(problem):
        assert abs(read["net"](record)) < 1e-10
        swept.append(read["swept"](record))
    assert np.abs(swept).max() > 1e-6


@pytest.mark.parametrize(
    ("quantity", "match"),
    [
        ('type = "flow-rate"\non = "inside"', r"quantities.q.on: edge .* of 'inside' .* expected an edge at the bound"),
        ('type = "mean-pressure"\non = "foot"', r"quantities.q.on: edge .* of 'foot' is at a solid alone, and this"),
        ('type = "moment"\non = "foot"\nabout = "b0"', r"quantities.q.on: .*'foot' is at a solid alone"),
    ],
)
def test_edges_that_are_not_at_the_fluid(read_changed: Read, flap: str, quantity: str, match: str) -> None:
    with pytest.raises(CaseError, match=match):
        read_changed(text=f"{flap}\n[quantities.q]\n{quantity}\n")


@pytest.mark.parametrize(
    "quantity",
    [
        'type = "flow-rate"\non = "flap"',
        'type = "flow-balance"',
        'type = "mean-pressure"\non = "flap"',
        'type = "moment"\non = "flap"\nabout = "b0"',
        'type = "enstrophy"',
        'type = "probe"\nfield = "vorticity"\nat = "b1"',
    ],
)
def test_a_solid_alone_has_none_of_these(read_changed: Read, solid_alone: str, quantity: str) -> None:
    with pytest.raises(CaseError, match=r"quantities.q: it is of the fluid, and there is no \[fluid\]"):
        read_changed(text=f"{solid_alone}\n[quantities.q]\n{quantity}\n")


def test_a_function_of_time_needs_no_body(read_changed: Read, solid_alone: str) -> None:
    quantity = read_changed(text=f'{solid_alone}\n[quantities.q]\ntype = "expression"\nvalue = "sin(t)"\n').quantities[
        0
    ]
    assert isinstance(quantity, TimeFunction)
