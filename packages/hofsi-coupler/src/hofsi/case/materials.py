"""Materials with their boundary conditions, and prescribed motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

from hofsi.case.conditions import Periodic

if TYPE_CHECKING:
    from hoblock.expressions import Expression
    from hofsi.case.conditions import FluidCondition, SolidCondition
    from hofsi.case.settings import CouplingSettings

__all__ = [
    "Convection",
    "ConvectionForm",
    "Fluid",
    "Motion",
    "Solid",
    "VectorExpression",
]


VectorExpression: TypeAlias = "tuple[Expression, Expression]"
Convection: TypeAlias = Literal["newton", "picard", "linearised", "extrapolated"]
ConvectionForm: TypeAlias = Literal["convective", "skew-symmetric"]


@dataclass(frozen=True)
class Fluid:
    """An incompressible Newtonian fluid.

    Attributes
    ----------
    density : float
        Positive.
    viscosity : float
        Dynamic, positive.
    blocks : tuple of str
        Block groups of the mesh.
    boundaries : tuple of FluidCondition
        Exactly one for each outer edge that is not shared with a solid.
    model : {"navier-stokes", "stokes"}
    convection : {"auto", "newton", "picard", "linearised", "extrapolated"}
        How a step treats convection. With u expected from the last steps, "linearised" is Newton's linearisation about
        it, with "extrapolated" it merely convects. "auto" leaves the choice to the solver.
    body_force : pair of Expression of x, y, t, or None
        Per unit volume, gravity included; None is zero.
    initial_velocity : pair of Expression of x, y, or None
        None is zero.
    grad_div : float
        γ of the term ∫ γ (∇·u)(∇·v), of the unit of the viscosity; 0 for none.
    convection_form : {"convective", "skew-symmetric"}
        Plain, or the form from which no energy comes: `hofsi.solvers.fluid_convection`. The exact solution has both.
    place : str
    """

    density: float
    viscosity: float
    blocks: tuple[str, ...]
    boundaries: tuple[FluidCondition, ...]
    model: Literal["navier-stokes", "stokes"] = "navier-stokes"
    convection: Convection | Literal["auto"] = "auto"
    body_force: VectorExpression | None = None
    initial_velocity: VectorExpression | None = None
    grad_div: float = 0.0
    convection_form: ConvectionForm = "convective"
    place: str = "fluid"

    @property
    def skew_symmetric(self) -> bool:
        """Whether convection keeps energy though the discrete velocity has divergence."""
        return self.convection_form == "skew-symmetric"

    @property
    def periodic(self) -> bool:
        """Whether any sides are periodic."""
        return any(isinstance(condition, Periodic) for condition in self.boundaries)

    def convection_of_steps(self, coupling: CouplingSettings | None) -> Convection:
        """How a time step treats convection, with "auto" resolved.

        Parameters
        ----------
        coupling : CouplingSettings or None
            None without coupling. If every coupling iteration has a mesh of its own, "auto" iterates on convection too.
        """
        if self.convection != "auto":
            return self.convection
        return "linearised" if coupling is None or coupling.geometry == "extrapolated" else "newton"


@dataclass(frozen=True)
class Solid:
    """An elastic solid.

    Attributes
    ----------
    name : str
        Unique among the solids.
    density, youngs_modulus : float
        Positive.
    poissons_ratio : float
        In (-1, 0.5).
    blocks : tuple of str
        Block groups of the mesh.
    boundaries : tuple of SolidCondition
        Exactly one for each dry outer edge; on edges shared with the fluid at most one traction or pressure.
    model : {"st-venant-kirchhoff", "neo-hooke", "linear"}
    plane : {"strain", "stress"}
    body_force : pair of Expression of x, y (reference), t, or None
        Per unit reference volume, gravity included; None is zero.
    initial_displacement, initial_velocity : pair of Expression of x, y (reference), or None
        None is zero.
    place : str
    """

    name: str
    density: float
    youngs_modulus: float
    poissons_ratio: float
    blocks: tuple[str, ...]
    boundaries: tuple[SolidCondition, ...]
    model: Literal["st-venant-kirchhoff", "neo-hooke", "linear"] = "st-venant-kirchhoff"
    plane: Literal["strain", "stress"] = "strain"
    body_force: VectorExpression | None = None
    initial_displacement: VectorExpression | None = None
    initial_velocity: VectorExpression | None = None
    place: str = "solid[0]"


@dataclass(frozen=True)
class Motion:
    """Outer edges of the fluid that move as given.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y (reference), t
        Displacement.
    place : str
    """

    on: tuple[str, ...]
    x: Expression
    y: Expression
    place: str = ""
