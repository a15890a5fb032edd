"""Whether a case can be simulated at all: materials, boundaries, and what has no solution."""

from __future__ import annotations

from collections.abc import Iterator

from hoblock.expressions import Expression
from hofsi import boundary_checks
from hofsi.case import (
    Case,
    Displacement,
    DoNothing,
    Fluid,
    FluidCondition,
    Force,
    NoSlip,
    Periodic,
    Pressure,
    Probe,
    Roller,
    Slip,
    Solid,
    SolidIntegral,
    Steady,
    TimeFunction,
    Traction,
    Velocity,
)
from hofsi.edge_owners import (
    FLUID,
    Edge,
    EdgeOwners,
    components,
    edges_of,
    in_words,
    named_edges,
    quad_edges,
    solid_label,
)
from hofsi.errors import CaseError

__all__ = ["check_case", "check_order", "expressions"]


def check_case(case: Case) -> None:
    """Check everything that the parts of a case must fulfil together.

    Parameters
    ----------
    case : Case
        Its names of edges and block groups exist, its numbers are in range: `hofsi.io.scene` sees to that.

    Raises
    ------
    CaseError
        The first mistake found, with its place and a way out.
    """
    _check_materials(case)
    if case.scheme.name != "bdf2" and not case.solids:
        raise CaseError("there is no [[solid]] that it could be for; expected one. Remove it", "time.solid")
    check_order(case)
    owners = EdgeOwners.build(case.mesh, _groups(case))
    boundary_checks.check_named_edges(case)
    boundary_checks.check_fluid_boundaries(case, owners)
    boundary_checks.check_solid_boundaries(case, owners)
    boundary_checks.check_motions(case, owners)
    boundary_checks.check_quantities(case, owners)
    _check_quantities(case)
    _check_periodic(case)
    _check_enclosed(case, owners)
    if isinstance(case.time, Steady):
        _check_steady(case)
        _check_drifting(case, owners)
        _check_floating(case)


def check_order(case: Case) -> None:
    """Check that a fluid has elements of order 2 or higher: its pressure has one order less.

    Raises
    ------
    CaseError
        If it has not.
    """
    if case.fluid and case.mesh.order < 2:
        raise CaseError(f"got {case.mesh.order}; Taylor–Hood elements of a fluid need order 2 or higher.", "mesh.order")


def _groups(case: Case) -> dict[str, tuple[str, ...]]:
    """Block groups of every material."""
    fluid = {FLUID: case.fluid.blocks} if case.fluid else {}
    return fluid | {solid_label(solid.name): solid.blocks for solid in case.solids}


def _check_materials(case: Case) -> None:
    if case.fluid is None and not case.solids:
        raise CaseError("there is nothing to simulate: neither [fluid] nor [[solid]]. Add one of them")
    used: dict[str, str] = {}
    for material in (*((case.fluid,) if case.fluid else ()), *case.solids):
        _claim_blocks(material, used)
    _check_solid_names(case)


def _claim_blocks(material: Fluid | Solid, used: dict[str, str]) -> None:
    for group in material.blocks:
        if group in used:
            raise CaseError(
                f"the block group {group!r} is used by {used[group]} already; expected one material for every group",
                f"{material.place}.blocks",
            )
        used[group] = material.place


def _check_solid_names(case: Case) -> None:
    places: dict[str, str] = {}
    for solid in case.solids:
        if solid.name in places:
            raise CaseError(
                f"{solid.name!r} is the name of {places[solid.name]} already; give every solid a name of its own",
                f"{solid.place}.name",
            )
        places[solid.name] = solid.place


def _check_quantities(case: Case) -> None:
    for quantity in case.quantities:
        if isinstance(quantity, Force | TimeFunction):
            continue  # of the fluid or of solids, where its edges are; of nothing
        needs_solid = isinstance(quantity, SolidIntegral) or (isinstance(quantity, Probe) and quantity.of == "solid")
        if needs_solid and not case.solids:
            hint = 'Remove the quantity, or set of = "fluid"'
            kind = "a probe" if isinstance(quantity, Probe) else "an energy"
            raise CaseError(f"{kind} of the solid, and there is no [[solid]]. {hint}", quantity.place)
        if not needs_solid and case.fluid is None:
            of_solids_too = isinstance(quantity, Probe) and quantity.field == "velocity"
            hint = 'Set of = "solid"' if of_solids_too else "Remove the quantity"
            raise CaseError(f"it is of the fluid, and there is no [fluid]. {hint}", quantity.place)


def _check_periodic(case: Case) -> None:
    """Refuse what periodic sides cannot be combined with."""
    if case.fluid is None:
        return
    sliding = {edge: name for name, edge in edges_of(case.mesh, case.mover.sliding)}
    for condition in case.fluid.boundaries:
        if not isinstance(condition, Periodic):
            continue
        if case.linear.solver == "amg":
            raise CaseError(
                f'there is no multigrid for periodic sides, as those of {condition.place}; expected "auto" or "direct"',
                "linear.solver",
            )
        for name, edge in edges_of(case.mesh, condition.on):
            if edge in sliding:
                raise CaseError(
                    f"edge {in_words([edge])} of {sliding[edge]!r} is periodic ({name!r} of {condition.place}): its "
                    "vertices and those opposite would slide to different places. Remove it here",
                    "mover.sliding",
                )


def _parts(case: Case, fluid: Fluid) -> tuple[frozenset[Edge], ...]:
    """Edges of the parts of the fluid that hang together, through periodic sides too."""
    ties = [
        frozenset(edge for _, edge in edges_of(case.mesh, condition.on))
        for condition in fluid.boundaries
        if isinstance(condition, Periodic)
    ]
    return components((quad for group in fluid.blocks for quad in case.mesh.blocks[group]), ties)


def _given(fluid: Fluid) -> str:
    """What conditions give that give no velocity."""
    return "periodic sides, tractions or pressures" if fluid.periodic else "tractions or pressures"


def _check_enclosed(case: Case, owners: EdgeOwners) -> None:
    """Dirichlet–Neumann coupling of an enclosed fluid fails: the volume that the solid displaces cannot leave.

    At rest nothing is displaced; the pressure is then the one with mean zero.
    """
    if case.fluid is None or not case.solids or isinstance(case.time, Steady):
        return
    openings = frozenset(
        edge
        for condition in case.fluid.boundaries
        if _is_open(condition)
        for name in condition.on
        for edge in named_edges(case.mesh, name)
    )
    for part in _parts(case, case.fluid):
        wet = sorted(edge for edge in part if owners.is_wet(edge))
        if wet and not part & openings:
            raise CaseError(
                "the fluid is enclosed by given velocities, walls and the solid at "
                f"{in_words(wet)}: an incompressible fluid leaves the solid no room to move, and a coupling by "
                "velocity and force (Dirichlet–Neumann) has no solution. Open the fluid: give one edge the condition "
                '"do-nothing", "traction" or "pressure"',
                "fluid.boundary",
            )


def _is_open(condition: FluidCondition) -> bool:
    if isinstance(condition, Velocity):
        return condition.x is None or condition.y is None
    return isinstance(condition, Traction | Pressure | DoNothing)


def _check_steady(case: Case) -> None:
    for expression in expressions(case):
        if "t" in expression.variables_used:
            raise CaseError(
                f'"{expression.text}" depends on t, and the case is steady. Remove t, or give dt and end in [time] '
                "instead of steady = true",
                expression.place,
            )
    if case.fluid and case.fluid.convection in ("linearised", "extrapolated"):
        raise CaseError(
            'a steady flow has no earlier steps to extrapolate from; expected "newton" or "picard"', "fluid.convection"
        )
    if case.fluid and case.solids and case.coupling.geometry == "extrapolated":
        raise CaseError(
            'a steady state has no earlier steps to extrapolate from; expected "implicit"', "coupling.geometry"
        )


def _check_drifting(case: Case, owners: EdgeOwners) -> None:
    """A steady fluid whose boundary gives tractions alone may have any uniform velocity on top."""
    if case.fluid is None:
        return
    held = frozenset(
        edge
        for condition in case.fluid.boundaries
        if isinstance(condition, Velocity | NoSlip | Slip)
        for name in condition.on
        for edge in named_edges(case.mesh, name)
    )
    for part in _parts(case, case.fluid):
        if not part & held and not any(owners.is_wet(edge) for edge in part):
            raise CaseError(
                f"no condition gives a velocity, only {_given(case.fluid)}: the steady velocity is not determined. "
                'Give an edge type = "velocity", "no-slip" or "slip", or march in time',
                "fluid.boundary",
            )


def expressions(case: Case) -> Iterator[Expression]:
    """All expressions that may depend on time."""
    materials = (*((case.fluid,) if case.fluid else ()), *case.solids)
    for material in materials:
        yield from material.body_force or ()
        for condition in material.boundaries:
            match condition:
                case Velocity(x=x, y=y, traction_x=traction_x, traction_y=traction_y):
                    yield from (part for part in (x, y, traction_x, traction_y) if part)
                case Displacement(x=x, y=y) | Traction(x=x, y=y):
                    yield from (part for part in (x, y) if part)
                case Pressure(value=value):
                    yield value
                case _:
                    pass
    for motion in case.motions:
        yield from (motion.x, motion.y)


def _check_floating(case: Case) -> None:
    """Solids that share an edge hold each other."""
    held = frozenset(
        edge
        for solid in case.solids
        for condition in solid.boundaries
        if isinstance(condition, Displacement | Roller)
        for name in condition.on
        for edge in named_edges(case.mesh, name)
    )
    quads = [(solid, quad) for solid in case.solids for group in solid.blocks for quad in case.mesh.blocks[group]]
    for part in components(quad for _, quad in quads):
        if not part & held:
            solid = next(solid for solid, quad in quads if quad_edges(quad)[0] in part)
            raise CaseError(
                f"solid {solid.name!r} is floating: nothing holds it, its steady displacement is not determined. Add "
                'a [[solid.boundary]] with type = "fixed", "displacement" or "roller"',
                f"{solid.place}.boundary",
            )
