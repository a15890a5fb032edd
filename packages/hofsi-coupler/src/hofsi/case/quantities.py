"""Quantities that a run records."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from hoblock.expressions import Expression
    from hofsi.case.materials import VectorExpression

__all__ = [
    "FlowBalance",
    "FlowRate",
    "FluidIntegral",
    "Force",
    "IntegralName",
    "MeanPressure",
    "Moment",
    "Point",
    "PressureDifference",
    "Probe",
    "Quantity",
    "ScalarQuantity",
    "SolidIntegral",
    "SolidIntegralName",
    "TimeFunction",
]


IntegralName: TypeAlias = Literal[
    "area", "continuity-residual", "dissipation", "divergence", "enstrophy", "kinetic-energy"
]
"""Integrals over the fluid."""

SolidIntegralName: TypeAlias = Literal["kinetic-energy", "strain-energy"]
"""Integrals over the solids."""


@dataclass(frozen=True)
class Point:
    """A place in the undeformed mesh, and the vertex it was named by, if any."""

    x: float
    y: float
    vertex: str | None = None


@dataclass(frozen=True)
class Probe:
    """A field at a point: a material point of a solid, a place fixed in space in a fluid.

    Attributes
    ----------
    name : str
    field : {"displacement", "velocity", "pressure", "vorticity"}
    component : {"x", "y", "magnitude"} or None
        None for pressure and vorticity.
    at : Point
    of : {"fluid", "solid"}
    place : str
    """

    name: str
    field: Literal["displacement", "velocity", "pressure", "vorticity"]
    component: Literal["x", "y", "magnitude"] | None
    at: Point
    of: Literal["fluid", "solid"]
    place: str = ""


@dataclass(frozen=True)
class Force:
    """The force of the fluid on named edges, or that of solids on their surroundings at dry ones, times a factor.

    Attributes
    ----------
    name : str
    on : tuple of str
        Names of the mesh's edges: outer ones of the fluid or shared with a solid, or outer ones of solids.
    component : {"x", "y"}
    factor : float
    place : str
    """

    name: str
    on: tuple[str, ...]
    component: Literal["x", "y"]
    factor: float = 1.0
    place: str = ""


@dataclass(frozen=True)
class PressureDifference:
    """Fluid pressure at ``start`` minus that at ``end``; ``from`` and ``to`` in a scene."""

    name: str
    start: Point
    end: Point
    place: str = ""


@dataclass(frozen=True)
class Moment:
    """The moment of the fluid's force on named edges, counter-clockwise, times a factor.

    Attributes
    ----------
    name : str
    on : tuple of str
        Names of the mesh's edges, outer ones of the fluid or shared with a solid.
    about : Point or pair of Expression of t
        A vertex, which moves with the mesh, or a place as a function of time.
    factor : float
    place : str
    """

    name: str
    on: tuple[str, ...]
    about: Point | VectorExpression
    factor: float = 1.0
    place: str = ""


@dataclass(frozen=True)
class FlowRate:
    """Flow out of the fluid through named edges, ∫ u·n, or ∫ (u - w)·n relative to their own motion."""

    name: str
    on: tuple[str, ...]
    relative: bool = False
    place: str = ""


@dataclass(frozen=True)
class FlowBalance:
    """Net flow out of the fluid through its whole boundary, over what flows in."""

    name: str
    place: str = ""


@dataclass(frozen=True)
class MeanPressure:
    """Mean pressure of the fluid on named edges."""

    name: str
    on: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True)
class FluidIntegral:
    """An integral over the whole fluid."""

    name: str
    what: IntegralName
    place: str = ""


@dataclass(frozen=True)
class SolidIntegral:
    """An integral over all solids."""

    name: str
    what: SolidIntegralName
    place: str = ""


@dataclass(frozen=True)
class TimeFunction:
    """A given function of time, such as a prescribed motion, that other quantities are compared with."""

    name: str
    value: Expression
    place: str = ""


ScalarQuantity: TypeAlias = (
    Probe
    | PressureDifference
    | Moment
    | FlowRate
    | FlowBalance
    | MeanPressure
    | FluidIntegral
    | SolidIntegral
    | TimeFunction
)
"""Quantities with one component."""

Quantity: TypeAlias = Force | ScalarQuantity
"""Quantities of a scene: ``[quantities.NAME]``."""
