"""The load of the fluid on the solid where the interface ends."""

import tomllib

import numpy as np
import pytest

from hofsi.build import build
from hofsi.coupling.load import InterfaceLoad
from hofsi.io.scene import read_case
from hofsi.simulate import simulate

# A tray of fluid at rest under pressure on an elastic layer between rollers: the layer is compressed uniformly.
TRAY = """
[mesh]
order = 3
elements = 2

[mesh.vertices]
s0 = [0, 0]
s1 = [1, 0]
i0 = [0, 0.5]
i1 = [1, 0.5]
t0 = [-0.4, 1]
t1 = [1.3, 1.1]

[mesh.blocks]
fluid = [["i0", "i1", "t1", "t0"]]
solid = [["s0", "s1", "i1", "i0"]]

[mesh.edges]
walls = [["i0", "t0"], ["i1", "t1"]]
top = [["t0", "t1"]]
rollers = [["s0", "i0"], ["s1", "i1"], ["s0", "s1"]]

[fluid]
density = 1.0
viscosity = 0.1

[[fluid.boundary]]
on = "walls"
type = "no-slip"

[[fluid.boundary]]
on = "top"
type = "pressure"
value = 7.0

[[solid]]
density = 1.0
youngs_modulus = 100.0
poissons_ratio = 0.3
model = "linear"

[[solid.boundary]]
on = "rollers"
type = "roller"

[time]
steady = true

[coupling]
tolerance = 1e-10
"""


def steady(text):
    problem = build(read_case(tomllib.loads(text), "tray.toml"))
    return problem, next(simulate(problem))


@pytest.mark.parametrize("walls", ["no-slip", "slip"])
def test_a_wall_beside_the_interface_does_not_load_the_solid(walls):
    problem, record = steady(TRAY.replace('"no-slip"', f'"{walls}"'))
    X = problem.solid.mesh.points
    modulus = 100.0 * (1 - 0.3) / ((1 + 0.3) * (1 - 2 * 0.3))
    exact = np.stack([np.zeros(len(X)), -7.0 / modulus * X[:, 1]], axis=-1)
    np.testing.assert_allclose(record.state.solid.displacement, exact, atol=1e-12)


def test_the_load_is_that_of_the_pressure_and_nothing_else():
    problem, record = steady(TRAY)
    free = InterfaceLoad(problem.fluid.solver, problem.interface, np.zeros(len(problem.interface.fluid), dtype=bool))
    force = free.evaluate(record.state.fluid)
    np.testing.assert_allclose(force[:, 0], 0.0, atol=1e-9)
    np.testing.assert_allclose(force[:, 1].sum(), -7.0, atol=1e-9)
    x = problem.solid.mesh.points[problem.interface.solid, 0]
    np.testing.assert_allclose(x @ force[:, 1], -3.5, atol=1e-9)


def test_where_the_solid_is_held_nothing_is_corrected():
    problem, record = steady(TRAY)
    held = InterfaceLoad(problem.fluid.solver, problem.interface, np.ones(len(problem.interface.fluid), dtype=bool))
    np.testing.assert_array_equal(
        held.evaluate(record.state.fluid), -record.state.fluid.reaction[problem.interface.fluid]
    )
