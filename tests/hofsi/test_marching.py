"""A fluid alone through the scene interface: what a moving boundary does to the flow."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from hoblock.layout import layout
from hofsi.build import Problem, build
from hofsi.errors import CaseError, MeshMotionError
from hofsi.io.scene import read_case
from hofsi.quantities import evaluators
from hofsi.records import StepRecord
from hofsi.simulate import simulate

MODES = ("newton", "picard", "linearised", "extrapolated")
MOVERS = ("pseudo-solid", "angle-optimisation")

# d ──────────── c
# │  h ── g      │
# │  │    │      │      a hole e f g h in a channel
# │  e ── f      │
# a ──────────── b
HOLE = """
[mesh]
order = 3

[mesh.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]
e = [0.5, 0.3]
f = [1.1, 0.35]
g = [1.0, 0.7]
h = [0.6, 0.7]

[mesh.blocks]
fluid = [["a", "b", "f", "e"], ["b", "c", "g", "f"], ["c", "d", "h", "g"], ["d", "a", "e", "h"]]

[mesh.edges]
bottom = [["a", "b"]]
right = [["b", "c"]]
top = [["c", "d"]]
left = [["d", "a"]]
hole = [["e", "f", "g", "h", "e"]]
"""

BOX = """
[mesh]
order = 3
elements = 2

[mesh.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]

[mesh.blocks]
one = [["a", "b", "c", "d"]]

[mesh.edges]
bottom = [["a", "b"]]
right = [["b", "c"]]
top = [["c", "d"]]
left = [["d", "a"]]
"""


def last(text: str) -> tuple[Problem, StepRecord, dict[str, float]]:
    """Run a scene to its end."""
    problem = build(read_case(tomllib.loads(text), "scene.toml"))
    read = evaluators(problem)
    *_, record = simulate(problem)
    return problem, record, {name: evaluate(record) for name, evaluate in read.items()}


def error(record: StepRecord, exact: Callable[[Any, Any], tuple[Any, Any]]) -> float:
    """Largest error of the velocity at the nodes, where they are now."""
    fluid = record.state.fluid
    assert fluid is not None
    x, y = fluid.points[0].T
    u, v = exact(x, y)
    return float(np.hypot(fluid.velocity[:, 0] - u, fluid.velocity[:, 1] - v).max())


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("mover", MOVERS)
@pytest.mark.parametrize("hole", ['type = "velocity"\nx = 1.3\ny = -0.7', 'type = "no-slip"'])
def test_a_constant_flow_stays_constant_around_a_hole_that_moves(mode: str, mover: str, hole: str) -> None:
    # With no-slip the hole drifts along with the flow; otherwise it moves as it likes.
    moved = ("1.3*t", "-0.7*t") if "no-slip" in hole else ("0.1*sin(9*t)", "0.05*sin(12*t) + 0.2*t")
    problem, record, found = last(f"""{HOLE}
[fluid]
density = 2.0
viscosity = 0.01
convection = "{mode}"
initial_velocity = [1.3, -0.7]
[[fluid.boundary]]
on = ["left", "top", "bottom"]
type = "velocity"
x = 1.3
y = -0.7
[[fluid.boundary]]
on = "right"
type = "do-nothing"
[[fluid.boundary]]
on = "hole"
{hole}
[[motion]]
on = "hole"
x = "{moved[0]}"
y = "{moved[1]}"
[mover]
type = "{mover}"
[time]
dt = 0.02
steps = 8
[quantities.push]
type = "force"
on = "hole"
component = "x"
""")
    assert record.state.mesh is not None
    assert problem.fluid is not None
    assert np.abs(record.state.mesh.mesh.points - problem.fluid.mesh.points).max() > 0.05
    assert error(record, lambda x, y: (1.3, -0.7)) < 1e-11
    assert abs(found["push"]) < 1e-11


def test_a_boundary_layer_keeps_its_first_height_round_a_hole_that_moves_and_the_flow_stays_constant() -> None:
    spokes = [("e", "a"), ("f", "b"), ("g", "c"), ("h", "d")]
    problem, record, _ = last(f"""{HOLE}
[[mesh.count]]
on = [["e", "a"]]
elements = 4
[[mesh.grading]]
on = {[list(pair) for pair in spokes]}
kind = "boundary-layer"
first_height = 0.03
[fluid]
density = 2.0
viscosity = 0.01
initial_velocity = [1.3, -0.7]
[[fluid.boundary]]
on = ["left", "top", "bottom", "hole"]
type = "velocity"
x = 1.3
y = -0.7
[[fluid.boundary]]
on = "right"
type = "do-nothing"
[[motion]]
on = "hole"
x = "0.1*sin(9*t)"
y = "0.05*sin(12*t) + 0.2*t"
[time]
dt = 0.02
steps = 8
""")
    assert record.state.mesh is not None
    assert problem.fluid is not None
    assert error(record, lambda x, y: (1.3, -0.7)) < 1e-11
    structure, points = record.state.mesh.structure, record.state.mesh.mesh.points
    assert np.abs(points - problem.fluid.mesh.points).max() > 0.05
    for wall, outside in spokes:
        edge, forward = structure.topology.edge(*map(structure.topology.vertex, (wall, outside)))
        nodes = layout(structure, 3).nodes_of_edge(edge)[:: 1 if forward else -1]
        assert np.hypot(*(points[nodes[3]] - points[nodes[0]])) == pytest.approx(0.03, rel=1e-12)


@pytest.mark.parametrize("mode", MODES)
def test_walls_do_not_follow_a_mesh_that_an_outlet_stretches(mode: str) -> None:
    # The nodes slide along the walls; Poiseuille flow must not notice.
    _, record, found = last(f"""{BOX}
[fluid]
density = 1.0
viscosity = 0.1
blocks = "one"
convection = "{mode}"
initial_velocity = ["4*y*(1 - y)", 0]
[[fluid.boundary]]
on = "left"
type = "velocity"
x = "4*y*(1 - y)"
y = 0
[[fluid.boundary]]
on = ["top", "bottom"]
type = "no-slip"
[[fluid.boundary]]
on = "right"
type = "do-nothing"
[[motion]]
on = "right"
x = "0.4*sin(3*t)"
y = 0
[nonlinear]
tolerance = 1e-12
[time]
dt = 0.05
steps = 10
[quantities.drag]
type = "force"
on = ["top", "bottom"]
component = "x"
[quantities.reach]
type = "probe"
field = "displacement"
of = "fluid"
component = "x"
at = "c"
""")
    assert error(record, lambda x, y: (4.0 * y * (1.0 - y), 0.0)) < 1e-11
    assert found["reach"] == pytest.approx(0.4 * np.sin(1.5), rel=1e-12)
    assert found["drag"] == pytest.approx(2.0 * 0.1 * 4.0 * (2.0 + found["reach"]), rel=1e-9)


@pytest.mark.parametrize("mode", MODES)
def test_a_piston_pushes_fluid_out_between_walls_that_stand(mode: str) -> None:
    # Far from the piston Poiseuille flow of the mean velocity -0.3: 1.5 times that in the middle, 0 at the walls.
    _, _, found = last(f"""{BOX.replace("elements = 2", "elements = 4")}
[fluid]
density = 1.0
viscosity = 1.0
blocks = ["one"]
convection = "{mode}"
[[fluid.boundary]]
on = ["top", "bottom", "right"]
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
end = 1.0
[quantities.middle]
type = "probe"
field = "velocity"
component = "x"
at = [0.5, 0.5]
[quantities.wall]
type = "probe"
field = "velocity"
component = "x"
at = [0.5, 1.0]
[quantities.piston]
type = "probe"
field = "velocity"
component = "x"
at = "c"
""")
    assert found["middle"] == pytest.approx(-0.45, rel=1e-3)
    assert abs(found["wall"]) < 1e-14
    assert found["piston"] == pytest.approx(-0.3, rel=1e-12)


@pytest.mark.parametrize("mode", MODES)
def test_a_stagnation_flow_follows_the_plate_that_makes_it(mode: str) -> None:
    # u = (x, -y)/2 under a plate at exp(-t/2) between slip walls, open on the right.
    _, record, _ = last(f"""{BOX}
[fluid]
density = 1.0
viscosity = 0.1
blocks = ["one"]
convection = "{mode}"
initial_velocity = ["0.5*x", "-0.5*y"]
body_force = ["0.25*x", "0.25*y"]
[[fluid.boundary]]
on = ["bottom", "top", "left"]
type = "slip"
[[fluid.boundary]]
on = "right"
type = "traction"
x = 0.1
[[motion]]
on = "top"
x = 0
y = "exp(-0.5*t) - 1"
[time]
dt = 0.02
end = 0.8
""")
    assert error(record, lambda x, y: (0.5 * x, -0.5 * y)) < 5e-5
    assert record.state.fluid is not None
    assert np.abs(record.state.fluid.pressure).max() < 5e-5


def test_steps_that_are_far_too_large_still_reach_the_steady_flow() -> None:
    # A lid that is there at once, and steps of many times the flow's own: the linear steps alone would grow.
    scene = f"""{BOX}
[fluid]
density = 1.0
viscosity = 0.01
blocks = ["one"]
[[fluid.boundary]]
on = ["bottom", "left"]
type = "no-slip"
[[fluid.boundary]]
on = "top"
type = "velocity"
x = "2*x*(2 - x)"
y = 0
[[fluid.boundary]]
on = "right"
type = "do-nothing"
[time]
dt = 20
steps = 40
"""
    problem, record, _ = last(scene)
    steady = last(scene.replace("dt = 20\nsteps = 40", "steady = true"))[1]
    assert problem.fluid is not None
    counts = problem.fluid.solver.counts
    assert 1 <= counts.iterations < 20
    assert counts.solves == 40 + counts.iterations
    assert counts.reasons["linear step"] == 40
    assert record.state.fluid is not None
    assert steady.state.fluid is not None
    assert np.abs(record.state.fluid.velocity - steady.state.fluid.velocity).max() < 1e-8


def test_motions_that_contradict_each_other_where_they_meet_are_reported() -> None:
    scene = f"""{BOX}
[fluid]
density = 1.0
viscosity = 0.1
blocks = ["one"]
[[fluid.boundary]]
on = ["bottom", "top", "right"]
type = "no-slip"
[[fluid.boundary]]
on = "left"
type = "do-nothing"
[[motion]]
on = "top"
x = "0.05*x*t"
y = "-0.1*t"
[[motion]]
on = "right"
x = "0.1*t"
y = "-0.1*y*t"
[time]
dt = 0.1
steps = 2
[quantities.corner]
type = "probe"
field = "displacement"
of = "fluid"
component = "magnitude"
at = "c"
"""
    assert last(scene)[2]["corner"] == pytest.approx(np.hypot(0.02, 0.02), rel=1e-12)
    with pytest.raises(CaseError, match=r"motion\[1\]: at \(2, 1\) and t = 0 it gives .* \(0, -0\.1\), and a motion"):
        last(scene.replace('"-0.1*y*t"', "-0.1"))


PERIODIC = """
[[fluid.boundary]]
on = "left"
type = "periodic"
with = "right"
[[fluid.boundary]]
on = ["bottom", "top"]
type = "no-slip"
"""


@pytest.mark.parametrize("mode", MODES)
def test_couette_flow_between_periodic_sides_that_their_wall_shears_is_exact(mode: str) -> None:
    _, record, found = last(f"""{BOX}
[fluid]
blocks = ["one"]
density = 2.0
viscosity = 0.3
convection = "{mode}"
initial_velocity = ["y", "0"]
{PERIODIC}
[[motion]]
on = "top"
x = "t"
y = 0
[time]
dt = 0.1
steps = 4
[quantities.drag]
type = "force"
on = "bottom"
component = "x"
""")
    assert error(record, lambda x, y: (y, 0.0 * x)) < 1e-11
    assert found["drag"] == pytest.approx(0.6, abs=1e-11)


def test_a_wall_that_waves_pumps_through_periodic_sides() -> None:
    text = f"""{BOX}
[fluid]
blocks = ["one"]
density = 1.0
viscosity = 1.0
{PERIODIC}
[[motion]]
on = "top"
x = 0
y = "0.3*sin(pi*x - 3*t)"
[mover]
type = "pseudo-solid"
[time]
dt = 0.05
steps = 20
[quantities.left]
type = "flow-rate"
on = "left"
[quantities.right]
type = "flow-rate"
on = "right"
[quantities.balance]
type = "flow-balance"
"""
    _, record, found = last(text)
    assert found["left"] == pytest.approx(-found["right"], abs=1e-13)
    assert found["right"] > 0.05  # peristalsis pumps along the wave
    assert abs(found["balance"]) < 1e-10
    fluid = record.state.fluid
    assert fluid is not None
    with pytest.raises(MeshMotionError, match=r"t = 0: the sides of fluid.boundary\[0\] .* Let both sides move alike"):
        last(text.replace("pi*x - 3*t", "x - 3*t"))
