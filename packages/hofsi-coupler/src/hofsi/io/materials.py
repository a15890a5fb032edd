"""Materials and given motions of a scene: ``[fluid]``, ``[[solid]]``, ``[[motion]]``."""

from __future__ import annotations

from collections.abc import Mapping

from hoblock.expressions import compile_expression
from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import Fluid, Motion, Solid, VectorExpression
from hofsi.io.conditions import PLACE_AND_TIME, read_fluid_condition, read_solid_condition
from hofsi.io.names import block_groups, choice, edge_names

__all__ = ["read_fluid", "read_motion", "read_solid"]

_PLACE = ("x", "y")


def read_fluid(table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Fluid:
    """Read ``[fluid]``.

    Parameters
    ----------
    table : Table
    mesh : MeshScene
        With the names of edges and block groups.
    constants : mapping of str to float

    Returns
    -------
    Fluid

    Raises
    ------
    SceneError
        A missing or unknown key, an unknown name, a value of the wrong type or out of range.
    """
    density = table.number("density", positive=True)
    fluid = Fluid(
        density=density,
        viscosity=table.number("viscosity", positive=True),
        blocks=block_groups(table, mesh, "fluid"),
        boundaries=tuple(read_fluid_condition(entry, mesh, constants) for entry in table.tables("boundary")),
        model=choice(table, "model", ("navier-stokes", "stokes"), "navier-stokes"),
        convection=choice(table, "convection", ("newton", "picard", "linearised", "extrapolated"), "auto"),
        body_force=_body_force(table, constants, density),
        initial_velocity=_initial(table, "initial_velocity", constants),
        grad_div=table.number("grad_div", 0.0, minimum=0.0),
        convection_form=choice(table, "convection_form", ("convective", "skew-symmetric"), "convective"),
        place=table.place,
    )
    table.finish()
    return fluid


def read_solid(table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Solid:
    """Read one ``[[solid]]``; parameters and errors as in `read_fluid`.

    Returns
    -------
    Solid
    """
    density = table.number("density", positive=True)
    solid = Solid(
        name=table.string("name", "solid"),
        density=density,
        youngs_modulus=table.number("youngs_modulus", positive=True),
        poissons_ratio=table.number("poissons_ratio", above=-1.0, below=0.5),
        blocks=block_groups(table, mesh, "solid"),
        boundaries=tuple(read_solid_condition(entry, mesh, constants) for entry in table.tables("boundary")),
        model=choice(table, "model", ("st-venant-kirchhoff", "neo-hooke", "linear"), "st-venant-kirchhoff"),
        plane=choice(table, "plane", ("strain", "stress"), "strain"),
        body_force=_body_force(table, constants, density),
        initial_displacement=_initial(table, "initial_displacement", constants),
        initial_velocity=_initial(table, "initial_velocity", constants),
        place=table.place,
    )
    table.finish()
    return solid


def read_motion(table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> Motion:
    """Read one ``[[motion]]``; parameters and errors as in `read_fluid`.

    Returns
    -------
    Motion
    """
    motion = Motion(
        on=edge_names(table, mesh),
        x=table.expression("x", PLACE_AND_TIME, constants),
        y=table.expression("y", PLACE_AND_TIME, constants),
        place=table.place,
    )
    table.finish()
    return motion


def _body_force(table: Table, constants: Mapping[str, float], density: float) -> VectorExpression | None:
    """Force per unit volume including the weight; None if both vanish."""
    force = table.expression_pair("body_force", PLACE_AND_TIME, constants, None)
    gravity = table.pair("gravity", (0.0, 0.0), constants=constants)
    if gravity != (0.0, 0.0):
        weight = (density * gravity[0], density * gravity[1])
        place = table.place_of("gravity")
        if force is None:
            x, y = (compile_expression(value, PLACE_AND_TIME, constants, place) for value in weight)
        else:
            x, y = (
                compile_expression(f"({part.text}) + ({value!r})", PLACE_AND_TIME, constants, part.place)
                for part, value in zip(force, weight, strict=True)
            )
        force = (x, y)
    return None if force is None or (force[0].is_zero and force[1].is_zero) else force


def _initial(table: Table, key: str, constants: Mapping[str, float]) -> VectorExpression | None:
    """A field at the beginning; None if it vanishes."""
    field = table.expression_pair(key, _PLACE, constants, None)
    return None if field is None or (field[0].is_zero and field[1].is_zero) else field
