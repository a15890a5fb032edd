"""Quantities that a run records."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

__all__ = [
    "Force",
    "Point",
    "PressureDifference",
    "Probe",
    "Quantity",
]


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
    field : {"displacement", "velocity", "pressure"}
    component : {"x", "y", "magnitude"} or None
        None for pressure.
    at : Point
    of : {"fluid", "solid"}
    place : str
    """

    name: str
    field: Literal["displacement", "velocity", "pressure"]
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


Quantity: TypeAlias = Probe | Force | PressureDifference
