"""A flap on the bottom of a channel, bent far by a flow that sets in smoothly: no exact solution, but all terms."""

from __future__ import annotations

from exact_fsi.settings import Settings

__all__ = ["flap"]


def flap(given: Settings) -> str:
    """The scene, from rest; the inflow grows with t⁴ at first and is full at t = 1.

    Quantities: displacement ``u_x``, ``u_y`` of the tip, force ``f_x``, ``f_y`` of the fluid on the flap.

    Parameters
    ----------
    given : Settings
    """
    probes = "".join(
        f"""
[quantities.u_{a}]
type = "probe"
field = "displacement"
component = "{a}"
at = "b1"

[quantities.f_{a}]
type = "force"
on = "flap"
component = "{a}"
"""
        for a in "xy"
    )
    return f"""
[mesh]
order = {given.order}
elements = {given.elements}

[mesh.vertices]
a0 = [0, 0]
b0 = [1, 0]
c0 = [1.1, 0]
d0 = [2.5, 0]
a1 = [0, 0.5]
b1 = [1, 0.5]
c1 = [1.1, 0.5]
d1 = [2.5, 0.5]
a2 = [0, 1]
b2 = [1, 1]
c2 = [1.1, 1]
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
on = [["a0", "b0"], ["c0", "d0"], ["a0", "a1", "a2"]]
elements = {2 * given.elements}

[fluid]
density = 1.0
viscosity = 0.05

[[fluid.boundary]]
on = "inlet"
type = "velocity"
x = "4*y*(1 - y)*(sin(pi*t/2)**4 if t < 1 else 1)"
y = 0

[[fluid.boundary]]
on = "walls"
type = "no-slip"

[[fluid.boundary]]
on = "outlet"
type = "do-nothing"

[[solid]]
density = 2.0
youngs_modulus = 600.0
poissons_ratio = 0.3
model = "{given.model}"

[[solid.boundary]]
on = "root"
type = "fixed"
{probes}{given.scene()}"""
