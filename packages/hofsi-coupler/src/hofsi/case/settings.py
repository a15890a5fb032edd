"""Settings of time, coupling, solvers and output."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

__all__ = [
    "CouplingSettings",
    "LinearSettings",
    "NonlinearSettings",
    "OutputSettings",
    "SolidScheme",
    "Steady",
    "TimeSettings",
    "Unsteady",
]


@dataclass(frozen=True)
class Steady:
    """No time: the state at rest is sought; expressions do not depend on t."""


@dataclass(frozen=True)
class Unsteady:
    """Equal time steps, but for a last one that may be shorter to land on the end; they may be divided.

    Attributes
    ----------
    dt : float
        Positive.
    start, end : float
        ``start + (steps - 1) dt < end <= start + steps dt`` but for rounding.
    steps : int
        At least 1.
    halvings : int
        How often a step may be halved, if it fails or its local error is too large.
    tolerance : float or None
        Of the local error of a step, relative to the largest velocity and displacement; None not to estimate it.
    first : float or None
        Largest size of the first steps, from ``dt / 2**halvings`` to ``dt``; None for ``dt``.
    """

    dt: float
    start: float
    end: float
    steps: int
    halvings: int = 4
    tolerance: float | None = None
    first: float | None = None

    def step(self, number: int) -> tuple[float, float]:
        """End and size of a step, counted from 1."""
        end = self.start + number * self.dt
        if number < self.steps or end - self.end <= 1e-6 * self.dt:
            return end, self.dt
        return self.end, self.end - (self.start + (number - 1) * self.dt)


TimeSettings: TypeAlias = Steady | Unsteady


@dataclass(frozen=True)
class SolidScheme:
    """How solids are advanced in time.

    Attributes
    ----------
    name : {"bdf2", "generalised-alpha", "energy-momentum"}
    spectral_radius : float
        Of "generalised-alpha", in [0, 1]: what a step leaves of oscillations that are much faster than it.
    """

    name: Literal["bdf2", "generalised-alpha", "energy-momentum"] = "bdf2"
    spectral_radius: float = 0.8


@dataclass(frozen=True)
class CouplingSettings:
    """How fluid and solid are brought to agree in every step.

    Attributes
    ----------
    acceleration : {"iqn-ils", "imvj", "aitken", "constant"}
    geometry : {"extrapolated", "implicit"}
        "implicit" makes a new mesh in every coupling iteration.
    predictor : int
        Order of extrapolation of the interface displacement, 0 to 3.
    tolerance, force_tolerance : float
        Of displacement and force, relative to the step's increment.
    max_iterations : int
    reuse : int
        Steps whose secants IQN-ILS keeps; steps after which IMVJ compresses its Jacobian.
    filter : float
        Of the QR decomposition of the secants, and of the singular values of IMVJ's Jacobian; 0 keeps all of them.
    relaxation : float
        First relaxation factor, in (0, 1].
    condensed : bool
        Whether the fluid is condensed to the interface, where it can be: the solid then finds its displacement together
        with the load's answer to it.
    """

    acceleration: Literal["iqn-ils", "imvj", "aitken", "constant"] = "iqn-ils"
    geometry: Literal["extrapolated", "implicit"] = "extrapolated"
    predictor: int = 2
    tolerance: float = 1e-6
    force_tolerance: float = 1e-4
    max_iterations: int = 50
    reuse: int = 10
    filter: float = 1e-3
    relaxation: float = 0.5
    condensed: bool = True


@dataclass(frozen=True)
class NonlinearSettings:
    """Newton's method: relative tolerance of the residual, largest number of iterations."""

    tolerance: float = 1e-10
    max_iterations: int = 25


@dataclass(frozen=True)
class LinearSettings:
    """How linear systems are solved.

    Attributes
    ----------
    solver : {"auto", "direct", "amg"}
        "auto" is one of the others, by size and memory.
    tolerance : float
        For "amg" only: of the residual, relative to the right-hand side. Newton's method asks for less in its steps.
    lag : bool
        Whether the fluid's nonlinear iterations solve with earlier factors, by GMRES, as long as that is cheap.
    """

    solver: Literal["auto", "direct", "amg"] = "auto"
    tolerance: float = 1e-10
    lag: bool = True


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
    energy : bool
        Whether the energy of every step is balanced.
    checkpoint_every : int or None
        Steps between restart files, each of which takes the place of the last; None for one only if the run is broken
        off.
    """

    fields: bool = True
    every: int = 10
    plots: bool = True
    period_of: str | None = None
    checkpoint_every: int | None = None
    energy: bool = False
