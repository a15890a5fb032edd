"""A bar held at one end, with parameters that many cases vary."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Cantilever"]


@dataclass(frozen=True)
class Cantilever:
    """A bar 0 < x < length, clamped on the left, with its middle line on y = 0.

    Quantities: displacement ``u_x``, ``u_y`` of the middle of the tip, force ``f_x``, ``f_y`` of the clamp.

    Attributes
    ----------
    order, along, across : int
        Elements.
    length, thickness, density, youngs_modulus, poissons_ratio : float
    model, plane : str
    body : str
        Keys of ``[[solid]]``: forces, initial values.
    tip : str
        Condition on the tip without its name.
    time : str
        Keys of the table.
    """

    order: int = 4
    along: int = 8
    across: int = 1
    length: float = 1.0
    thickness: float = 0.1
    density: float = 1.0
    youngs_modulus: float = 1000.0
    poissons_ratio: float = 0.3
    model: str = "st-venant-kirchhoff"
    plane: str = "strain"
    body: str = ""
    tip: str = 'type = "free"'
    time: str = "steady = true"

    @property
    def stiffness(self) -> float:
        """Euler and Bernoulli's bending stiffness."""
        modulus = self.youngs_modulus / (1.0 - self.poissons_ratio**2 if self.plane == "strain" else 1.0)
        return modulus * self.thickness**3 / 12.0

    @property
    def scene(self) -> str:
        """The scene."""
        half, end = 0.5 * self.thickness, self.length
        probes = "".join(
            f'[quantities.u_{a}]\ntype = "probe"\nfield = "displacement"\ncomponent = "{a}"\nat = [{end!r}, 0]\n'
            f'[quantities.f_{a}]\ntype = "force"\non = "clamp"\ncomponent = "{a}"\n'
            for a in "xy"
        )
        return f"""
[mesh]
order = {self.order}
elements = {self.along}
[mesh.vertices]
a = [0, {-half!r}]
b = [{end!r}, {-half!r}]
c = [{end!r}, {half!r}]
d = [0, {half!r}]
[mesh.blocks]
solid = [["a", "b", "c", "d"]]
[mesh.edges]
clamp = [["a", "d"]]
tip = [["b", "c"]]
sides = [["a", "b"], ["d", "c"]]
[[mesh.count]]
on = [["a", "d"]]
elements = {self.across}
[[solid]]
density = {self.density!r}
youngs_modulus = {self.youngs_modulus!r}
poissons_ratio = {self.poissons_ratio!r}
model = "{self.model}"
plane = "{self.plane}"
{self.body}
[[solid.boundary]]
on = "clamp"
type = "fixed"
[[solid.boundary]]
on = "tip"
{self.tip}
[[solid.boundary]]
on = "sides"
type = "free"
[time]
{self.time}
{probes}"""
