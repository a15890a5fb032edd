"""Quantities of a scene: ``[quantities.NAME]``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import (
    FlowBalance,
    FlowRate,
    FluidIntegral,
    Force,
    IntegralName,
    MeanPressure,
    Moment,
    Point,
    PressureDifference,
    Probe,
    Quantity,
    SolidIntegral,
    TimeFunction,
    VectorExpression,
)
from hofsi.errors import CaseError
from hofsi.io.names import check_name, choice, edge_names

__all__ = ["read_quantity"]

_INTEGRALS: tuple[IntegralName, ...] = (
    "area",
    "continuity-residual",
    "dissipation",
    "divergence",
    "enstrophy",
    "kinetic-energy",
)
_TYPES = (
    "probe",
    "pressure-difference",
    "force",
    "coefficient",
    "moment",
    "moment-coefficient",
    "flow-rate",
    "flow-balance",
    "mean-pressure",
    *_INTEGRALS,
    "strain-energy",
    "expression",
)


def read_quantity(name: str, table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Quantity:
    """Read one ``[quantities.NAME]``.

    Parameters
    ----------
    name : str
    table : Table
    mesh : MeshScene
        With the names of vertices and edges.
    constants : mapping of str to float

    Returns
    -------
    Quantity
        A coefficient is a force with a factor.

    Raises
    ------
    SceneError
        A missing or unknown key, an unknown name, a value of the wrong type or out of range.
    """
    if not name or name != name.strip() or not name.isprintable():
        raise CaseError(
            f"got the name {name!r}; expected printable characters without spaces around them. Choose another name",
            table.place,
        )
    quantity = _quantity(name, table, mesh, constants)
    table.finish()
    return quantity


def _quantity(name: str, table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Quantity:
    place = table.place
    match table.string("type", choices=_TYPES):
        case "probe":
            return _probe(name, table, mesh, constants)
        case "pressure-difference":
            start, end = (_point(table, key, mesh, constants) for key in ("from", "to"))
            return PressureDifference(name, start, end, place)
        case "force":
            factor = table.number("factor", 1.0)
            return Force(name, edge_names(table, mesh), _axis(table), factor, place)
        case "coefficient":
            return Force(name, edge_names(table, mesh), _axis(table), _coefficient(table, 1), place)
        case "moment":
            about, factor = _centre(table, mesh, constants), table.number("factor", 1.0)
            return Moment(name, edge_names(table, mesh), about, factor, place)
        case "moment-coefficient":
            about, factor = _centre(table, mesh, constants), _coefficient(table, 2)
            return Moment(name, edge_names(table, mesh), about, factor, place)
        case "flow-rate":
            relative = choice(table, "relative_to", ("space", "mesh"), "space") == "mesh"
            return FlowRate(name, edge_names(table, mesh), relative, place)
        case "flow-balance":
            return FlowBalance(name, place)
        case "mean-pressure":
            return MeanPressure(name, edge_names(table, mesh), place)
        case "expression":
            return TimeFunction(name, table.expression("value", ("t",), constants), place)
        case "strain-energy":
            return SolidIntegral(name, "strain-energy", place)
        case "kinetic-energy" if _owner(table, "fluid", None) == "solid":
            return SolidIntegral(name, "kinetic-energy", place)
        case _:
            return FluidIntegral(name, choice(table, "type", _INTEGRALS, "area"), place)


def _probe(name: str, table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Probe:
    at = _point(table, "at", mesh, constants)
    match table.string("field", choices=("displacement", "velocity", "pressure", "vorticity")):
        case "displacement":
            return Probe(name, "displacement", _component(table), at, _owner(table, "solid", None), table.place)
        case "velocity":
            return Probe(name, "velocity", _component(table), at, _owner(table, "fluid", None), table.place)
        case field:
            if table.has("component"):
                raise CaseError(f"{field} has no components; remove this key", table.place_of("component"))
            scalar: Literal["pressure", "vorticity"] = "pressure" if field == "pressure" else "vorticity"
            return Probe(name, scalar, None, at, _owner(table, "fluid", "solid"), table.place)


def _owner(
    table: Table, default: Literal["fluid", "solid"], without: Literal["fluid", "solid"] | None
) -> Literal["fluid", "solid"]:
    """Read ``of``; ``without`` has no such field."""
    of: Literal["fluid", "solid"] = default
    match table.string("of", default, choices=("fluid", "solid")):
        case "fluid":
            of = "fluid"
        case "solid":
            of = "solid"
    if of == without:
        raise CaseError(
            f"got {of!r}, which has no such field; expected {default!r}. Change it, or the field", table.place_of("of")
        )
    return of


def _component(table: Table) -> Literal["x", "y", "magnitude"]:
    match table.string("component", choices=("x", "y", "magnitude")):
        case "x":
            return "x"
        case "y":
            return "y"
        case _:
            return "magnitude"


def _axis(table: Table) -> Literal["x", "y"]:
    return "x" if table.string("component", choices=("x", "y")) == "x" else "y"


def _coefficient(table: Table, power: int) -> float:
    """2/(ρ U² L) of a force, 2/(ρ U² L²) of a moment."""
    density, velocity, length = (table.number(key, positive=True) for key in ("density", "velocity", "length"))
    return 2.0 / (density * velocity**2 * length**power)


def _centre(table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Point | VectorExpression:
    """Read ``about``: a vertex by name, or ``[x, y]``, expressions of t."""
    if isinstance(table.raw("about"), str):
        return _point(table, "about", mesh, constants)
    return table.expression_pair("about", ("t",), constants)


def _point(table: Table, key: str, mesh: MeshScene, constants: Mapping[str, float]) -> Point:
    """Read a vertex by name, or ``[x, y]``."""
    value = table.raw(key)
    if isinstance(value, str):
        check_name(value, mesh.vertices, "vertices in [mesh.vertices]", table.place_of(key))
        return Point(*mesh.vertices[value], vertex=value)
    return Point(*table.pair(key, constants=constants))
