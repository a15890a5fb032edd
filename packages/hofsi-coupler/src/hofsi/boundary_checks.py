"""Whether every outer block edge of a case has exactly one boundary condition, and none stands where it cannot."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from hofsi.case import (
    Case,
    FlowRate,
    Force,
    MeanPressure,
    Moment,
    Motion,
    Pressure,
    Solid,
    SolidCondition,
    Traction,
)
from hofsi.edge_owners import FLUID, Edge, EdgeOwners, edges_of, in_words, quad_edges, solid_label
from hofsi.errors import CaseError

__all__ = [
    "check_fluid_boundaries",
    "check_motions",
    "check_named_edges",
    "check_quantities",
    "check_solid_boundaries",
]

_OnEdges: TypeAlias = Force | Moment | FlowRate | MeanPressure


class _Taken:
    """Edges that have a condition already, and where in the scene it stands."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._places: dict[Edge, str] = {}

    def add(self, edge: Edge, name: str, place: str) -> None:
        if edge in self._places:
            raise CaseError(
                f"{_edge(name, edge)} has two {self._what}s: this one and {self._places[edge]}; "
                "expected one. Remove it from one of them",
                f"{place}.on",
            )
        self._places[edge] = place

    def missing(self, edges: Iterable[Edge]) -> list[Edge]:
        return [edge for edge in edges if edge not in self._places]


def check_named_edges(case: Case) -> None:
    """Check that the names of ``[mesh.edges]`` run along block edges.

    Raises
    ------
    CaseError
        If a step of a path is not an edge of a block.
    """
    known = {edge for quads in case.mesh.blocks.values() for quad in quads for edge in quad_edges(quad)}
    for name, edge in edges_of(case.mesh, case.mesh.edges):
        if edge not in known:
            raise CaseError(
                f"the path steps from vertex to vertex over {in_words([edge])}, which is not an edge of any block. "
                "Name all vertices along the way, and check their spelling",
                f"mesh.edges.{name}",
            )


def check_fluid_boundaries(case: Case, owners: EdgeOwners) -> None:
    """Check that every outer edge of the fluid has exactly one condition, and no other edge has one.

    Raises
    ------
    CaseError
        An edge with two conditions or none, or a condition on an edge that is coupled or not an outer edge.
    """
    if case.fluid is None:
        return
    taken = _Taken("condition")
    for condition in case.fluid.boundaries:
        for name, edge in edges_of(case.mesh, condition.on):
            if owners.is_wet(edge):
                raise CaseError(
                    f"{_edge(name, edge)} {owners.where(edge)}: it is coupled, the fluid moves with the "
                    f"solid there and takes no condition. Remove {name!r} here, or split it if only a part is coupled",
                    f"{condition.place}.on",
                )
            _expect_outer(owners, FLUID, name, edge, condition.place)
            taken.add(edge, name, condition.place)
    missing = taken.missing(owners.outer(FLUID))
    if missing:
        raise CaseError(
            f"no condition on {in_words(missing)}; expected exactly one on every outer edge of the fluid. Name these "
            'edges in [mesh.edges] and add a [[fluid.boundary]], for example with type = "no-slip"',
            "fluid.boundary",
        )


def check_solid_boundaries(case: Case, owners: EdgeOwners) -> None:
    """Check that every dry outer edge of each solid has exactly one condition, and coupled ones loads at most.

    Raises
    ------
    CaseError
        An edge with two conditions, a dry one with none, or a condition on an edge that cannot have it.
    """
    for solid in case.solids:
        label = solid_label(solid.name)
        taken = _Taken("condition")
        for condition in solid.boundaries:
            for name, edge in edges_of(case.mesh, condition.on):
                _expect_solid_edge(owners, label, condition, name, edge)
                taken.add(edge, name, condition.place)
        missing = taken.missing(owners.outer(label))
        if missing:
            raise CaseError(_forgotten(solid, missing), f"{solid.place}.boundary")


def check_motions(case: Case, owners: EdgeOwners) -> None:
    """Check that every ``[[motion]]`` moves outer edges of the fluid, each at most once.

    Raises
    ------
    CaseError
        A motion without a fluid, on another edge, or on an edge that another one moves.
    """
    taken = _Taken("motion")
    for motion in case.motions:
        if case.fluid is None:
            raise CaseError(
                "a [[motion]] moves a boundary of the fluid, and there is no [fluid]. Move a solid by a "
                '[[solid.boundary]] with type = "displacement"',
                motion.place,
            )
        for name, edge in edges_of(case.mesh, motion.on):
            _expect_free_to_move(owners, motion, name, edge)
            taken.add(edge, name, motion.place)


def check_quantities(case: Case, owners: EdgeOwners) -> None:
    """Check that forces and flows are asked for on boundaries.

    Raises
    ------
    CaseError
        A quantity of edges that are not at a boundary, a force on edges of the fluid and dry edges of solids, or a
        moment, flow rate or mean pressure on dry edges.
    """
    for quantity in case.quantities:
        if isinstance(quantity, Force):
            _expect_one_body(case, owners, quantity)
        elif isinstance(quantity, Moment | FlowRate | MeanPressure) and case.fluid is not None:
            _expect_fluid(case, owners, quantity)


def _expect_one_body(case: Case, owners: EdgeOwners, quantity: Force) -> None:
    found: dict[str, str] = {}
    for name, edge in edges_of(case.mesh, quantity.on):
        found.setdefault(_body_at(case, owners, quantity, name, edge), _edge(name, edge))
    if len(found) == 2:
        raise CaseError(
            f"{found['fluid']} is at the fluid and {found['solid']} at a solid alone; expected one kind: there the "
            "force is that of the fluid, here that of the solid. Make two quantities of it",
            f"{quantity.place}.on",
        )


def _expect_fluid(case: Case, owners: EdgeOwners, quantity: _OnEdges) -> None:
    for name, edge in edges_of(case.mesh, quantity.on):
        if _body_at(case, owners, quantity, name, edge) == "solid":
            raise CaseError(
                f"{_edge(name, edge)} is at a solid alone, and this quantity is of the fluid; expected an edge at the "
                "boundary of the fluid. Use another name",
                f"{quantity.place}.on",
            )


def _body_at(case: Case, owners: EdgeOwners, quantity: _OnEdges, name: str, edge: Edge) -> str:
    """The body that is meant on an edge: "fluid", also where it touches a solid, or "solid"."""
    labels = owners.of[edge]
    if owners.is_wet(edge) or labels == (FLUID,):
        return "fluid"
    if len(labels) == 1:
        return "solid"
    bodies = [body for body, there in (("the fluid", case.fluid), ("a solid", case.solids)) if there]
    raise CaseError(
        f"{_edge(name, edge)} {owners.where(edge)}; expected an edge at the boundary of {' or '.join(bodies)}. "
        f"Correct the paths of {name!r} in [mesh.edges], or use another name",
        f"{quantity.place}.on",
    )


def _expect_outer(owners: EdgeOwners, label: str, name: str, edge: Edge, place: str) -> None:
    if owners.of.get(edge, ()) != (label,):
        raise CaseError(
            f"{_edge(name, edge)} {owners.where(edge)}; expected an outer edge of {label}. "
            f"Correct the paths of {name!r} in [mesh.edges], or use another name",
            f"{place}.on",
        )


def _expect_solid_edge(owners: EdgeOwners, label: str, condition: SolidCondition, name: str, edge: Edge) -> None:
    if not (owners.is_wet(edge) and label in owners.of[edge]):
        _expect_outer(owners, label, name, edge, condition.place)
    elif not isinstance(condition, Traction | Pressure):
        raise CaseError(
            f"{_edge(name, edge)} {owners.where(edge)}: the fluid loads it and it moves with the coupling; only "
            f"traction and pressure may be given there. Remove {name!r} here, or split it if only a part is coupled",
            f"{condition.place}.on",
        )


def _expect_free_to_move(owners: EdgeOwners, motion: Motion, name: str, edge: Edge) -> None:
    if owners.is_wet(edge):
        raise CaseError(
            f"{_edge(name, edge)} {owners.where(edge)}: it moves with the solid and cannot be given a motion. "
            f"Remove {name!r} here",
            f"{motion.place}.on",
        )
    _expect_outer(owners, FLUID, name, edge, motion.place)


def _forgotten(solid: Solid, missing: list[Edge]) -> str:
    return (
        f"no condition on {in_words(missing)}; expected exactly one on every dry outer edge of solid {solid.name!r}. "
        'Name these edges in [mesh.edges] and add a [[solid.boundary]], type = "free" if nothing acts'
    )


def _edge(name: str, edge: Edge) -> str:
    return f"edge {in_words([edge])} of {name!r}"
