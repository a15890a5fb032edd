"""Numbers read off finished steps: fields at points, forces, pressure differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.errors import LocationError
from hoblock.layout import layout
from hoblock.locate import Location, find, interpolation_weights, locate, location_of_node
from hofsi import case
from hofsi.build import FluidPart, Problem, SolidPart
from hofsi.errors import CaseError
from hofsi.fem.element import boundary_first
from hofsi.records import State, StepRecord

if TYPE_CHECKING:
    from hofsi.coupling.interface import Interface
    from hofsi.motion import MeshState
    from hofsi.solvers.fluid import FluidState
    from hofsi.solvers.fluid_forces import BoundaryForce
    from hofsi.solvers.solid import SolidState

Array = NDArray[np.float64]

__all__ = ["Evaluator", "evaluators"]

Evaluator: TypeAlias = Callable[[StepRecord], float]
"""A quantity as a function of a finished step; nan where it does not exist then."""

_COLUMNS = ("step", "t")

_Vector: TypeAlias = Callable[[StepRecord], Array]


def evaluators(problem: Problem) -> dict[str, Evaluator]:
    """Functions that read the quantities of a case off a step.

    A point of a solid, and a vertex given by name, move with their body or mesh. A point (x, y) of the fluid is fixed
    in space; while the mesh does not cover it, for example because a solid is there, its value is nan. The
    displacement of the fluid is that of its mesh at the point which was at (x, y).

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    dict of str to callable
        In the order of the scene.

    Raises
    ------
    CaseError
        If a point is outside the mesh, a force is asked for where no boundary is, or a name is that of another column.
    """
    for quantity in problem.case.quantities:
        if quantity.name in _COLUMNS:
            raise CaseError(f"{quantity.name!r} is a column of every table. Choose another name", quantity.place)
    forces: dict[tuple[str, ...], _Vector] = {}
    found: dict[str, Evaluator] = {}
    for quantity in problem.case.quantities:
        match quantity:
            case case.Probe():
                found[quantity.name] = _probe(problem, quantity)
            case case.Force():
                if quantity.on not in forces:
                    forces[quantity.on] = _force(problem, quantity)
                found[quantity.name] = _scaled(_component(forces[quantity.on], quantity.component), quantity.factor)
            case case.PressureDifference():
                found[quantity.name] = _difference(problem, quantity)
    return found


def _probe(problem: Problem, probe: case.Probe) -> Evaluator:
    place = f"{probe.place}.at"
    if probe.of == "solid":
        solid = _solid_of(problem, probe.place)
        return _component(_solid_vector(solid, probe, place), probe.component or "magnitude")
    fluid = _fluid_of(problem, probe.place)
    if probe.field == "pressure":
        return _pressure(fluid, probe.at, place)
    if probe.field == "displacement":
        return _component(_mesh_displacement(fluid, probe.at, place), probe.component or "magnitude")
    return _component(_velocity(fluid, probe.at, place), probe.component or "magnitude")


def _component(vector: _Vector, component: str) -> Evaluator:
    if component == "magnitude":
        return lambda record: float(np.hypot(*vector(record)))
    axis = "xy".index(component)
    return lambda record: float(vector(record)[axis])


def _scaled(evaluate: Evaluator, factor: float) -> Evaluator:
    return lambda record: factor * evaluate(record)


def _difference(problem: Problem, difference: case.PressureDifference) -> Evaluator:
    fluid = _fluid_of(problem, difference.place)
    start = _pressure(fluid, difference.start, f"{difference.place}.from")
    end = _pressure(fluid, difference.end, f"{difference.place}.to")
    return lambda record: start(record) - end(record)


def _force(problem: Problem, force: case.Force) -> _Vector:
    """Force on edges; kept for the last state, because drag and lift ask for the same one."""
    fluid, solid = problem.fluid, problem.solid
    if solid is not None and (fluid is None or _is_dry(fluid, solid, force)):
        return _kept(_solid_force(problem, solid, force))
    boundary = _boundary_force(_fluid_of(problem, force.place), force)
    return _kept(lambda record: boundary.evaluate(_fluid_state(record)))


def _kept(evaluate: _Vector) -> _Vector:
    last: tuple[State, Array] | None = None

    def force(record: StepRecord) -> Array:
        nonlocal last
        if last is None or last[0] is not record.state:
            last = (record.state, evaluate(record))
        return last[1]

    return force


def _is_dry(fluid: FluidPart, solid: SolidPart, force: case.Force) -> bool:
    """Whether the edges of a force are at solids and not at the fluid."""
    wet, dry = (any(len(part.mesh.edge_groups.get(name, ())) for name in force.on) for part in (fluid, solid))
    return dry and not wet


def _boundary_force(fluid: FluidPart, force: case.Force) -> BoundaryForce:
    from hofsi.solvers.fluid_forces import BoundaryForce

    try:
        return BoundaryForce(fluid.solver, force.on)
    except CaseError as error:
        raise CaseError(error.problem, f"{force.place}.on") from error


def _solid_force(problem: Problem, solid: SolidPart, force: case.Force) -> _Vector:
    """Force of a solid on its surroundings at dry edges."""
    from hofsi.solvers.solid_forces import SolidForce

    try:
        boundary = SolidForce(solid.solver, force.on)
    except CaseError as error:
        raise CaseError(error.problem, f"{force.place}.on") from error
    if problem.fluid is None or problem.interface is None:
        return lambda record: boundary.evaluate(_solid_state(record))
    correction = _load_of_walls(problem.fluid, solid, problem.interface)

    def evaluate(record: StepRecord) -> Array:
        state = _solid_state(record)
        assert state.reaction is not None
        return boundary.evaluate(replace(state, reaction=state.reaction - correction(record)))

    return evaluate


def _load_of_walls(fluid: FluidPart, solid: SolidPart, interface: Interface) -> _Vector:
    """Part of the nodal load (n, 2) that acts on walls of the fluid, at interface nodes where the solid is fixed.

    It does not move the solid, so the coupling leaves it in the load; the reaction must not contain it.
    """
    from hofsi.coupling.load import InterfaceLoad

    fixed = solid.solver.supports.constraints.fixed[interface.solid]
    load = InterfaceLoad(fluid.solver, interface, ~(fixed[:, 0] & fixed[:, 1]))

    def evaluate(record: StepRecord) -> Array:
        state = _fluid_state(record)
        walls = np.zeros(solid.mesh.points.shape)
        walls[interface.solid] = load.evaluate(state) + state.reaction[interface.fluid]
        return walls

    return evaluate


def _solid_vector(solid: SolidPart, probe: case.Probe, place: str) -> _Vector:
    """Displacement or velocity of a material point."""
    location = _attached(solid, probe.at, place)
    nodes = solid.mesh.cells[location.element]
    weights = interpolation_weights(location, solid.mesh.order)
    if probe.field == "displacement":
        return lambda record: weights @ _solid_state(record).displacement[nodes]
    return lambda record: weights @ _solid_state(record).velocity[nodes]


def _mesh_displacement(fluid: FluidPart, at: case.Point, place: str) -> _Vector:
    location = _attached(fluid, at, place)
    nodes = fluid.mesh.cells[location.element]
    weights = interpolation_weights(location, fluid.mesh.order)
    reference = weights @ fluid.mesh.points[nodes]
    return lambda record: weights @ _mesh_state(record).mesh.points[nodes] - reference


def _velocity(fluid: FluidPart, at: case.Point, place: str) -> _Vector:
    where = _tracked(fluid, at, place)

    def evaluate(record: StepRecord) -> Array:
        location = where(record)
        if location is None:
            return np.full(2, np.nan)
        nodes = fluid.mesh.cells[location.element]
        return np.asarray(interpolation_weights(location, fluid.mesh.order) @ _fluid_state(record).velocity[nodes])

    return evaluate


def _pressure(fluid: FluidPart, at: case.Point, place: str) -> Evaluator:
    where = _tracked(fluid, at, place)
    order = fluid.mesh.order - 1
    permutation = boundary_first(order)[0]

    def evaluate(record: StepRecord) -> float:
        location = where(record)
        if location is None:
            return float("nan")
        weights = interpolation_weights(location, order)[permutation]
        return float(weights @ _fluid_state(record).pressure[fluid.solver.space.pressure_cells[location.element]])

    return evaluate


def _tracked(fluid: FluidPart, at: case.Point, place: str) -> Callable[[StepRecord], Location | None]:
    """Location of a fluid point at a step: that of a vertex stays, that of a place in space is followed."""
    start = _attached(fluid, at, place)
    if at.vertex is not None:
        return lambda record: start
    tracker = _Tracker(fluid.mesh, at, start)
    return lambda record: tracker.find(_mesh_state(record).mesh)


class _Tracker:
    """Finds a place again after the mesh has moved, beginning where it was found last."""

    def __init__(self, mesh: QuadMesh, at: case.Point, start: Location) -> None:
        self._target = (at.x, at.y)
        self._points = mesh.points
        self._found: Location | None = start
        self._last = start

    def find(self, mesh: QuadMesh) -> Location | None:
        if mesh.points is not self._points:
            self._points = mesh.points
            self._found = find(mesh, self._target, self._last)
            self._last = self._found or self._last
        return self._found


def _attached(part: FluidPart | SolidPart, at: case.Point, place: str) -> Location:
    """Location of a point in the reference mesh."""
    body, mesh = "fluid" if isinstance(part, FluidPart) else "solid", part.mesh
    if at.vertex is None:
        try:
            return locate(mesh, (at.x, at.y), of=f"the {body}'s mesh")
        except LocationError as error:
            raise CaseError(str(error).removesuffix("."), place) from error
    names = part.structure.topology.vertex_names
    if at.vertex not in names:
        some = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
        raise CaseError(
            f"vertex {at.vertex!r} does not belong to the {body}; expected one of {some}. Name another vertex, or "
            "change 'of'",
            place,
        )
    return location_of_node(mesh, int(layout(part.structure, mesh.order).vertex_nodes[names.index(at.vertex)]))


def _fluid_of(problem: Problem, place: str) -> FluidPart:
    if problem.fluid is None:
        raise CaseError("it is of the fluid, and there is no [fluid]. Remove the quantity", place)
    return problem.fluid


def _solid_of(problem: Problem, place: str) -> SolidPart:
    if problem.solid is None:
        raise CaseError("it is of a solid, and there is no [[solid]]. Remove the quantity", place)
    return problem.solid


def _fluid_state(record: StepRecord) -> FluidState:
    assert record.state.fluid is not None
    return record.state.fluid


def _solid_state(record: StepRecord) -> SolidState:
    assert record.state.solid is not None
    return record.state.solid


def _mesh_state(record: StepRecord) -> MeshState:
    assert record.state.mesh is not None
    return record.state.mesh
