"""An elastic bar that pushes a column of fluid to and fro: an interface that moves along its normal, added mass."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exact_fsi.settings import Settings

Array = NDArray[np.float64]

__all__ = ["Piston"]

_LENGTH, _END = 1.0, 2.0  # of the bar at rest; of the fluid
_NU, _RHO, _MU_F = 0.3, 1.0, 0.1
_YOUNG = (1.0 + _NU) * (1.0 - 2.0 * _NU) / (1.0 - _NU)  # λ + 2μ = 1


@dataclass(frozen=True)
class Piston:
    """Linear bar 0 < x < 1 between rollers, fluid from its end to x = 2 between slip walls; densities 1, λ + 2μ = 1.

    Displacement D sin(kx)/sin k cos θ, θ = ωt + φ, k = ω. The fluid moves as a whole, u = ḋ, with the pressure
    p = P(t) + ρ ü (2 - x), d at the bar's end. P at the open end makes it the bar's stress at the interface, wherever
    that is: P = -d k cot k - ρ d̈ (1 - d).

    Attributes
    ----------
    amplitude, frequency, phase : float
        D, ω, φ. With the phase of the default displacement, velocity and acceleration begin all different from 0.
    """

    amplitude: float = 0.25
    frequency: float = 1.0
    phase: float = -0.7

    quantities = ("force",)

    def displacement_at(self, points: Array, time: float) -> Array:
        """Of the solid at reference points (..., 2)."""
        k, theta = self.frequency, self.frequency * time + self.phase
        return _along_x(self.amplitude / math.sin(k) * np.sin(k * points[..., 0]) * math.cos(theta))

    def velocity_at(self, points: Array, time: float) -> Array:
        """Of the fluid at points (..., 2)."""
        w = self.frequency
        return _along_x(np.full(points.shape[:-1], -w * self.amplitude * math.sin(w * time + self.phase)))

    def load_at(self, time: float) -> Array:
        """Force of the fluid on the solid, shape (1,)."""
        k, theta = self.frequency, self.frequency * time + self.phase
        return np.array([self.amplitude * k / math.tan(k) * math.cos(theta)])

    def scene(self, given: Settings) -> str:
        """The scene, started from the exact state at t = 0."""
        w, amplitude = self.frequency, self.amplitude
        shape = f"{amplitude / math.sin(w)!r}*sin({w!r}*x)"
        d = f"{amplitude!r}*cos({w!r}*t + ({self.phase!r}))"
        pressure = f"-({d})*({w / math.tan(w)!r}) + {_RHO * w * w!r}*({d})*({_END - _LENGTH!r} - {d})"
        return f"""
[mesh]
order = {given.order}
elements = {given.elements}

[mesh.vertices]
s0 = [0, 0]
s1 = [0, 0.5]
s2 = [0, 1]
n0 = [0.5, 0]
n1 = [0.55, 0.42]
n2 = [0.5, 1]
i0 = [1, 0]
i1 = [1, 0.5]
i2 = [1, 1]
m0 = [1.5, 0]
m1 = [1.45, 0.58]
m2 = [1.5, 1]
o0 = [2, 0]
o1 = [2, 0.5]
o2 = [2, 1]

[mesh.blocks]
solid = [["s0", "n0", "n1", "s1"], ["s1", "n1", "n2", "s2"], ["n0", "i0", "i1", "n1"], ["n1", "i1", "i2", "n2"]]
fluid = [["i0", "m0", "m1", "i1"], ["i1", "m1", "m2", "i2"], ["m0", "o0", "o1", "m1"], ["m1", "o1", "o2", "m2"]]

[mesh.edges]
foot = [["s0", "s1", "s2"]]
guides = [["s0", "n0", "i0"], ["s2", "n2", "i2"]]
interface = [["i0", "i1", "i2"]]
walls = [["i0", "m0", "o0"], ["i2", "m2", "o2"]]
open = [["o0", "o1", "o2"]]

[fluid]
density = {_RHO}
viscosity = {_MU_F}
initial_velocity = ["{-w * amplitude * math.sin(self.phase)!r}", "0"]

[[fluid.boundary]]
on = "walls"
type = "slip"

[[fluid.boundary]]
on = "open"
type = "pressure"
value = "{pressure}"

[[solid]]
density = 1.0
youngs_modulus = {_YOUNG!r}
poissons_ratio = {_NU}
model = "linear"
initial_displacement = ["{shape}*({math.cos(self.phase)!r})", "0"]
initial_velocity = ["{shape}*({-w * math.sin(self.phase)!r})", "0"]

[[solid.boundary]]
on = "foot"
type = "fixed"

[[solid.boundary]]
on = "guides"
type = "roller"

[quantities.force]
type = "force"
on = "interface"
component = "x"
{given.scene()}"""


def _along_x(values: Array) -> Array:
    return np.stack([values, np.zeros_like(values)], axis=-1)
