"""Quantities of a scene: ``[quantities.NAME]``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import Force, Point, PressureDifference, Probe, Quantity
from hofsi.errors import CaseError
from hofsi.io.names import check_name, edge_names

__all__ = ["read_quantity"]

_TYPES = ("probe", "force", "coefficient", "pressure-difference")


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
    quantity: Quantity
    match table.string("type", choices=_TYPES):
        case "probe":
            quantity = _probe(name, table, mesh, constants)
        case "force":
            factor = table.number("factor", 1.0)
            quantity = Force(name, edge_names(table, mesh), _axis(table), factor, table.place)
        case "coefficient":
            quantity = Force(name, edge_names(table, mesh), _axis(table), _coefficient(table), table.place)
        case _:
            start, end = (_point(table, key, mesh, constants) for key in ("from", "to"))
            quantity = PressureDifference(name, start, end, table.place)
    table.finish()
    return quantity


def _probe(name: str, table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Probe:
    at = _point(table, "at", mesh, constants)
    match table.string("field", choices=("displacement", "velocity", "pressure")):
        case "displacement":
            return Probe(name, "displacement", _component(table), at, _owner(table, "solid", None), table.place)
        case "velocity":
            return Probe(name, "velocity", _component(table), at, _owner(table, "fluid", None), table.place)
        case _:
            if table.has("component"):
                raise CaseError("pressure has no components; remove this key", table.place_of("component"))
            return Probe(name, "pressure", None, at, _owner(table, "fluid", "solid"), table.place)


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


def _coefficient(table: Table) -> float:
    density, velocity, length = (table.number(key, positive=True) for key in ("density", "velocity", "length"))
    return 2.0 / (density * velocity**2 * length)


def _point(table: Table, key: str, mesh: MeshScene, constants: Mapping[str, float]) -> Point:
    """Read a vertex by name, or ``[x, y]``."""
    value = table.raw(key)
    if isinstance(value, str):
        check_name(value, mesh.vertices, "vertices in [mesh.vertices]", table.place_of(key))
        return Point(*mesh.vertices[value], vertex=value)
    return Point(*table.pair(key, constants=constants))
