"""Settings of mover, time, coupling, solvers and output."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

__all__ = [
    "AngleOptimisationSettings",
    "CouplingSettings",
    "LinearSettings",
    "MoverSettings",
    "NonlinearSettings",
    "OutputSettings",
    "PseudoSolidSettings",
    "Steady",
    "TimeSettings",
    "Unsteady",
]


@dataclass(frozen=True)
class PseudoSolidSettings:
    """Block vertices follow as those of an elastic solid.

    Attributes
    ----------
    exponent : float
        Of the blocks' stiffness, E = (A/A_min)^exponent.
    poissons_ratio : float
        In (-1, 0.5).
    """

    exponent: float = -1.0
    poissons_ratio: float = 0.3


@dataclass(frozen=True)
class AngleOptimisationSettings:
    """Block vertices are placed for the best angles, one after the other.

    Attributes
    ----------
    power : int
        Even; of the angles' errors.
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


MoverSettings: TypeAlias = PseudoSolidSettings | AngleOptimisationSettings


@dataclass(frozen=True)
class Steady:
    """No time: the state at rest is sought; expressions do not depend on t."""


@dataclass(frozen=True)
class Unsteady:
    """Equal time steps, but for a last one that may be shorter to land on the end.

    Attributes
    ----------
    dt : float
        Positive.
    start, end : float
        ``start + (steps - 1) dt < end <= start + steps dt`` but for rounding.
    steps : int
        At least 1.
    """

    dt: float
    start: float
    end: float
    steps: int

    def step(self, number: int) -> tuple[float, float]:
        """End and size of a step, counted from 1."""
        end = self.start + number * self.dt
        if number < self.steps or end - self.end <= 1e-6 * self.dt:
            return end, self.dt
        return self.end, self.end - (self.start + (number - 1) * self.dt)


TimeSettings: TypeAlias = Steady | Unsteady


@dataclass(frozen=True)
class CouplingSettings:
    """How fluid and solid are brought to agree in every step.

    Attributes
    ----------
    acceleration : {"iqn-ils", "aitken", "constant"}
    geometry : {"extrapolated", "implicit"}
        "implicit" makes a new mesh in every coupling iteration.
    predictor : int
        Order of extrapolation of the interface displacement, 0 to 3.
    tolerance : float
        Of displacement and force, relative to the step's increment.
    max_iterations : int
    reuse : int
        Steps whose secants IQN-ILS keeps.
    filter : float
        Of the QR decomposition of the secants; 0 keeps all of them.
    relaxation : float
        First relaxation factor, in (0, 1].
    """

    acceleration: Literal["iqn-ils", "aitken", "constant"] = "iqn-ils"
    geometry: Literal["extrapolated", "implicit"] = "extrapolated"
    predictor: int = 2
    tolerance: float = 1e-6
    max_iterations: int = 50
    reuse: int = 10
    filter: float = 1e-3
    relaxation: float = 0.5


@dataclass(frozen=True)
class NonlinearSettings:
    """Newton's method: relative tolerance of the residual, largest number of iterations."""

    tolerance: float = 1e-10
    max_iterations: int = 25


@dataclass(frozen=True)
class LinearSettings:
    """The linear solver; its relative tolerance is for "amg" only."""

    solver: Literal["direct", "amg"] = "direct"
    tolerance: float = 1e-10


@dataclass(frozen=True)
class OutputSettings:
    """What is written besides the quantities.

    Attributes
    ----------
    fields, plots : bool
    every : int
        Steps between field files; the last step is always written.
    period_of : str or None
        The quantity whose period defines means, amplitudes and frequencies.
    """

    fields: bool = True
    every: int = 10
    plots: bool = True
    period_of: str | None = None
