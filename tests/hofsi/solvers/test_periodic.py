"""Flows between periodic sides."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from hoblock import BlockStructure, generate
from hofsi import case
from hofsi.errors import CaseError, MeshMotionError
from hofsi.solvers import fluid_integrals
from hofsi.solvers.fluid_flow import BoundaryFlow
from hofsi.solvers.fluid_forces import BoundaryForce
from hofsi.solvers.fluid_vorticity import FluidVorticity
from hofsi.solvers.lower_order import start_of_lower_order

K = 2.0 * np.pi
WALLS = case.NoSlip(("bottom", "top"))
COLUMNS = np.array([0.0, 0.2, 0.5, 0.65, 1.0])


def periodic(first="left", second="right"):
    return case.Periodic.between((first,), (second,), "fluid.boundary[0]")


BOTH = (periodic(), periodic("bottom", "top"))


def strip(columns, rows=(0.0, 0.4, 1.0), *, order=3, wave=0.05, west=None):
    """One block an element, under a map with the period 1: wavy sides and walls; ``west`` is one part of the bottom."""
    vertices = np.array([(x, y) for x in columns for y in rows])
    n = len(rows)
    quads = [
        (k * n + j, (k + 1) * n + j, (k + 1) * n + j + 1, k * n + j + 1)
        for k in range(len(columns) - 1)
        for j in range(n - 1)
    ]
    last = (len(columns) - 1) * n
    lines = {
        "left": range(n),
        "right": range(last, last + n),
        "bottom": range(0, last + 1, n),
        "top": range(n - 1, last + n, n),
    }
    edges = {name: list(pairwise(line)) for name, line in lines.items()}
    if west is not None:
        edges |= {"west": [edges["bottom"][west]], "east": edges["bottom"][:west] + edges["bottom"][west + 1 :]}
    mesh = generate(BlockStructure.build(vertices, {"fluid": quads}, edges=edges), order)
    x, y = mesh.points.T
    shift = np.stack([np.sin(K * y), np.sin(K * x + 0.7)], axis=-1)
    return mesh.with_points(mesh.points + wave * shift)


def on_the_torus(mesh, values, lengths):
    """Values by the places of their nodes, modulo some lengths; each place once."""
    found = {}
    for point, value in zip(mesh.points, values, strict=True):
        place = tuple(
            round(float(np.mod(x + 1e-9, length)), 6) if length else round(float(x), 6)
            for x, length in zip(point, lengths, strict=True)
        )
        np.testing.assert_allclose(value, found.setdefault(place, value), atol=1e-13)
    return found


def expect_same(first, second, atol=1e-11):
    assert first.keys() == second.keys()
    for place, value in first.items():
        np.testing.assert_allclose(value, second[place], rtol=0.0, atol=atol)


def taylor_green(flows, order, count, *, viscosity=1.0, steps=10):
    """Errors of velocity and pressure after a tenth of the time in which the flow decays, and the mean pressure."""
    mesh = flows.rectangle(order, count, count)
    rate, x, y = 2.0 * K**2 * viscosity, f"{K}*(x - 0.1)", f"{K}*(y - 0.1)"
    u, v = f"sin({x})*cos({y})*exp(-{rate}*t)", f"-cos({x})*sin({y})*exp(-{rate}*t)"
    solver = flows.solver(mesh, BOTH, viscosity=viscosity)
    dt = 0.1 / rate / steps
    start = tuple(flows.field(mesh.points, u, v, t) for t in (0.0, -dt))
    state = replace(solver.initial_state(), velocities=start, points=(mesh.points,) * 2)
    state = flows.march(solver, state, [dt] * steps, linear=True, steps=[dt])
    p = f"(cos(2*{x}) + cos(2*{y}))/4*exp(-2*{rate}*t)"
    weights = solver.geometry(mesh.points).weights
    mean = float(np.sum(weights * (state.pressure[solver.space.pressure_cells] @ solver.space.pressure.N.T)))
    errors = flows.velocity_norm_of_error(solver, state, u, v), flows.pressure_norm_of_error(solver, state, p)
    return errors, mean, fluid_integrals.continuity_residual(solver, state)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_the_decay_of_vortices_converges_at_the_order_of_the_velocity(flows, order):
    (coarse, _), (fine, finer_pressure) = (taylor_green(flows, order, count)[0] for count in (2, 4))
    assert coarse / fine > 2.0 ** (order + 0.7)
    assert finer_pressure < {2: 0.3, 3: 0.02, 4: 0.01}[order]


def test_the_pressure_of_vortices_has_the_mean_zero_and_continuity_holds(flows):
    _, mean, residual = taylor_green(flows, 3, 3)
    assert abs(mean) < 1e-14
    assert residual < 1e-15


@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
@pytest.mark.parametrize("columns", [1, 2, 3])
@pytest.mark.parametrize("names", [("left", "right"), ("right", "left")])
def test_poiseuille_flow_driven_by_a_body_force_is_exact(flows, model, columns, names):
    mesh = flows.rectangle(2, columns, 2, high=(0.7, 1.0))
    solver = flows.solver(mesh, [periodic(*names), WALLS], viscosity=0.1, body_force=("0.2", "0"), model=model)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, flows.field(mesh.points, "y*(1 - y)", "0"), rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(state.pressure, 0.0, rtol=0.0, atol=1e-11)
    assert fluid_integrals.continuity_residual(solver, state) < 1e-14
    assert BoundaryFlow(solver, ["right"]).rate(state) == pytest.approx(1.0 / 6.0, abs=1e-12)
    assert BoundaryFlow(solver).rate(state) == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("columns", [1, 2])
@pytest.mark.parametrize("top", [case.NoSlip(("top",)), case.Slip(("top",))])
@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_poiseuille_flow_in_any_direction(flows, turn, top, columns):
    c, s = np.cos(turn), np.sin(turn)
    mesh = flows.grid(3, columns, 2, jitter=0.0, turn=turn)
    force = f"{c}", f"{s}"
    solver = flows.solver(mesh, [periodic(), case.NoSlip(("bottom",)), top], viscosity=0.5, body_force=force)
    eta = f"(y*{c} - x*{s})"
    speed = f"{eta}*({2 if isinstance(top, case.Slip) else 1} - {eta})"
    exact = flows.field(mesh.points, f"{c}*{speed}", f"{s}*{speed}")
    np.testing.assert_allclose(flows.steady(solver).velocity, exact, rtol=0.0, atol=1e-11)


def test_couette_flow_between_wavy_sides_is_exact(flows):
    mesh = strip(COLUMNS)
    walls = flows.velocity(("bottom", "top"), "y", 0)
    solver = flows.solver(mesh, [periodic(), walls], viscosity=0.1)
    state = flows.steady(solver)
    np.testing.assert_allclose(state.velocity, flows.field(mesh.points, "y", "0"), rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(state.pressure, 0.0, rtol=0.0, atol=1e-11)


def test_a_uniform_flow_stays(flows):
    mesh = strip(COLUMNS, order=2)
    solver = flows.solver(mesh, BOTH, viscosity=0.01, initial_velocity=("2", "-1"))
    state = flows.march(solver, solver.initial_state(), [0.1, 0.1])
    np.testing.assert_allclose(state.velocity, [[2.0, -1.0]] * len(mesh.points), rtol=0.0, atol=1e-12)


def test_a_force_accelerates_what_nothing_holds(flows):
    mesh = strip(COLUMNS, order=2)
    solver = flows.solver(mesh, BOTH, density=2.0, body_force=("1", "0.5"))
    state = flows.march(solver, solver.initial_state(), [0.1, 0.1, 0.1])
    np.testing.assert_allclose(state.velocity, [[0.15, 0.075]] * len(mesh.points), rtol=0.0, atol=1e-12)


CELLS = {
    "walls": ([WALLS], (1.0, None)),
    "slip": ([case.NoSlip(("bottom",)), case.Slip(("top",))], (1.0, None)),
    "open": ([case.NoSlip(("bottom",)), case.DoNothing(("top",), backflow=1.0)], (1.0, None)),
    "torus": ([periodic("bottom", "top")], (1.0, 1.0)),
}


def stirred(flows, mesh, conditions, *, position=None, names=("left", "right")):
    """A flow that depends on both coordinates, after some steps."""
    force = f"1 + sin({K}*x)*cos({K}*y)", f"cos({K}*x + 1)"
    start = f"sin({K}*y)", f"0.5*sin({K}*x)"
    solver = flows.solver(
        mesh, [periodic(*names), *conditions], viscosity=0.05, body_force=force, initial_velocity=start
    )
    return solver, flows.march(solver, solver.initial_state(), [0.05] * 3, position, linear=True)


@pytest.mark.parametrize("kind", CELLS)
def test_it_does_not_matter_where_the_period_is_cut(flows, kind):
    conditions, lengths = CELLS[kind]
    meshes = strip(COLUMNS), strip([*COLUMNS[2:], *(COLUMNS[1:3] + 1.0)])
    found = []
    for mesh in meshes:
        solver, state = stirred(flows, mesh, conditions)
        assert fluid_integrals.continuity_residual(solver, state) < 1e-13
        vorticity = FluidVorticity(mesh, solver.space.same[0]).at_nodes(mesh.points, state.velocity)
        found.append([on_the_torus(mesh, values, lengths) for values in (state.velocity, vorticity)])
    for first, second in zip(*found, strict=True):
        expect_same(first, second, 1e-9)


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("kind", ["slip", "velocity", "no-slip"])
def test_a_wall_may_end_at_the_cut(flows, kind, moving):
    east = {
        "slip": case.Slip(("east",)),
        "velocity": flows.velocity("east", "0.1", f"0.1*sin({K}*x)"),
        "no-slip": case.NoSlip(("east",)),
    }[kind]
    west = flows.velocity("west", "-0.1", 0) if kind == "no-slip" else case.NoSlip(("west",))
    found = []
    for mesh in (strip(COLUMNS, west=0), strip([*COLUMNS[2:], *(COLUMNS[1:3] + 1.0)], west=2)):
        wave = 0.05 * np.sin(K * mesh.points[:, ::-1])
        shift = (lambda t, X=mesh.points, wave=wave: X + np.sin(9.0 * t) * wave) if moving else None
        _, state = stirred(flows, mesh, [east, west, case.DoNothing(("top",))], position=shift)
        found.append(on_the_torus(mesh, state.velocity, (1.0, None)))
    expect_same(*found, atol=1e-9)


@pytest.mark.parametrize("kind", CELLS)
def test_sides_may_change_their_roles(flows, kind):
    mesh = strip(COLUMNS)
    states = [stirred(flows, mesh, CELLS[kind][0], names=names)[1] for names in (("left", "right"), ("right", "left"))]
    np.testing.assert_array_equal(states[0].velocity, states[1].velocity)
    np.testing.assert_array_equal(states[0].pressure, states[1].pressure)


@pytest.mark.parametrize("kind", CELLS)
def test_one_element_in_a_period_is_as_good_as_two_in_two(flows, kind):
    conditions, lengths = CELLS[kind]
    found = []
    for columns in (COLUMNS[[0, -1]], COLUMNS[[0, -1, -1]] + [0.0, 0.0, 1.0]):
        mesh = strip(columns)
        found.append(on_the_torus(mesh, stirred(flows, mesh, conditions)[1].velocity, lengths))
    expect_same(*found)


def test_pressure_and_velocity_agree_on_both_sides(flows):
    mesh = strip(COLUMNS, order=4)
    solver, state = stirred(flows, mesh, CELLS["torus"][0])
    for sides in solver.periodic:
        np.testing.assert_array_equal(*(state.velocity[sides.nodes[:, k]] for k in range(2)))
    np.testing.assert_array_equal(state.pressure, state.pressure[solver.space.same[1]])


def test_an_initial_velocity_without_the_period_is_made_one(flows):
    mesh = flows.rectangle(2, 2, 2)
    solver = flows.solver(mesh, [periodic(), WALLS], initial_velocity=("x", "0"))
    state = solver.initial_state()
    nodes = solver.periodic[0].nodes
    np.testing.assert_array_equal(state.velocity[nodes[:, 0]], state.velocity[nodes[:, 1]])


def test_a_box_of_periodic_sides_is_enclosed(flows):
    mesh = strip(COLUMNS)

    def enclosed(*conditions):
        return len(flows.solver(mesh, [periodic(), *conditions]).enclosed(mesh.points))

    assert enclosed(WALLS) == 1
    assert enclosed(periodic("bottom", "top")) == 1
    assert enclosed(case.Slip(("bottom", "top"))) == 1
    assert enclosed(case.NoSlip(("bottom",)), case.DoNothing(("top",))) == 0


def test_periodic_sides_connect_regions(flows):
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    vertices = np.concatenate([corners, corners + np.array([3.0, 0.0])])
    sides = {"bottom": (0, 1), "right": (1, 2), "top": (2, 3), "left": (3, 0)}
    edges = {f"{name}{k}": [(4 * k + a, 4 * k + b)] for k in range(2) for name, (a, b) in sides.items()}
    structure = BlockStructure.build(vertices, {"fluid": [(0, 1, 2, 3), (4, 5, 6, 7)]}, edges=edges, counts=2)
    mesh = generate(structure, 2)
    tied = [periodic("right0", "left1"), periodic("left0", "right1")]
    walls = case.NoSlip(("bottom0", "top0", "bottom1", "top1"))
    solver = flows.solver(mesh, [*tied, walls], viscosity=0.5, body_force=("1", "0"))
    assert len(solver.enclosed(mesh.points)) == 1
    exact = flows.field(mesh.points, "y*(1 - y)", "0")
    np.testing.assert_allclose(flows.steady(solver).velocity, exact, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("turn", [0.0, 0.6])
@pytest.mark.parametrize("model", ["navier-stokes", "stokes"])
def test_a_steady_flow_that_nothing_holds_is_refused(flows, turn, model):
    mesh = flows.grid(2, jitter=0.0, turn=turn)
    across = r"\(0\.8253, 0\.5646\)" if turn else r"\(1, 0\)"
    for conditions, direction in ((BOTH, ""), ([periodic(), case.Slip(("bottom", "top"))], across)):
        solver = flows.solver(mesh, conditions, model=model)
        with pytest.raises(CaseError, match=f"nothing holds a uniform velocity along {direction}"):
            flows.steady(solver)


def test_slip_along_wavy_walls_holds_a_steady_flow(flows):
    conditions = [periodic(), case.Slip(("bottom", "top"))]
    solver = flows.solver(strip(COLUMNS), conditions, body_force=("1", "0"), model="stokes")
    state = flows.steady(solver)
    assert fluid_integrals.continuity_residual(solver, state) < 1e-13
    force = BoundaryForce(solver, ["bottom", "top"]).evaluate(state)
    np.testing.assert_allclose(force, [fluid_integrals.area(solver, state), 0.0], atol=1e-11)


@pytest.mark.parametrize("top", [case.NoSlip(("top",)), case.Slip(("top",))])
def test_walls_hold_what_a_body_force_drives(flows, top):
    # Without convection, whose advective form conserves momentum only as far as ∇·u = 0 holds pointwise.
    conditions = [periodic(), case.NoSlip(("bottom",)), top]
    solver = flows.solver(strip(COLUMNS, west=0), conditions, body_force=("1", "0.5"), model="stokes")
    state = flows.steady(solver)
    area = fluid_integrals.area(solver, state)
    force = BoundaryForce(solver, ["bottom", "top"]).evaluate(state)
    np.testing.assert_allclose(force, [area, 0.5 * area], rtol=0.0, atol=1e-11)
    # Parts of a wall that end at the sides: integrated tractions tell them apart, up to the error of these.
    whole, *halves = (BoundaryForce(solver, [name]).evaluate(state) for name in ("bottom", "west", "east"))
    np.testing.assert_allclose(sum(halves), whole, atol=0.01 * area)


def test_forces_moments_and_parts_of_walls_are_exact_in_poiseuille_flow(flows):
    mesh = strip([0.0, 0.5, 2.0], wave=0.0, west=0)
    solver = flows.solver(mesh, [periodic(), WALLS], viscosity=0.5, body_force=("1", "-3"))
    state = flows.steady(solver)
    # p = 1.5 - 3 y, shear stress 0.5 on both walls; σ·n on the bottom (0.5, -1.5) per unit length.
    for name, left, right in (("bottom", 0.0, 2.0), ("west", 0.0, 0.5), ("east", 0.5, 2.0)):
        force = BoundaryForce(solver, [name])
        length = right - left
        np.testing.assert_allclose(force.evaluate(state), [0.5 * length, -1.5 * length], rtol=0.0, atol=1e-11)
        moment = -1.5 * (right**2 - left**2) / 2.0 + 0.5 * length
        assert force.moment(state, np.array([0.0, 1.0])) == pytest.approx(moment, abs=1e-11)
    # The fluid beyond the right side carries the pressure, whose mean is zero, and the shear ∫ μ ∂u/∂y dy = 0.
    np.testing.assert_allclose(BoundaryForce(solver, ["right"]).evaluate(state), [0.0, 0.0], atol=1e-11)


def test_a_lower_order_is_periodic_too(flows):
    mesh = strip([0.0, 0.6, 1.0], order=6)
    solver = flows.solver(mesh, [periodic(), WALLS], viscosity=0.02, body_force=("0.3", "0"), tolerance=1e-11)
    start = start_of_lower_order(solver, solver.initial_state())
    assert start.velocity.any()
    assert solver.counts.iterations_below
    step = solver.begin_steady(start, mesh.points)
    from_below, _ = step.solve(np.zeros((0, 2)))
    np.testing.assert_allclose(from_below, flows.steady(solver).velocity, rtol=0.0, atol=1e-8)
    assert np.abs(start.velocity - from_below).max() < 0.05 * np.abs(from_below).max()


def test_couette_flow_on_a_mesh_that_its_wall_shears(flows):
    mesh = strip(COLUMNS, wave=0.0)
    x, y = mesh.points.T

    def position(time):
        return mesh.points + np.stack([time * y, 0.05 * np.sin(K * x) * y * (1.0 - y) * np.sin(9.0 * time)], axis=-1)

    conditions = [periodic(), WALLS]
    solver = flows.solver(mesh, conditions, viscosity=0.1, initial_velocity=("y", "0"))
    start = solver.initial_state()
    state = flows.march(solver, start, [0.1, 0.1, 0.2], position)
    np.testing.assert_allclose(state.velocity, flows.field(state.points[0], "y", "0"), rtol=0.0, atol=1e-11)


def test_the_mesh_may_slide_along_a_wall_that_stands(flows):
    mesh = strip(COLUMNS, wave=0.0)
    y = mesh.points[:, 1]

    def position(time):
        return mesh.points + np.stack([time * (0.4 + 0.6 * y), 0.0 * y], axis=-1)

    driven = mesh.edge_nodes("top")
    solver = flows.solver(mesh, [periodic(), WALLS], viscosity=0.1, initial_velocity=("y", "0"), driven=driven)
    state = flows.march(solver, solver.initial_state(), [0.1, 0.1], position, linear=True)
    np.testing.assert_allclose(state.velocity, flows.field(state.points[0], "y", "0"), rtol=0.0, atol=1e-11)


def test_walls_must_balance_whatever_passes_through_the_sides(flows):
    mesh = flows.rectangle(2, 2, 2)
    walls = [flows.velocity("bottom", 0, 0.01), case.NoSlip(("top",))]
    solver = flows.solver(mesh, [periodic(), *walls], initial_velocity=("10", "0"))
    with pytest.raises(CaseError, match=r"bring in 0\.01 per unit time more than they let out \(∮ \|u\| = 0\.01\)"):
        flows.march(solver, solver.initial_state(), [0.1])


def test_sides_that_do_not_move_alike_end_the_step(flows):
    mesh = strip(COLUMNS, wave=0.0)
    solver = flows.solver(mesh, [periodic(), WALLS])
    wrong = mesh.points * [1.1, 1.0]
    with pytest.raises(
        MeshMotionError, match=r"t = 0.1: the sides of fluid.boundary\[0\] \('left' and 'right'\) are no"
    ):
        flows.march(solver, solver.initial_state(), [0.1], lambda time: wrong)
    with pytest.raises(MeshMotionError, match="no translation by"):
        solver.begin_steady(solver.initial_state(), wrong)
