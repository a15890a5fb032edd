"""An elastic disc in a viscous fluid, both turned to and fro by the wall around them: a curved interface."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import iv, jv, kv

from exact_fsi.settings import Settings
from exact_fsi.waves import in_time, symbol

Array = NDArray[np.float64]

__all__ = ["RotatingDisc"]

_R, _WALL, _MIDDLE = 0.5, 1.0, 0.75
_RHO, _MU_F, _NU = 1.0, 0.1, 0.3
_DEGREE = 15  # of polynomials for the initial fields: exact to rounding


@dataclass(frozen=True)
class RotatingDisc:
    """Solid r < 1/2, fluid 1/2 < r < 1; at the wall the speed V cos ωt; densities 1, shear moduli μ and 0.1.

    Angular displacement Re(A J₁(kr) exp(iωt)), k = -i s sqrt(ρ/μ), and velocity Re((B I₁(qr) + C K₁(qr)) exp(iωt)),
    q = sqrt(s ρ/0.1), with s = iω; velocities and shear stresses agree at r = 1/2. There is no change of volume and no
    pressure, but for terms of second order: with the default V they are 10⁻⁶ of the rest.

    Attributes
    ----------
    modulus, speed, frequency : float
        μ, V, ω.
    step : float or None
        As of `ShearLayer`.
    """

    modulus: float = 1.0
    speed: float = 1e-6
    frequency: float = 2.0 * math.pi
    step: float | None = None

    quantities = ("torque",)

    @property
    def _numbers(self) -> tuple[complex, complex, complex]:
        s = symbol(self.frequency, self.step)
        return -1j * s * math.sqrt(_RHO / self.modulus), complex(np.sqrt(s * _RHO / _MU_F)), s

    @property
    def amplitudes(self) -> tuple[complex, complex, complex]:
        """A, B, C."""
        k, q, s = self._numbers
        interface = [s * jv(1, k * _R), -iv(1, q * _R), -kv(1, q * _R)]
        stress = [-self.modulus * k * jv(2, k * _R), -_MU_F * q * iv(2, q * _R), _MU_F * q * kv(2, q * _R)]
        wall = [0.0, iv(1, q * _WALL), kv(1, q * _WALL)]
        a, b, c = np.linalg.solve(np.array([interface, stress, wall]), [0.0, 0.0, self.speed])
        return complex(a), complex(b), complex(c)

    def stress(self, r: float) -> complex:
        """Amplitude of the fluid's shear stress."""
        q = self._numbers[1]
        _, b, c = self.amplitudes
        return complex(_MU_F * q * (b * iv(2, q * r) - c * kv(2, q * r)))

    def _solid(self, r: Array) -> Array:
        return np.asarray(self.amplitudes[0] * jv(1, self._numbers[0] * r))

    def _fluid(self, r: Array) -> Array:
        q = self._numbers[1]
        _, b, c = self.amplitudes
        return np.asarray(b * iv(1, q * r) + c * kv(1, q * r))

    def _turn(self, time: float) -> complex:
        return complex(np.exp(1j * self.frequency * time))

    def displacement_at(self, points: Array, time: float) -> Array:
        """Of the solid at reference points (..., 2)."""
        return _around(points, self._solid(np.hypot(points[..., 0], points[..., 1])) * self._turn(time))

    def solid_velocity_at(self, points: Array, time: float) -> Array:
        """Of the solid at reference points (..., 2)."""
        r = np.hypot(points[..., 0], points[..., 1])
        return _around(points, self._numbers[2] * self._solid(r) * self._turn(time))

    def velocity_at(self, points: Array, time: float) -> Array:
        """Of the fluid at points (..., 2)."""
        return _around(points, self._fluid(np.hypot(points[..., 0], points[..., 1])) * self._turn(time))

    def load_at(self, time: float) -> Array:
        """Torque of the fluid on the solid, shape (1,)."""
        return np.array([2.0 * math.pi * _R**2 * (self.stress(_R) * self._turn(time)).real])

    def scene(self, given: Settings) -> str:
        """The scene, started from the exact state at t = 0.

        On three quarters of the wall the velocity is given, on one the exact traction: an enclosed fluid would be
        refused.
        """
        w, s = self.frequency, self._numbers[2]
        wall = in_time(complex(self.speed), w)
        stress = in_time(self.stress(_WALL), w)
        u = [_tangential(lambda r, f=f: f * self._solid(r), 0.0, _R) for f in (1.0, s)]
        v = _tangential(self._fluid, _R, _WALL)
        places = {"q": 0.25, "c": _R, "m": _MIDDLE, "b": _WALL}
        turns = [math.pi / 4.0 + math.pi / 2.0 * k for k in range(4)]
        vertices = "\n".join(
            f"{name}{k} = [{r * math.cos(turn)!r}, {r * math.sin(turn)!r}]"
            for name, r in places.items()
            for k, turn in enumerate(turns)
        )
        pairs = [(k, (k + 1) % 4) for k in range(4)]

        def ring(inner: str, outer: str) -> str:
            return ", ".join(f'["{inner}{k}", "{outer}{k}", "{outer}{j}", "{inner}{j}"]' for k, j in pairs)

        def circle(name: str) -> str:
            return f'["{name}0", "{name}1", "{name}2", "{name}3", "{name}0"]'

        return f"""
[mesh]
order = {given.order}
elements = {given.elements}

[mesh.vertices]
{vertices}

[mesh.blocks]
solid = [["q0", "q1", "q2", "q3"], {ring("q", "c")}]
fluid = [{ring("c", "m")}, {ring("m", "b")}]

[mesh.edges]
interface = [{circle("c")}]
wall = [["b0", "b1", "b2", "b3"]]
gap = [["b3", "b0"]]

[[mesh.curve]]
on = [{circle("c")}, {circle("m")}, {circle("b")}]
kind = "arc"
center = [0, 0]

[fluid]
density = {_RHO}
viscosity = {_MU_F}
initial_velocity = ["-y*({v})", "x*({v})"]

[[fluid.boundary]]
on = "wall"
type = "velocity"
x = "-y*({wall})"
y = "x*({wall})"

[[fluid.boundary]]
on = "gap"
type = "traction"
x = "-y*({stress})"
y = "x*({stress})"

[[solid]]
density = {_RHO}
youngs_modulus = {2.0 * (1.0 + _NU) * self.modulus!r}
poissons_ratio = {_NU}
model = "{given.model}"
initial_displacement = ["-y*({u[0]})", "x*({u[0]})"]
initial_velocity = ["-y*({u[1]})", "x*({u[1]})"]

[quantities.torque]
type = "moment"
on = "interface"
about = [0, 0]
{given.scene()}"""


def _tangential(f: Callable[[Array], Array], low: float, high: float) -> str:
    """The real part of f(r)/r as a polynomial of (2 r - low - high)/(high - low), to rounding."""
    z = np.polynomial.chebyshev.chebpts1(4 * _DEGREE)
    r = 0.5 * (low + high) + 0.5 * (high - low) * z
    series = np.polynomial.Chebyshev.fit(z, np.real(f(r)) / r, _DEGREE, domain=[-1, 1])
    place = f"((2*hypot(x, y) - {low + high!r})/{high - low!r})"
    text = "0"
    for c in series.convert(kind=np.polynomial.Polynomial).coef[::-1].tolist():
        text = f"({text})*z + ({c!r})"
    return text.replace("z", place)


def _around(points: Array, amplitude: Array) -> Array:
    x, y = points[..., 0], points[..., 1]
    speed = np.real(amplitude) / np.hypot(x, y)
    return np.stack([-y * speed, x * speed], axis=-1)
