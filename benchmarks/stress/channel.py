"""Poiseuille flow through a channel, with parameters that many cases vary."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Channel"]


@dataclass(frozen=True)
class Channel:
    """Poiseuille flow through a channel 0 < x < length, 0 < y < 1, u = 4 y (1 - y), p = 8 μ (length - x).

    Attributes
    ----------
    order, along, across : int
        Elements.
    length, viscosity : float
    gradings : str
        Tables ``[[mesh.grading]]``; the edges are "bottom", "right", "top" and "left", which runs upwards.
    inflow, initial : str
        Velocity along x, at the inlet and at the start.
    time : str
    """

    order: int = 2
    along: int = 2
    across: int = 2
    length: float = 2.0
    viscosity: float = 0.1
    gradings: str = ""
    inflow: str = "4*y*(1 - y)"
    initial: str = "0"
    time: str = "steady = true"

    @property
    def scene(self) -> str:
        """The scene."""
        return f"""
[mesh]
order = {self.order}
elements = {self.along}
[mesh.vertices]
a = [0, 0]
b = [{self.length!r}, 0]
c = [{self.length!r}, 1]
d = [0, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
[mesh.edges]
bottom = [["a", "b"]]
right = [["b", "c"]]
top = [["d", "c"]]
left = [["a", "d"]]
[[mesh.count]]
on = "left"
elements = {self.across}
{self.gradings}
[fluid]
density = 1.0
viscosity = {self.viscosity!r}
initial_velocity = ["{self.initial}", "0"]
[[fluid.boundary]]
on = ["bottom", "top"]
type = "no-slip"
[[fluid.boundary]]
on = "left"
type = "velocity"
x = "{self.inflow}"
y = 0
[[fluid.boundary]]
on = "right"
type = "do-nothing"
[time]
{self.time}
[quantities.drag]
type = "force"
on = ["bottom", "top"]
component = "x"
[quantities.energy]
type = "kinetic-energy"
[quantities.inlet_pressure]
type = "mean-pressure"
on = "left"
"""
