"""A flap in a channel, with parameters that many cases vary."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Flap"]

# a2 ─── b2 ─ c2 ─── d2
# │      │    │      │
# a1 ─── b1 ─ c1 ─── d1      the flap is b0 c0 c1 b1
# │      │flap│      │
# a0 ─── b0 ─ c0 ─── d0


@dataclass(frozen=True)
class Flap:
    """A flap on the bottom of a channel of length 2.5 and height 1 in a fluid of density 1.

    Quantities: displacement ``u_x``, ``u_y`` of the tip, force ``f_x``, ``f_y`` of the fluid on the flap.

    Attributes
    ----------
    order, elements : int
        The flap has so many elements along and one across; the fluid so many along every block edge.
    height, thickness : float
    density : float
        Of the solid: the density ratio.
    youngs_modulus, poissons_ratio, viscosity : float
    inflow : str
        Largest velocity at the inlet.
    model : str
    time, coupling : str
        Keys of these tables.
    """

    order: int = 2
    elements: int = 2
    height: float = 0.5
    thickness: float = 0.1
    density: float = 1.0
    youngs_modulus: float = 600.0
    poissons_ratio: float = 0.3
    viscosity: float = 0.05
    inflow: str = "1"
    model: str = "st-venant-kirchhoff"
    time: str = "steady = true"
    coupling: str = ""

    @property
    def scene(self) -> str:
        """The scene."""
        h, right = self.height, 1.0 + self.thickness
        probes = "".join(
            f'[quantities.u_{a}]\ntype = "probe"\nfield = "displacement"\ncomponent = "{a}"\nat = "b1"\n'
            f'[quantities.f_{a}]\ntype = "force"\non = "flap"\ncomponent = "{a}"\n'
            for a in "xy"
        )
        return f"""
[mesh]
order = {self.order}
elements = {self.elements}
[mesh.vertices]
a0 = [0, 0]
b0 = [1, 0]
c0 = [{right!r}, 0]
d0 = [2.5, 0]
a1 = [0, {h!r}]
b1 = [1, {h!r}]
c1 = [{right!r}, {h!r}]
d1 = [2.5, {h!r}]
a2 = [0, 1]
b2 = [1, 1]
c2 = [{right!r}, 1]
d2 = [2.5, 1]
[mesh.blocks]
fluid = [["a0", "b0", "b1", "a1"], ["c0", "d0", "d1", "c1"], ["a1", "b1", "b2", "a2"], ["b1", "c1", "c2", "b2"],
         ["c1", "d1", "d2", "c2"]]
solid = [["b0", "c0", "c1", "b1"]]
[mesh.edges]
inlet = [["a0", "a1", "a2"]]
outlet = [["d0", "d1", "d2"]]
walls = [["a0", "b0"], ["c0", "d0"], ["a2", "b2", "c2", "d2"]]
flap = [["b0", "b1", "c1", "c0"]]
root = [["b0", "c0"]]
[[mesh.count]]
on = [["b0", "c0"]]
elements = 1
[fluid]
density = 1.0
viscosity = {self.viscosity!r}
[[fluid.boundary]]
on = "inlet"
type = "velocity"
x = "4*y*(1 - y)*({self.inflow})"
y = 0
[[fluid.boundary]]
on = "walls"
type = "no-slip"
[[fluid.boundary]]
on = "outlet"
type = "do-nothing"
[[solid]]
density = {self.density!r}
youngs_modulus = {self.youngs_modulus!r}
poissons_ratio = {self.poissons_ratio!r}
model = "{self.model}"
[[solid.boundary]]
on = "root"
type = "fixed"
[time]
{self.time}
[coupling]
{self.coupling}
{probes}"""
