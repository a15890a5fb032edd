"""What a case needs and what it does not: counts and choices, found without running anything."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.building import build_structure
from hoblock.errors import HoblockError
from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.motion import driven_edges
from hoblock.numbering import number_nodes
from hoblock.quality import scaled_jacobian
from hofsi.case import (
    AngleOptimisationSettings,
    BarrierSettings,
    Case,
    Fluid,
    PseudoSolidSettings,
    RuleSettings,
    Solid,
    Steady,
    Unsteady,
)
from hofsi.case_checks import check_case
from hofsi.errors import CaseError
from hofsi.linear.choice import choose_solver
from hofsi.movers import placed_vertices

Index = NDArray[np.int64]

__all__ = ["Item", "Plan", "plan"]

_LAWS = {"linear": "linear elasticity", "st-venant-kirchhoff": "St. Venant–Kirchhoff"}
_MODELS = {"navier-stokes": "Navier–Stokes", "stokes": "Stokes"}
_MOVERS = {
    BarrierSettings: "barrier energy",
    PseudoSolidSettings: "pseudo-solid",
    AngleOptimisationSettings: "angle optimisation",
    RuleSettings: "rule",
}
_ACCELERATIONS = {"iqn-ils": "IQN-ILS", "aitken": "Aitken's relaxation", "constant": "constant relaxation"}


@dataclass(frozen=True)
class Item:
    """One line of a plan.

    Attributes
    ----------
    name : str
    detail : str
        How much of it there will be; of something that is skipped, the reason.
    """

    name: str
    detail: str


@dataclass(frozen=True)
class Plan:
    """What a run of a case builds and does, and what it leaves out.

    Attributes
    ----------
    built, skipped : tuple of Item
    """

    built: tuple[Item, ...]
    skipped: tuple[Item, ...]

    def lines(self) -> tuple[str, ...]:
        """The plan as text, names in one column."""
        width = max((len(item.name) for item in (*self.built, *self.skipped)), default=0)
        parts = (("built", self.built), ("skipped", self.skipped))
        return tuple(
            line
            for title, items in parts
            if items
            for line in (f"{title}:", *(f"  {item.name:<{width}}  {item.detail}" for item in items))
        )


@dataclass(frozen=True, eq=False)
class _Meshes:
    """The parts of the mesh, as a run makes them."""

    fluid: tuple[BlockStructure, QuadMesh] | None
    solid: tuple[BlockStructure, QuadMesh] | None
    wet: tuple[int, int]
    driven: Index


def plan(case: Case) -> Plan:
    """Check a case completely, its mesh included, and say what a run of it needs.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Plan

    Raises
    ------
    HoblockError
        If there is no such block structure.
    CaseError
        If an element would be invalid, or the case cannot be simulated.
    """
    check_case(case)
    meshes = _meshes(case)
    built = [*_fluid(case, meshes), *_solid(case, meshes), *_coupling(case, meshes), *_time(case), *_output(case)]
    skipped = [
        *_without_material(case),
        *_without_bodies(case),
        *_without_motion(case),
        *_without_iteration(case, meshes),
        *_without_output(case),
        *_unused_tables(case),
    ]
    return Plan(tuple(built), tuple(skipped))


def _without_material(case: Case) -> list[Item]:
    """Block groups that belong to nothing."""
    used = {group for solid in case.solids for group in solid.blocks} | set(case.fluid.blocks if case.fluid else ())
    return [Item(f"blocks {group!r}", "no material uses them") for group in case.mesh.blocks if group not in used]


def _coupled(case: Case) -> bool:
    return case.fluid is not None and bool(case.solids)


def _moves(case: Case) -> bool:
    """Whether the fluid's mesh moves."""
    return case.fluid is not None and bool(case.solids or case.motions)


def _iterates(case: Case, fluid: Fluid) -> bool:
    """Whether the fluid's equations are nonlinear."""
    if fluid.model == "stokes":
        return False
    return isinstance(case.time, Steady) or not fluid.is_linear(case.coupling if case.solids else None)


def _meshes(case: Case) -> _Meshes:
    structure = build_structure(case.mesh)
    groups = [name for solid in case.solids for name in solid.blocks]
    solid = _part(structure, groups, case.mesh.order) if groups else None
    if case.fluid is None:
        return _Meshes(None, solid, (0, 0), np.zeros(0, dtype=np.int64))
    fluid = _part(structure, case.fluid.blocks, case.mesh.order)
    wet = structure.shared_edges(case.fluid.blocks, groups) if groups else np.zeros(0, dtype=np.int64)
    ends = structure.topology.edges
    nodes = len(np.unique(ends[wet])) + int((structure.topology.counts[wet] * case.mesh.order - 1).sum())
    names = structure.topology.vertex_names
    topology = fluid[0].topology
    coupled = [topology.edge(*(topology.vertex(names[v]) for v in ends[edge]))[0] for edge in wet]
    named = topology.edge_groups
    moving = [int(edge) for motion in case.motions for name in motion.on for edge in named[name]]
    return _Meshes(fluid, solid, (len(wet), nodes), np.unique(np.array([*coupled, *moving], dtype=np.int64)))


def _part(structure: BlockStructure, groups: Sequence[str], order: int) -> tuple[BlockStructure, QuadMesh]:
    part = structure.restricted(groups)
    try:
        return part, generate(part, order)
    except HoblockError as error:
        raise CaseError(str(error), "mesh") from error


def _number(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _mesh(structure: BlockStructure, mesh: QuadMesh) -> str:
    worst = float(scaled_jacobian(mesh).min())
    return (
        f"{_number(len(structure.topology.quads), 'block')}, {_number(len(mesh.cells), 'element')} of order "
        f"{mesh.order}, {len(mesh.points)} nodes, worst scaled Jacobian {worst:.2f}"
    )


def _inner(mesh: QuadMesh, order: int) -> int:
    """Nodes of an order inside elements, which static condensation eliminates."""
    return len(mesh.cells) * (order - 1) ** 2


def _kept_of_fluid(mesh: QuadMesh, pressures: int) -> int:
    """Unknowns of the fluid after static condensation, given ones included."""
    return 2 * len(mesh.points) + pressures - 2 * _inner(mesh, mesh.order) - _inner(mesh, mesh.order - 1)


def _kept_of_solid(mesh: QuadMesh) -> int:
    return 2 * len(mesh.points) - 2 * _inner(mesh, mesh.order)


def _linear_solvers(case: Case, meshes: _Meshes) -> dict[str, str]:
    """The linear solver of each field."""
    kept = {}
    if meshes.fluid is not None:
        mesh = meshes.fluid[1]
        kept["fluid"] = _kept_of_fluid(mesh, number_nodes(mesh.corners, mesh.order - 1)[1])
    if meshes.solid is not None:
        kept["solid"] = _kept_of_solid(meshes.solid[1])
    return {field: choose_solver(case.linear.solver, count).solver for field, count in kept.items()}


def _fluid(case: Case, meshes: _Meshes) -> Iterator[Item]:
    if case.fluid is None or meshes.fluid is None:
        return
    structure, mesh = meshes.fluid
    velocities = 2 * len(mesh.points)
    pressures = number_nodes(mesh.corners, mesh.order - 1)[1]
    kept = _kept_of_fluid(mesh, pressures)
    yield Item("fluid mesh", _mesh(structure, mesh))
    yield Item(
        "fluid",
        f"{_MODELS[case.fluid.model]}, ρ = {case.fluid.density:g}, μ = {case.fluid.viscosity:g}; "
        f"{velocities} unknowns of velocity and {pressures} of pressure, given ones included",
    )
    if _iterates(case, case.fluid):
        method = "Picard's" if case.fluid.convection == "picard" else "Newton's"
        yield Item("convection", f"{method} iteration to a relative residual of {case.nonlinear.tolerance:g}")
    elif case.fluid.model == "navier-stokes":
        convects = case.fluid.merely_convects(case.coupling if case.solids else None)
        how = "convection with" if convects else "Newton's linearisation about"
        yield Item("convection", f"{how} the velocity extrapolated to second order: linear steps")
    solver = {
        "direct": f"sparse LU of {kept} unknowns after static condensation",
        "amg": f"FGMRES with multigrid on nested meshes to a relative residual of {case.linear.tolerance:g}",
    }
    choice = choose_solver(case.linear.solver, kept)
    why = f"; {choice.reason}" if case.linear.solver == "auto" else ""
    yield Item("fluid's linear solver", f"{solver[choice.solver]}{why}")


def _solid(case: Case, meshes: _Meshes) -> Iterator[Item]:
    if meshes.solid is None:
        return
    structure, mesh = meshes.solid
    unknowns = 2 * len(mesh.points)
    kept = _kept_of_solid(mesh)
    solver = {"direct": "sparse LU", "amg": f"algebraic multigrid to a relative residual of {case.linear.tolerance:g}"}
    yield Item("solid mesh", _mesh(structure, mesh))
    yield Item(
        "solid",
        f"{unknowns} unknowns of displacement, given ones included; "
        f"{kept} after static condensation, {solver[choose_solver(case.linear.solver, kept).solver]}",
    )
    for solid in case.solids:
        yield Item(f"solid {solid.name!r}", _material(solid, case.fluid))


def _material(solid: Solid, fluid: Fluid | None) -> str:
    ratio = f"; density ratio solid/fluid {solid.density / fluid.density:.4g}" if fluid else ""
    return (
        f"{_LAWS[solid.model]}, plane {solid.plane}, E = {solid.youngs_modulus:g}, ν = {solid.poissons_ratio:g}, "
        f"ρ = {solid.density:g}{ratio}"
    )


def _mover(case: Case, structure: BlockStructure, mesh: QuadMesh, edges: Index) -> str:
    """What the mover places."""
    driven = driven_edges(structure, mesh.order, edges)
    inside, sliding = placed_vertices(case.mover, structure, driven)
    kind = _MOVERS[type(case.mover)]
    if not inside.size and not sliding.size:
        return (
            f"{kind}: 0 free block vertices follow {len(driven.vertices)} driven ones; between the moving edges and "
            "the boundary the mesh is one block thick and can only be stretched. Add a ring of blocks if that fails"
        )
    free = "1 free block vertex follows" if len(inside) == 1 else f"{len(inside)} free block vertices follow"
    slides = f", {len(sliding)} slide along the boundary" if sliding.size else ""
    return f"{kind}: {free} {len(driven.vertices)} driven ones{slides}"


def _coupling(case: Case, meshes: _Meshes) -> Iterator[Item]:
    if _moves(case) and meshes.fluid is not None:
        yield Item("mover", _mover(case, *meshes.fluid, meshes.driven))
    if not _coupled(case):
        return
    settings = case.coupling
    edges, nodes = meshes.wet
    yield Item("interface", f"{_number(edges, 'block edge')}, {nodes} nodes of fluid and solid matched one to one")
    yield Item(
        "coupling",
        f"{_ACCELERATIONS[settings.acceleration]} to {settings.tolerance:g} in displacement and "
        f"force, at most {settings.max_iterations} iterations",
    )
    if isinstance(case.time, Steady) or settings.geometry == "implicit":
        yield Item("geometry", "implicit: a new fluid mesh in every coupling iteration")
    else:
        yield Item("geometry", "extrapolated: one fluid mesh a step")


def _time(case: Case) -> Iterator[Item]:
    if isinstance(case.time, Unsteady):
        time = case.time
        last = time.step(time.steps)[1]
        shorter = "" if last == time.dt else f", the last of {last:g},"
        order = "first order" if time.steps == 1 else "second order (the first step: of first)"
        yield Item(
            "time",
            f"{_number(time.steps, 'step')} of {time.dt:g}{shorter} from {time.start:g} to {time.end:g}, "
            f"backward differences of {order}",
        )
    else:
        yield Item("time", "steady")


def _output(case: Case) -> Iterator[Item]:
    output = case.output
    if case.quantities:
        yield Item("quantities", ", ".join(quantity.name for quantity in case.quantities))
    if output.period_of is not None and isinstance(case.time, Unsteady):
        yield Item("period", f"of {output.period_of}")
    if output.fields:
        files = " and ".join(name for name, body in (("fluid.pvd", case.fluid), ("solid.pvd", case.solids)) if body)
        if isinstance(case.time, Steady):
            yield Item("fields", f"{files} of the steady state")
        else:
            times = _number(-(-case.time.steps // output.every), "time")
            yield Item("fields", f"{files} every {_number(output.every, 'step')} and at the end: {times}")
    if output.plots:
        yield Item("plots", "PNG of mesh" + (", fields and quantities" if _has_series(case) else " and fields"))


def _has_series(case: Case) -> bool:
    return bool(case.quantities) and isinstance(case.time, Unsteady)


def _without_bodies(case: Case) -> Iterator[Item]:
    if case.fluid is None:
        yield Item("fluid", "no [fluid]")
    if not case.solids:
        yield Item("solid", "no [[solid]]")
    if not _coupled(case):
        yield Item("coupling", "no solid" if case.fluid else "no fluid")


def _without_motion(case: Case) -> Iterator[Item]:
    if case.fluid is None or _moves(case):
        return
    yield Item(
        "mesh motion",
        "no boundary of the fluid moves: geometry factors are computed once, matrices without "
        f"convection {_once(case)}",
    )


def _once(case: Case) -> str:
    """How often something is done that depends on nothing but the coefficients of the time scheme."""
    several = isinstance(case.time, Unsteady) and case.time.steps > 1
    return "twice, for the first step and the others" if several else "once"


def _without_iteration(case: Case, meshes: _Meshes) -> Iterator[Item]:
    fluid, solvers = case.fluid, _linear_solvers(case, meshes)
    if fluid is not None:
        factor = "factorisation" if solvers["fluid"] == "direct" else "preconditioner"
        if fluid.model == "stokes":
            kept = "" if _moves(case) else f", and its {factor} is kept"
            yield Item("convection", f"Stokes: the matrix does not depend on the velocity{kept}")
        elif not _iterates(case, fluid):
            however = ", however many coupling iterations it takes" if _one_mesh_a_step(case) else ""
            again = not case.solids and not fluid.merely_convects(None)
            unless = ", unless the flow changes at once, as after an impulsive start" if again else ""
            yield Item("fluid's Newton iteration", f"linear steps: one {factor} a step{however}{unless}")
    if "amg" not in solvers.values():
        yield Item("multigrid", "LU serves" if case.linear.solver == "auto" else 'linear.solver = "direct"')
    if case.solids and all(solid.model == "linear" for solid in case.solids):
        yield Item("solid's Newton iteration", f"linear: factorised {_once(case)}")
    if isinstance(case.time, Steady):
        yield Item("time loop", "steady: no inertia, no time steps")


def _one_mesh_a_step(case: Case) -> bool:
    return _coupled(case) and case.coupling.geometry == "extrapolated"


def _without_output(case: Case) -> Iterator[Item]:
    if not case.quantities:
        yield Item("quantities", "no [quantities]")
    if case.output.period_of is None:
        if _has_series(case):
            yield Item("period", "no output.period_of")
    elif isinstance(case.time, Steady):
        yield Item("period", "steady: output.period_of is not used")
    if not case.output.fields:
        yield Item("fields", "output.fields = false: no writer, vtk is not needed")
    if not case.output.plots:
        yield Item("plots", "output.plots = false: matplotlib is not needed")


def _unused_tables(case: Case) -> Iterator[Item]:
    """Tables that the scene has and the run does not read."""
    needless: dict[str, str] = {}
    if not _coupled(case):
        needless["coupling"] = "there is no " + ("solid" if case.fluid else "fluid")
    if not _moves(case):
        needless["mover"] = "no boundary of the fluid moves"
    if case.fluid and not case.solids and not _iterates(case, case.fluid):
        needless["nonlinear"] = "the equations are linear"
    for name, reason in needless.items():
        if name in case.tables:
            yield Item(f"[{name}]", f"not used: {reason}")
