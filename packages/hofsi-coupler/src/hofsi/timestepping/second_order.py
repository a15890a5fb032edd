"""Time steps of equations of second order in time: M a + f(d) = force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.timestepping.schemes import bdf_weights

Array = NDArray[np.float64]

__all__ = ["MotionStep", "backward_difference", "generalised_alpha", "load_weights", "midpoint"]


@dataclass(frozen=True, eq=False)
class MotionStep:
    """What a scheme makes of one step: equilibrium at a point in it, and the motion at its end.

    The point's displacement is D = s d + (1 - s) dⁿ, its time tⁿ⁺¹ - (1 - s) h, its load s f + (1 - s) fⁿ. Equilibrium
    there is internal force(D) + M (mass_factor D + history) = load, and the motion at the end is
    v = velocity_factor d + velocity_history, a = acceleration_factor d + acceleration_history.

    Attributes
    ----------
    start : ndarray, shape (n, 2)
        dⁿ.
    share : float
        s, in (0, 1].
    mass_factor : float
    history : ndarray, shape (n, 2)
    velocity_factor, acceleration_factor : float
    velocity_history, acceleration_history : ndarray, shape (n, 2)
    averaged : bool
        Whether the stress at the point is that of the mean of the strains at both ends, corrected where the law needs
        it, not that of the strain there.
    """

    start: Array
    share: float
    mass_factor: float
    history: Array
    velocity_factor: float
    velocity_history: Array
    acceleration_factor: float
    acceleration_history: Array
    averaged: bool = False

    def point(self, displacement: Array) -> Array:
        """D for a displacement at the end of the step."""
        return displacement if self.share == 1.0 else self.share * displacement + (1.0 - self.share) * self.start

    def end(self, point: Array) -> Array:
        """The displacement at the end of the step for D."""
        return point if self.share == 1.0 else self.start + (point - self.start) / self.share

    def velocity(self, displacement: Array) -> Array:
        """Velocity at the end of the step."""
        return self.velocity_factor * displacement + self.velocity_history

    def acceleration(self, displacement: Array) -> Array:
        """Acceleration at the end of the step."""
        return self.acceleration_factor * displacement + self.acceleration_history


def backward_difference(
    displacements: Sequence[Array], velocities: Sequence[Array], steps: Sequence[float]
) -> MotionStep:
    """BDF2 of displacement and velocity, BDF1 where only one of each is known.

    Parameters
    ----------
    displacements, velocities : sequence of ndarray, shape (n, 2)
        At the ends of the last steps, newest first.
    steps : sequence of float
        Sizes of this step and those before it, newest first.
    """
    order = min(2, len(displacements), len(steps))
    c = bdf_weights(steps[:order])
    of_velocity = _history(c, displacements)
    of_acceleration = c[0] * of_velocity + _history(c, velocities)
    factor = float(c[0]) ** 2
    return MotionStep(displacements[0], 1.0, factor, of_acceleration, float(c[0]), of_velocity, factor, of_acceleration)


def generalised_alpha(
    displacement: Array, velocity: Array, acceleration: Array, step: float, spectral_radius: float
) -> MotionStep:
    """The generalised-α method: of second order, unconditionally stable, with damping of high frequencies as asked for.

    Parameters
    ----------
    displacement, velocity, acceleration : ndarray, shape (n, 2)
        At the start of the step.
    step : float
    spectral_radius : float
        ρ, in [0, 1]: what is left in each step of oscillations that are much faster; 1 for no damping.

    References
    ----------
    Chung, Hulbert, J. Appl. Mech. 60 (1993) 371–375, doi:10.1115/1.2900803, Eqs. (17), (18), (20), (25).
    """
    alpha_m = (2.0 * spectral_radius - 1.0) / (spectral_radius + 1.0)
    alpha_f = spectral_radius / (spectral_radius + 1.0)
    gamma = 0.5 - alpha_m + alpha_f
    beta = 0.25 * (1.0 - alpha_m + alpha_f) ** 2
    share, h = 1.0 - alpha_f, step
    own = 1.0 / (beta * h * h)  # of the displacement in Newmark's acceleration
    newmark = -own * displacement - velocity / (beta * h) - (0.5 / beta - 1.0) * acceleration
    mass_factor = (1.0 - alpha_m) * own / share
    history = (1.0 - alpha_m) * (newmark + own * displacement) + alpha_m * acceleration - mass_factor * displacement
    return MotionStep(
        displacement,
        share,
        mass_factor,
        history,
        gamma * h * own,
        velocity + h * ((1.0 - gamma) * acceleration + gamma * newmark),
        own,
        newmark,
    )


def midpoint(displacement: Array, velocity: Array, step: float) -> MotionStep:
    """The midpoint rule with the stress of the mean strain: keeps energy and momentum of nonlinear solids.

    The acceleration is that of the midpoint.

    Parameters
    ----------
    displacement, velocity : ndarray, shape (n, 2)
        At the start of the step.
    step : float

    References
    ----------
    Simo, Tarnow, Z. angew. Math. Phys. 43 (1992) 757–792, doi:10.1007/BF00913408, Section 3.
    """
    h = step
    constant = -2.0 / (h * h) * displacement - 2.0 / h * velocity
    return MotionStep(
        displacement,
        0.5,
        4.0 / (h * h),
        -4.0 / (h * h) * displacement - 2.0 / h * velocity,
        2.0 / h,
        -2.0 / h * displacement - velocity,
        2.0 / (h * h),
        constant,
        averaged=True,
    )


def load_weights(share: float, ratio: float) -> tuple[float, float, float]:
    """Weights that make a fluid's load at the point of equilibrium of those at the ends of the last steps.

    They are exact for loads linear in time. A load that changes its sign in every step would hardly be felt, by the
    midpoint rule not at all, if it were interpolated within the step: whatever is light beside the fluid that it moves
    could oscillate so undamped, for the fluid's backward differences resist by just such a load. With equal steps h the
    weights are those of an average (1 + s) fⁿ⁺¹/2 + (1 - s) fⁿ/2 made twice, which leaves s² of such a load.

    Parameters
    ----------
    share : float
        s, in (0, 1].
    ratio : float
        Size of the step before over that of this one; 0 if only one earlier load is known.

    Returns
    -------
    tuple of float
        Of fⁿ⁺¹, fⁿ and fⁿ⁻¹.
    """
    oldest = 0.25 * (1.0 - share) ** 2 if ratio else 0.0
    middle = 1.0 - share - oldest * (1.0 + ratio)
    return 1.0 - middle - oldest, middle, oldest


def _history(weights: Array, values: Sequence[Array]) -> Array:
    """Part of a backward difference that is known at the start of the step."""
    return np.asarray(sum(w * value for w, value in zip(weights[1:], values, strict=False)))
