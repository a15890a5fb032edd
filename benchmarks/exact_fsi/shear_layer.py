"""A viscous layer on an elastic one, both sheared by a wall that swings: exact at any amplitude."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exact_fsi.settings import Settings
from exact_fsi.waves import in_time, symbol, waves

Array = NDArray[np.float64]

__all__ = ["ShearLayer"]

_HS, _H = 1.0, 2.0
_MU_S, _MU_F, _RHO = 1.0, 0.1, 1.0


@dataclass(frozen=True)
class ShearLayer:
    """Solid 0 < y < 1, fluid 1 < y < 2 under a wall with the velocity U cos ωt; densities 1, shear moduli 1 and 0.1.

    Displacement Re(A sin(ky) exp(iωt)), k = -i s sqrt(ρ/μ_s); velocity Re((B cosh qη + C sinh qη) exp(iωt)), η = y - 1,
    q = sqrt(s ρ/μ_f), with s = iω; velocities and shear stresses agree at η = 0. Linear and neo-Hookean solids have no
    other stress in simple shear, and the pressure is 0.

    Attributes
    ----------
    speed, frequency : float
        U, ω.
    step : float or None
        If given, s is that of BDF2 with this step: the exact solution of the equations discretised in time only.
    """

    speed: float = 1.0
    frequency: float = 1.0
    step: float | None = None

    quantities = ("force",)

    @property
    def amplitudes(self) -> tuple[complex, complex, complex]:
        """A, B, C."""
        k, q, s = self._numbers
        interface = [s * np.sin(k * _HS), -1.0, 0.0]
        stress = [_MU_S * k * np.cos(k * _HS), 0.0, -_MU_F * q]
        wall = [0.0, np.cosh(q * (_H - _HS)), np.sinh(q * (_H - _HS))]
        a, b, c = np.linalg.solve(np.array([interface, stress, wall]), [0.0, 0.0, self.speed])
        return complex(a), complex(b), complex(c)

    @property
    def _numbers(self) -> tuple[complex, complex, complex]:
        s = symbol(self.frequency, self.step)
        return -1j * s * math.sqrt(_RHO / _MU_S), cmath.sqrt(s * _RHO / _MU_F), s

    def _turn(self, time: float) -> complex:
        return complex(np.exp(1j * self.frequency * time))

    def displacement_at(self, points: Array, time: float) -> Array:
        """Of the solid at reference points (..., 2)."""
        k = self._numbers[0]
        return _along_x(self.amplitudes[0] * np.sin(k * points[..., 1]) * self._turn(time))

    def solid_velocity_at(self, points: Array, time: float) -> Array:
        """Of the solid at reference points (..., 2)."""
        k, _, s = self._numbers
        return _along_x(s * self.amplitudes[0] * np.sin(k * points[..., 1]) * self._turn(time))

    def velocity_at(self, points: Array, time: float) -> Array:
        """Of the fluid at points (..., 2)."""
        q = self._numbers[1]
        _, b, c = self.amplitudes
        z = q * (points[..., 1] - _HS)
        return _along_x((b * np.cosh(z) + c * np.sinh(z)) * self._turn(time))

    def load_at(self, time: float) -> Array:
        """Force of the fluid on the solid, per length 1, shape (1,)."""
        q = self._numbers[1]
        return np.array([(_MU_F * q * self.amplitudes[2] * self._turn(time)).real])

    def scene(self, given: Settings, *, skewed: bool = True) -> str:
        """The scene, started from the exact state at t = 0.

        Left of the fluid the exact velocity is given, on the right its y component and the exact traction. Both sides
        lean as the interface moves.

        Parameters
        ----------
        given : Settings
        skewed : bool
            Whether the vertices inside are out of line; else mesh lines stay horizontal.
        """
        (k, q, s), (a, b, c) = self._numbers, self.amplitudes
        w = self.frequency
        plus, minus = 0.5 * (b + c), 0.5 * (b - c)

        def v(p: complex, m: complex, time: str) -> str:
            return f"{waves(p, q, w, 'y - 1', time)} + {waves(m, -q, w, 'y - 1', time)}"

        def u(amplitude: complex) -> str:  # sin(ky) = (exp(iky) - exp(-iky))/2i
            z = -0.5j * amplitude
            return f"{waves(z, 1j * k, w, 'y', '0')} + {waves(-z, -1j * k, w, 'y', '0')}"

        d = in_time(a * cmath.sin(k * _HS), w)
        stress = f"{_MU_F}*({v(q * plus, -q * minus, 't')})"
        lean = f"where(y < 1.5, ({d})/hypot({d}, 0.5), 0)"
        inner = ("m1 = [0.55, 1.42]", "n1 = [0.42, 0.6]") if skewed else ("m1 = [0.5, 1.5]", "n1 = [0.5, 0.5]")
        return f"""
[mesh]
order = {given.order}
elements = {given.elements}

[mesh.vertices]
s0 = [0, 0]
s1 = [0.5, 0]
s2 = [1, 0]
n0 = [0, 0.5]
{inner[1]}
n2 = [1, 0.5]
i0 = [0, 1]
i1 = [0.5, 1]
i2 = [1, 1]
m0 = [0, 1.5]
{inner[0]}
m2 = [1, 1.5]
t0 = [0, 2]
t1 = [0.5, 2]
t2 = [1, 2]

[mesh.blocks]
fluid = [["i0", "i1", "m1", "m0"], ["i1", "i2", "m2", "m1"], ["m0", "m1", "t1", "t0"], ["m1", "m2", "t2", "t1"]]
solid = [["s0", "s1", "n1", "n0"], ["s1", "s2", "n2", "n1"], ["n0", "n1", "i1", "i0"], ["n1", "n2", "i2", "i1"]]

[mesh.edges]
bottom = [["s0", "s1", "s2"]]
interface = [["i0", "i1", "i2"]]
solid_sides = [["s0", "n0", "i0"], ["s2", "n2", "i2"]]
left = [["i0", "m0", "t0"]]
right = [["i2", "m2", "t2"]]
top = [["t0", "t1", "t2"]]

[fluid]
density = {_RHO}
viscosity = {_MU_F}
initial_velocity = ["{v(plus, minus, "0")}", "0"]

[[fluid.boundary]]
on = "top"
type = "velocity"
x = "{in_time(self.speed, w)}"
y = 0

[[fluid.boundary]]
on = "left"
type = "velocity"
x = "{v(plus, minus, "t")}"
y = 0

[[fluid.boundary]]
on = "right"
type = "velocity"
y = 0
traction_x = "({stress})*{lean}"

[[solid]]
density = {_RHO}
youngs_modulus = {2.0 * 1.3 * _MU_S}
poissons_ratio = 0.3
model = "{given.model}"
initial_displacement = ["{u(a)}", "0"]
initial_velocity = ["{u(s * a)}", "0"]

[[solid.boundary]]
on = "bottom"
type = "fixed"

[[solid.boundary]]
on = "solid_sides"
type = "displacement"
y = 0

[quantities.force]
type = "force"
on = "interface"
component = "x"
{given.scene()}"""


def _along_x(amplitude: Array) -> Array:
    real = np.real(amplitude)
    return np.stack([real, np.zeros_like(real)], axis=-1)
