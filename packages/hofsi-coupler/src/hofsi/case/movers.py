"""Settings of the movers: how block vertices follow a moving boundary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from hoblock.expressions import Expression

__all__ = [
    "AngleOptimisationSettings",
    "BarrierSettings",
    "MotionSettings",
    "MoverSettings",
    "PseudoSolidSettings",
    "RuleSettings",
    "RuleVertex",
]


@dataclass(frozen=True, kw_only=True)
class MotionSettings:
    """What all movers have in common.

    Attributes
    ----------
    sliding : tuple of str
        Names of the mesh's edges along which block vertices slide.
    inherit : {"auto", "all", "none"}
        Which inner block edges take on the shape of a driven one they face.
    halvings : int
        How often a motion that fails is halved before it is given up.
    """

    sliding: tuple[str, ...] = ()
    inherit: Literal["auto", "all", "none"] = "auto"
    halvings: int = 4


@dataclass(frozen=True, kw_only=True)
class BarrierSettings(MotionSettings):
    """Block vertices are placed where an energy with a barrier against turned corners is smallest.

    Attributes
    ----------
    energy : {"bar", "ang"}
        Of distortion, whose minimum is the reference; or of the angles.
    size_weight, emphasis : float
        Of changes of size, and of the worst corners; "bar" only. Not negative.
    length_weight : float
        Of changes of length; "ang" only. Positive.
    """

    energy: Literal["bar", "ang"] = "bar"
    size_weight: float = 1.0
    emphasis: float = 1.0
    length_weight: float = 0.1


@dataclass(frozen=True, kw_only=True)
class PseudoSolidSettings(MotionSettings):
    """Block vertices follow as those of an elastic solid.

    Attributes
    ----------
    exponent : float
        Of the blocks' stiffness, E = (A/A_min)^exponent.
    poissons_ratio : float
        In (-1, 0.5).
    incremental : bool
        Whether the solid is made anew of the last state's blocks in every move.
    """

    exponent: float = -1.0
    poissons_ratio: float = 0.3
    incremental: bool = False


@dataclass(frozen=True, kw_only=True)
class AngleOptimisationSettings(MotionSettings):
    """Block vertices are placed for the best angles, one after the other.

    Attributes
    ----------
    power : int
        1 or even; of the angles' errors.
    sweeps : int
        Over all vertices, a step.
    iterations : int
        Gauss–Newton steps a vertex and sweep.
    lower, upper : float
        Limits of edge lengths as fractions of the initial ones; None for no upper limit.
    penalty : float
        C of the length penalty, per length⁴.
    radius : float
        Largest motion of a vertex in a step, as a fraction of the shortest edge at it.
    projection : {"every", "end"}
        Whether the radius limits every iteration or the end of a step.
    damping : float
        Of the Gauss–Newton matrix, as a fraction of its trace; not negative.
    predictor : bool
        Whether a pseudo-solid places the vertices before they are optimised.
    ideal : {"reference", "right"}
        The angles aimed at: those of the reference position, or 90° at regular vertices.
    """

    power: int = 2
    sweeps: int = 5
    iterations: int = 1
    lower: float = 0.5
    upper: float | None = None
    penalty: float = 10.0
    radius: float = 0.2
    projection: Literal["every", "end"] = "every"
    damping: float = 0.3
    predictor: bool = True
    ideal: Literal["reference", "right"] = "reference"

    @staticmethod
    def as_published() -> AngleOptimisationSettings:
        """Return the paper's form: undamped, one sweep, no predictor, right angles."""
        return AngleOptimisationSettings(sweeps=1, iterations=5, damping=0.0, predictor=False, ideal="right")


@dataclass(frozen=True)
class RuleVertex:
    """How one block vertex follows.

    Attributes
    ----------
    name : str
    x, y : Expression of x, y (reference), dx_NAME and dy_NAME (displacement of a driven vertex)
        The vertex's displacement.
    place : str
    """

    name: str
    x: Expression
    y: Expression
    place: str = ""


@dataclass(frozen=True, kw_only=True)
class RuleSettings(MotionSettings):
    """Block vertices follow a rule of the scene; those without one stay.

    Attributes
    ----------
    vertices : tuple of RuleVertex
    """

    vertices: tuple[RuleVertex, ...] = ()


MoverSettings: TypeAlias = BarrierSettings | PseudoSolidSettings | AngleOptimisationSettings | RuleSettings
