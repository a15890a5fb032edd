"""Boundary conditions of fluid and solid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from hoblock.expressions import Expression

__all__ = [
    "Displacement",
    "DoNothing",
    "FluidCondition",
    "Free",
    "NoSlip",
    "Periodic",
    "Pressure",
    "Roller",
    "Slip",
    "SolidCondition",
    "Traction",
    "Velocity",
]


@dataclass(frozen=True)
class Velocity:
    """Given fluid velocity, by component.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y, t, or None
        None leaves the component free; at least one is given.
    traction_x, traction_y : Expression of x, y, t, or None
        Component of σ·n where the velocity component is free; None means 0.
    place : str
    """

    on: tuple[str, ...]
    x: Expression | None
    y: Expression | None
    traction_x: Expression | None = None
    traction_y: Expression | None = None
    place: str = ""


@dataclass(frozen=True)
class NoSlip:
    """The fluid has the velocity of the wall: zero, or that of a moving boundary."""

    on: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True)
class Slip:
    """u·n = w·n with the mesh velocity w, and no tangential traction."""

    on: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True)
class Traction:
    """Given traction.

    Of a fluid: σ·n. Of a solid: force per unit reference length, of fixed direction.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y, t
    place : str
    backflow : float
        Of a fluid: β in the traction β (ρ/2) min(u·n, 0) u that is added.
    """

    on: tuple[str, ...]
    x: Expression
    y: Expression
    place: str = ""
    backflow: float = 0.0


@dataclass(frozen=True)
class Pressure:
    """Given pressure: the traction -p n.

    Of a fluid: σ·n = -p n. Of a solid: a follower load, per unit current length along the current normal.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    value : Expression of x, y, t
    place : str
    backflow : float
        As of `Traction`.
    """

    on: tuple[str, ...]
    value: Expression
    place: str = ""
    backflow: float = 0.0


@dataclass(frozen=True)
class DoNothing:
    """μ ∂u/∂n - p n = 0, with ``backflow`` the additional traction of `Traction` instead of 0."""

    on: tuple[str, ...]
    place: str = ""
    backflow: float = 0.0


@dataclass(frozen=True)
class Periodic:
    """Velocity and pressure on one side are those on the other, a translation of it.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges, of both sides.
    first, second : tuple of str
        Those of each side.
    place : str
    """

    on: tuple[str, ...]
    first: tuple[str, ...]
    second: tuple[str, ...]
    place: str = ""

    @staticmethod
    def between(first: tuple[str, ...], second: tuple[str, ...], place: str = "") -> Periodic:
        """Return the condition between two sides."""
        return Periodic((*first, *second), first, second, place)


FluidCondition: TypeAlias = Velocity | NoSlip | Slip | Traction | Pressure | DoNothing | Periodic


@dataclass(frozen=True)
class Displacement:
    """Given displacement of a solid, by component; ``fixed`` in a scene is 0 in both.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y (reference), t, or None
        None leaves the component free, without traction; at least one is given.
    place : str
    """

    on: tuple[str, ...]
    x: Expression | None
    y: Expression | None
    place: str = ""


@dataclass(frozen=True)
class Roller:
    """d·n = 0 with the reference normal n, and no tangential traction."""

    on: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True)
class Free:
    """Nothing acts on the solid's edges."""

    on: tuple[str, ...]
    place: str = ""


SolidCondition: TypeAlias = Displacement | Roller | Traction | Pressure | Free
