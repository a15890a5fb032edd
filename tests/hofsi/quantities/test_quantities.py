"""Quantities of steps whose fields are known polynomials."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from hoblock.reference import gauss_lobatto, tensor_basis
from hofsi.build import Problem, build
from hofsi.case import Force, Point, PressureDifference, Probe
from hofsi.errors import CaseError
from hofsi.fem.element import boundary_first
from hofsi.io.scene import read_case
from hofsi.motion import MeshState
from hofsi.quantities import evaluators
from hofsi.records import State, StepRecord
from hofsi.simulate import simulate
from hofsi.solvers.fluid import FluidState
from hofsi.solvers.fluid_forces import BoundaryForce
from hofsi.solvers.solid import SolidState

Array = np.ndarray


def velocity(x: Array, y: Array) -> Array:
    return np.stack([1.0 + x * y - y**2, x**2 - 2.0 * y], axis=-1)


def pressure(x: Array, y: Array) -> Array:
    return 3.0 - 2.0 * x + 5.0 * y


def displacement(x: Array, y: Array) -> Array:
    return np.stack([0.02 * y**2, 0.01 * x * y], axis=-1)


@dataclass
class Steps:
    """Makes steps of a problem with known fields on a mesh that is moved as told."""

    problem: Problem

    def record(self, step: int = 1, move: Callable[[Array], Array] = lambda points: points) -> StepRecord:
        fluid, solid = self.problem.fluid, self.problem.solid
        state: dict[str, Any] = {}
        if fluid is not None:
            mesh = fluid.mesh.with_points(move(fluid.mesh.points))
            space = fluid.solver.space
            p = np.full(space.pressure_count, np.nan)
            order = mesh.order - 1
            nodes = gauss_lobatto(order)
            at = np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2)
            places = tensor_basis(gauss_lobatto(mesh.order), at) @ mesh.coordinates
            p[space.pressure_cells] = pressure(*np.moveaxis(places[:, boundary_first(order)[0]], -1, 0))
            u = velocity(*mesh.points.T)
            state["fluid"] = FluidState((u,), p, (mesh.points,), np.zeros_like(u), 0.1 * step)
            state["mesh"] = MeshState(mesh, fluid.structure.vertices, np.zeros((0, 2)), 1.0)
        if solid is not None:
            d = displacement(*solid.mesh.points.T)
            state["solid"] = SolidState((d,), (10.0 * d,), 0.1 * step)
        return StepRecord(step, 0.1 * step, 0.1, State(**state))

    def read(self, *quantities: Any) -> dict[str, Callable[[StepRecord], float]]:
        asked = replace(self.problem.case, quantities=quantities)
        return evaluators(replace(self.problem, case=asked))

    def value(self, quantity: Any, record: StepRecord) -> float:
        return self.read(quantity)[quantity.name](record)


@pytest.fixture
def coupled(flap: str) -> Steps:
    """The channel with an elastic flap at order 3."""
    data = tomllib.loads(flap)
    data["mesh"]["order"] = 3
    return Steps(build(read_case(data, "flap.toml")))


def probe(field: str, component: str | None, at: Point, of: str) -> Any:
    return Probe("q", field, component, at, of, "quantities.q")  # type: ignore[arg-type]


INSIDE = Point(0.37, 0.81)
IN_SOLID = Point(1.13, 0.22)


@pytest.mark.parametrize("component", ["x", "y", "magnitude"])
def test_velocity_of_the_fluid_is_exact_for_polynomials(coupled: Steps, component: str) -> None:
    u = velocity(np.array(INSIDE.x), np.array(INSIDE.y))
    expected = {"x": u[0], "y": u[1], "magnitude": np.hypot(*u)}[component]
    found = coupled.value(probe("velocity", component, INSIDE, "fluid"), coupled.record())
    assert found == pytest.approx(expected, abs=1e-12)


def test_pressure_is_exact_for_polynomials(coupled: Steps) -> None:
    found = coupled.value(probe("pressure", None, INSIDE, "fluid"), coupled.record())
    assert found == pytest.approx(3.0 - 2.0 * INSIDE.x + 5.0 * INSIDE.y, abs=1e-12)


def test_vorticity_is_exact_for_polynomials(coupled: Steps) -> None:
    found = coupled.value(probe("vorticity", None, INSIDE, "fluid"), coupled.record())
    assert found == pytest.approx(2.0 * INSIDE.x - INSIDE.x + 2.0 * INSIDE.y, abs=1e-12)
    away = coupled.record(1, lambda points: points + np.array([1.0, 0.0]))
    assert np.isnan(coupled.value(probe("vorticity", None, INSIDE, "fluid"), away))


def test_displacement_and_velocity_of_the_solid_are_those_of_the_material_point(coupled: Steps) -> None:
    d = displacement(np.array(IN_SOLID.x), np.array(IN_SOLID.y))
    record = coupled.record()
    assert coupled.value(probe("displacement", "x", IN_SOLID, "solid"), record) == pytest.approx(d[0], abs=1e-14)
    assert coupled.value(probe("velocity", "y", IN_SOLID, "solid"), record) == pytest.approx(10.0 * d[1], abs=1e-14)
    vertex = probe("displacement", "magnitude", Point(1.2, 0.5, "c1"), "solid")
    assert coupled.value(vertex, record) == pytest.approx(np.hypot(0.02 * 0.25, 0.01 * 0.6), abs=1e-14)


def shifted(points: Array) -> Array:
    """Inner nodes move, the outer boundary of the channel stays."""
    x, y = points.T
    bubble = np.sin(np.pi * x / 3.0) * y * (1.0 - y)
    return points + 0.3 * np.stack([bubble, 0.5 * bubble], axis=-1)


def test_a_place_in_the_fluid_stays_when_the_mesh_moves(coupled: Steps) -> None:
    read = coupled.read(probe("pressure", None, INSIDE, "fluid"))["q"]
    # A translation keeps elements straight, where a linear pressure is exact, and takes the place through several.
    values = [
        read(coupled.record(step, lambda points, step=step: points + np.array([0.02 * step, 0.0])))
        for step in range(1, 18)
    ]
    np.testing.assert_allclose(values, 3.0 - 2.0 * INSIDE.x + 5.0 * INSIDE.y, atol=1e-12)


def test_a_vertex_of_the_fluid_moves_with_the_mesh(coupled: Steps) -> None:
    at = Point(1.2, 0.5, "c1")
    record = coupled.record(1, shifted)
    x, y = shifted(np.array([[1.2, 0.5]]))[0]
    assert coupled.value(probe("velocity", "x", at, "fluid"), record) == pytest.approx(velocity(x, y)[0], abs=1e-12)
    assert coupled.value(probe("pressure", None, at, "fluid"), record) == pytest.approx(pressure(x, y), abs=1e-12)


def test_the_displacement_of_the_fluid_is_that_of_its_mesh(coupled: Steps) -> None:
    record = coupled.record(1, lambda points: points + 0.05 * points[:, ::-1])
    for at in (Point(2.1, 0.25), Point(1.2, 1.0, "c2")):
        found = coupled.value(probe("displacement", "x", at, "fluid"), record)
        assert found == pytest.approx(0.05 * at.y, abs=1e-13)


def test_a_place_that_the_fluid_has_left_has_no_value_until_it_is_back(coupled: Steps) -> None:
    read = coupled.read(probe("velocity", "x", INSIDE, "fluid"))["q"]
    away = [False, True, True, False]
    values = [read(coupled.record(k, lambda points, k=k: points + np.array([1.0 * away[k], 0.0]))) for k in range(4)]
    np.testing.assert_array_equal(np.isnan(values), away)
    assert values[3] == pytest.approx(values[0], abs=1e-12)


def test_pressure_differences_are_from_minus_to(coupled: Steps) -> None:
    quantity = PressureDifference("q", Point(0.2, 0.5), Point(2.9, 0.75, None), "quantities.q")
    expected = -2.0 * (0.2 - 2.9) + 5.0 * (0.5 - 0.75)
    assert coupled.value(quantity, coupled.record()) == pytest.approx(expected, abs=1e-12)


def test_forces_are_those_of_the_fluid_on_the_edges_times_a_factor(
    coupled: Steps, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = next(simulate(coupled.problem))
    assert coupled.problem.fluid is not None
    assert record.state.fluid is not None
    force = BoundaryForce(coupled.problem.fluid.solver, ("flap", "bottom")).evaluate(record.state.fluid)
    assert abs(force).min() > 0.0
    calls = []
    evaluate = BoundaryForce.evaluate
    monkeypatch.setattr(BoundaryForce, "evaluate", lambda self, state: calls.append(state) or evaluate(self, state))
    read = coupled.read(
        Force("drag", ("flap", "bottom"), "x", 2.0), Force("lift", ("flap", "bottom"), "y"), Force("top", ("top",), "y")
    )
    assert list(read) == ["drag", "lift", "top"]
    assert read["drag"](record) == pytest.approx(2.0 * force[0])
    assert read["lift"](record) == pytest.approx(force[1])
    assert len(calls) == 1  # drag and lift share one evaluation
    assert read["top"](record) != read["lift"](record)


def test_the_foot_of_a_coupled_solid_carries_its_weight_the_flow_and_its_inertia(flap: str) -> None:
    data = tomllib.loads(flap)
    data["mesh"]["order"] = 3
    data["time"], data["output"] = {"dt": 0.1, "steps": 3}, {}
    data["solid"][0]["gravity"] = [0.0, -1.0]
    data["quantities"] = {
        f"{name}_{component}": {"type": "force", "on": name, "component": component}
        for name in ("foot", "flap")
        for component in "xy"
    }
    problem = build(read_case(data, "flap.toml"))
    read = evaluators(problem)
    assert problem.solid is not None
    mass = problem.solid.solver.equations.mass
    momenta = [np.zeros(2)]
    for record in simulate(problem):
        assert record.state.solid is not None
        momenta.append((mass @ record.state.solid.velocity).sum(axis=0))
        first = record.step == 1
        weights = (1.0, -1.0) if first else (1.5, -2.0, 0.5)
        rate = sum(w * m for w, m in zip(weights, momenta[::-1], strict=False)) / 0.1
        foot, flow = ([read[f"{name}_{c}"](record) for c in "xy"] for name in ("foot", "flap"))
        np.testing.assert_allclose(foot, flow + np.array([0.0, -0.2 * 0.5 * 3.0]) - rate, rtol=1e-7)
        assert min(np.abs(foot)) > 0.1


@pytest.mark.parametrize(
    ("quantity", "place", "message"),
    [
        (probe("displacement", "x", INSIDE, "solid"), "quantities.q.at", "outside the solid's mesh"),
        (probe("velocity", "x", IN_SOLID, "fluid"), "quantities.q.at", "outside the fluid's mesh"),
        (
            probe("displacement", "x", Point(0.0, 0.0, "a0"), "solid"),
            "quantities.q.at",
            "vertex 'a0' does not belong to the solid; expected one of b0, b1, c0, c1",
        ),
        (PressureDifference("q", INSIDE, Point(9.0, 0.0), "quantities.q"), "quantities.q.to", "outside the fluid's"),
        (PressureDifference("q", IN_SOLID, INSIDE, "quantities.q"), "quantities.q.from", "outside the fluid's mesh"),
        (Force("q", ("shoe",), "x", place="quantities.q"), "quantities.q.on", "no edges named 'shoe' at the fluid"),
        (Force("t", ("top",), "x", place="quantities.t"), "quantities.t", "'t' is a column of every table"),
    ],
)
def test_what_cannot_be_read_is_refused_before_the_first_step(
    coupled: Steps, quantity: Any, place: str, message: str
) -> None:
    with pytest.raises(CaseError, match=message) as error:
        coupled.read(quantity)
    assert error.value.place == place


def test_a_field_that_is_not_there_is_refused(coupled: Steps) -> None:
    asked = coupled.problem.case
    without = replace(coupled.problem, case=replace(asked, quantities=(probe("velocity", "x", INSIDE, "fluid"),)))
    with pytest.raises(CaseError, match=r"of the fluid, and there is no \[fluid\]"):
        evaluators(replace(without, fluid=None))
    without = replace(without, case=replace(asked, quantities=(probe("velocity", "x", IN_SOLID, "solid"),)))
    with pytest.raises(CaseError, match=r"of a solid, and there is no \[\[solid\]\]"):
        evaluators(replace(without, solid=None))
