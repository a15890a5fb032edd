"""Boundary conditions of a scene: ``[[fluid.boundary]]`` and ``[[solid.boundary]]``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from hoblock.expressions import Expression, compile_expression
from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import (
    Displacement,
    DoNothing,
    FluidCondition,
    Free,
    NoSlip,
    Periodic,
    Pressure,
    Roller,
    Slip,
    SolidCondition,
    Traction,
    Velocity,
)
from hofsi.errors import CaseError
from hofsi.io.names import edge_names

__all__ = ["PLACE_AND_TIME", "read_fluid_condition", "read_solid_condition"]

PLACE_AND_TIME = ("x", "y", "t")
"""Variables of expressions on a boundary."""

_FLUID_TYPES = ("velocity", "no-slip", "slip", "symmetry", "traction", "pressure", "do-nothing", "periodic")
_SOLID_TYPES = ("fixed", "displacement", "roller", "symmetry", "traction", "pressure", "free")


def read_fluid_condition(table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> FluidCondition:
    """Read one ``[[fluid.boundary]]``.

    Parameters
    ----------
    table : Table
    mesh : MeshScene
        With the names of edges.
    constants : mapping of str to float

    Returns
    -------
    FluidCondition

    Raises
    ------
    SceneError
        An unknown type, key or name of an edge, or a value of the wrong type.
    CaseError
        Keys that do not go together.
    """
    kind = table.string("type", choices=_FLUID_TYPES)
    on = edge_names(table, mesh)
    condition: FluidCondition
    match kind:
        case "velocity":
            condition = _velocity(table, on, constants)
        case "no-slip":
            condition = NoSlip(on, table.place)
        case "slip" | "symmetry":
            condition = Slip(on, table.place)
        case "periodic":
            condition = _periodic(table, on, mesh)
        case "do-nothing":
            condition = DoNothing(on, table.place, _backflow(table))
        case "traction":
            condition = replace(_traction(table, on, constants), backflow=_backflow(table))
        case _:
            condition = replace(_pressure(table, on, constants), backflow=_backflow(table))
    table.finish()
    return condition


def read_solid_condition(table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> SolidCondition:
    """Read one ``[[solid.boundary]]``; parameters and errors as in `read_fluid_condition`.

    Returns
    -------
    SolidCondition
    """
    kind = table.string("type", choices=_SOLID_TYPES)
    on = edge_names(table, mesh)
    condition: SolidCondition
    match kind:
        case "fixed":
            condition = Displacement(on, _zero(table), _zero(table), table.place)
        case "displacement":
            condition = Displacement(on, *_components(table, constants, 'Where both are free, use "free"'), table.place)
        case "roller" | "symmetry":
            condition = Roller(on, table.place)
        case "free":
            condition = Free(on, table.place)
        case "traction":
            condition = _traction(table, on, constants)
        case _:
            condition = _pressure(table, on, constants)
    table.finish()
    return condition


def _periodic(table: Table, on: tuple[str, ...], mesh: MeshScene) -> Periodic:
    second = edge_names(table, mesh, "with")
    both = [name for name in second if name in on]
    if both:
        raise CaseError(
            f"{both[0]!r} is on the other side already; expected a side opposite to it. Name that one",
            table.place_of("with"),
        )
    return Periodic.between(on, second, table.place)


def _velocity(table: Table, on: tuple[str, ...], constants: Mapping[str, float]) -> Velocity:
    x, y = _components(table, constants, 'Where both are free, use "traction" or "do-nothing"')
    tractions = {}
    for axis, given in (("x", x), ("y", y)):
        key = f"traction_{axis}"
        tractions[axis] = table.expression(key, PLACE_AND_TIME, constants, None)
        if given and tractions[axis]:
            raise CaseError(
                f"the velocity component {axis!r} is given too; expected one of them. Remove {axis!r} or {key!r}",
                table.place_of(key),
            )
    return Velocity(on, x, y, tractions["x"], tractions["y"], table.place)


def _components(
    table: Table, constants: Mapping[str, float], alternative: str
) -> tuple[Expression | None, Expression | None]:
    """Read ``x`` and ``y``; one of them may be missing."""
    x = table.expression("x", PLACE_AND_TIME, constants, None)
    y = table.expression("y", PLACE_AND_TIME, constants, None)
    if x is None and y is None:
        raise CaseError(f"neither x nor y is given; expected at least one. {alternative}", table.place)
    return x, y


def _traction(table: Table, on: tuple[str, ...], constants: Mapping[str, float]) -> Traction:
    x, y = _components(table, constants, "Where both vanish, write x = 0")
    return Traction(on, x or _zero(table), y or _zero(table), table.place)


def _pressure(table: Table, on: tuple[str, ...], constants: Mapping[str, float]) -> Pressure:
    return Pressure(on, table.expression("value", PLACE_AND_TIME, constants), table.place)


def _backflow(table: Table) -> float:
    return table.number("backflow", 0.0, minimum=0.0)


def _zero(table: Table) -> Expression:
    return compile_expression(0, PLACE_AND_TIME, place=table.place)
