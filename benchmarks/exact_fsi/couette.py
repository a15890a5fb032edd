"""A St. Venant–Kirchhoff solid sheared by a Couette flow: linear fields, finite deformation, any element."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exact_fsi.settings import Settings

Array = NDArray[np.float64]

__all__ = ["Couette"]

_END = 2.0


@dataclass(frozen=True)
class Couette:
    """Solid 0 < Y < 1 on a fixed bottom, fluid above it up to y = 2, where a wall has the speed U; all constants 1.

    Displacement (g Y, (a - 1) Y), velocity (U (y - a)/(2 - a), 0), pressure 0, with the shear stress g = U/(2 - a) and
    a = sqrt(1 - g²): then C_YY = g² + a² = 1, E has no trace and P_YY = 0, P_XY = μ g. Of two such states it is the
    less sheared one.

    Attributes
    ----------
    speed : float
        U, below 0.52 for such a state to exist.
    """

    speed: float = 0.5

    quantities = ("force", "lift")

    @property
    def height(self) -> float:
        """The height a of the sheared solid."""
        a = 1.0
        for _ in range(2000):
            a = math.sqrt(1.0 - (self.speed / (_END - a)) ** 2)
        return a

    @property
    def shear(self) -> float:
        """The shear g."""
        return self.speed / (_END - self.height)

    def displacement_at(self, points: Array, time: float) -> Array:
        """Of the solid at reference points (..., 2)."""
        return points[..., 1:] * np.array([self.shear, self.height - 1.0])

    def velocity_at(self, points: Array, time: float) -> Array:
        """Of the fluid at points (..., 2)."""
        u = self.shear * (points[..., 1] - self.height)
        return np.stack([u, np.zeros_like(u)], axis=-1)

    def load_at(self, time: float) -> Array:
        """Force of the fluid on the solid, shape (2,)."""
        return np.array([self.shear, 0.0])

    def scene(self, given: Settings, *, distorted: bool = True, steady: bool = False, near: float = 1.0) -> str:
        """The scene, started from the exact state.

        Parameters
        ----------
        given : Settings
        distorted : bool
            Five blocks a body, round a skewed one in the middle, some of their edges arcs; else one, a rectangle.
        steady : bool
            Whether the steady state is sought instead of time steps made.
        near : float
            Factor of the initial displacement.
        """
        g, a = self.shear, self.height
        v = f"{g!r}*(y - {a!r})"
        lean = f"{g * g / math.hypot(g, _END - a)!r}"  # the shear stress times n_y, on straight sides that lean
        time = given.scene()
        if steady:
            start, stop = time.index("[time]"), time.index("[coupling]")
            coupling = time[stop:].replace(f'geometry = "{given.geometry}"\n', "")
            time = time[:start] + "[time]\nsteady = true\n\n" + coupling
        return f"""
[mesh]
order = {given.order}
elements = {given.elements}
{_FOUR if distorted else _ONE}
[fluid]
density = 1.0
viscosity = 1.0
initial_velocity = ["{v}", "0"]

[[fluid.boundary]]
on = "top"
type = "velocity"
x = {self.speed!r}
y = 0

[[fluid.boundary]]
on = "left"
type = "velocity"
x = "{v}"
y = 0

[[fluid.boundary]]
on = "right"
type = "velocity"
y = 0
traction_x = {lean}

[[solid]]
density = 1.0
youngs_modulus = 2.6
poissons_ratio = 0.3
initial_displacement = ["{near * g!r}*y", "{near * (a - 1.0)!r}*y"]

[[solid.boundary]]
on = "bottom"
type = "fixed"

[[solid.boundary]]
on = "sides"
type = "displacement"
x = "{g!r}*y"
y = "{a - 1.0!r}*y"

[quantities.force]
type = "force"
on = "interface"
component = "x"

[quantities.lift]
type = "force"
on = "interface"
component = "y"
{time}"""


_ONE = """
[mesh.vertices]
s0 = [0, 0]
s1 = [1, 0]
i0 = [0, 1]
i1 = [1, 1]
t0 = [0, 2]
t1 = [1, 2]

[mesh.blocks]
solid = [["s0", "s1", "i1", "i0"]]
fluid = [["i0", "i1", "t1", "t0"]]

[mesh.edges]
bottom = [["s0", "s1"]]
sides = [["s0", "i0"], ["s1", "i1"]]
interface = [["i0", "i1"]]
left = [["i0", "t0"]]
right = [["i1", "t1"]]
top = [["t0", "t1"]]
"""

# Sides of one edge each, so that they stay straight: the vertices inside are the corners of a block in the middle.
_FOUR = """
[mesh.vertices]
s0 = [0, 0]
s1 = [1, 0]
i0 = [0, 1]
i1 = [1, 1]
t0 = [0, 2]
t1 = [1, 2]
j0 = [0.3, 0.28]
j1 = [0.72, 0.35]
j2 = [0.66, 0.7]
j3 = [0.25, 0.62]
k0 = [0.35, 1.3]
k1 = [0.7, 1.25]
k2 = [0.75, 1.68]
k3 = [0.28, 1.74]

[mesh.blocks]
solid = [["j0", "j1", "j2", "j3"], ["s0", "s1", "j1", "j0"], ["s1", "i1", "j2", "j1"], ["i1", "i0", "j3", "j2"],
         ["i0", "s0", "j0", "j3"]]
fluid = [["k0", "k1", "k2", "k3"], ["i0", "i1", "k1", "k0"], ["i1", "t1", "k2", "k1"], ["t1", "t0", "k3", "k2"],
         ["t0", "i0", "k0", "k3"]]

[mesh.edges]
bottom = [["s0", "s1"]]
sides = [["s0", "i0"], ["s1", "i1"]]
interface = [["i0", "i1"]]
left = [["i0", "t0"]]
right = [["i1", "t1"]]
top = [["t0", "t1"]]

[[mesh.curve]]
on = [["j0", "j1"], ["j2", "j3"], ["k1", "k2"], ["k3", "k0"], ["s0", "j0"], ["i1", "k1"]]
kind = "arc"
angle = 0.5
"""
