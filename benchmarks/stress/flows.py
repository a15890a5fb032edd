"""Reynolds numbers up to 1e4 on meshes that are too coarse: a bounded flow with a warning, or the right error."""

from __future__ import annotations

from functools import partial

import numpy as np

from stress.case import Expectation, Numbers, Stops, StressCase, Within
from stress.runs import example, reported

__all__ = ["CASES"]

_CAVITY = """
[mesh]
order = {order}
elements = {elements}
[mesh.vertices]
a = [0, 0]
b = [1, 0]
c = [1, 1]
d = [0, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
[mesh.edges]
walls = [["d", "a", "b", "c"]]
lid = [["d", "c"]]
[fluid]
density = 1.0
viscosity = {viscosity!r}
{keys}
[[fluid.boundary]]
on = "walls"
type = "no-slip"
[[fluid.boundary]]
on = "lid"
type = "velocity"
x = "(1 - (2*x - 1)**14)**2"
y = 0
[time]
{time}
[quantities.energy]
type = "kinetic-energy"
[quantities.middle]
type = "probe"
field = "velocity"
component = "x"
at = [0.5, 0.5]
[output]
fields = false
plots = false
"""

_BOX = """
[mesh]
order = {order}
elements = {elements}
[mesh.vertices]
a = [0, 0]
b = [1, 0]
c = [1, 1]
d = [0, 1]
[mesh.blocks]
fluid = [["a", "b", "c", "d"]]
[mesh.edges]
bottom = [["a", "b"]]
right = [["b", "c"]]
top = [["d", "c"]]
left = [["a", "d"]]
[fluid]
density = 1.0
viscosity = {viscosity!r}
initial_velocity = ["{u}", "{v}"]
{keys}
[[fluid.boundary]]
on = "left"
type = "periodic"
with = "right"
[[fluid.boundary]]
on = "bottom"
type = "periodic"
with = "top"
[time]
{time}
[quantities.energy]
type = "kinetic-energy"
[output]
fields = false
plots = false
"""

_LAYER = ("tanh(30*(y - 0.25)) if y <= 0.5 else tanh(30*(0.75 - y))", "0.05*sin(2*pi*x)")  # Brown & Minion 1995
_VORTICES = ("sin(2*pi*x)*cos(2*pi*y)", "-cos(2*pi*x)*sin(2*pi*y)")


def _warned(summary: object) -> float:
    """Notes that say that the mesh is too coarse."""
    assert isinstance(summary, dict)
    return float(sum("too coarse for this Reynolds number" in note for note in summary["notes"]))


def _cavity(order: int, elements: int, viscosity: float, time: str, keys: str, quick: bool) -> Numbers:
    """A driven cavity; at most the lid's speed everywhere would be an energy of 1/2."""
    scene = _CAVITY.format(order=order, elements=elements, viscosity=viscosity, time=time, keys=keys)
    summary, series = reported(scene)
    return {
        "energy": float(series["energy"].max()),
        "warnings": _warned(summary),
        "Péclet": float(summary["resolution"].get("peclet_max", 0.0)),
        "roughness": float(summary["resolution"].get("roughness", 0.0)),
    }


def _box(flow: tuple[str, str], order: int, elements: int, keys: str, quick: bool) -> Numbers:
    """A flow between periodic sides, whose energy can only fall."""
    time = "dt = 0.01\nsteps = 200"
    scene = _BOX.format(order=order, elements=elements, viscosity=1e-4, u=flow[0], v=flow[1], keys=keys, time=time)
    summary, series = reported(scene)
    energy = series["energy"]
    return {
        "energy": float(energy.max() / energy[0]),
        "energy at the end": float(energy[-1] / energy[0]),
        "warnings": _warned(summary),
    }


def _flag(changes: list[str], quick: bool) -> Numbers:
    """A cylinder with a rigid flag at Re = 1e4 with the mean inflow 2, on few elements of low order."""
    base = ["mesh.order=2", "fluid.viscosity=0.02", "time.dt=0.005", "output.fields=false", "output.plots=false"]
    steps = 40 if quick else 200
    summary, series = reported(example("cfd3", *base, f"time.steps={steps}", *changes))
    return {
        "drag": float(np.abs(series["drag"]).max()),
        "lift": float(np.abs(series["lift"]).max()),
        "warnings": _warned(summary),
    }


_SKEW = 'convection_form = "skew-symmetric"'
_GIVEN_UP = Stops("ConvergenceError", r"(fluid|step).*(not finite|Newton's method|Refine the mesh|lower the Reynolds)")
_COARSE = (4, 4)


def _bounded(**bounds: float) -> tuple[Expectation, ...]:
    """Bounded and warned of, or given up."""
    return Within({**bounds, "warnings": (1.0, 1.0)}), _GIVEN_UP


CASES = (
    *(
        StressCase(
            f"cavity in time, order {order}, {n} × {n}{', skew-symmetric' if keys else ''}",
            "A lid set in motion at once over a cavity at Re = 1e4, on elements that cannot resolve it.",
            _bounded(energy=0.5),
            partial(_cavity, order, n, 1e-4, "dt = 0.02\nsteps = 200", keys),
            quick=order == 2,
        )
        for keys in ("", _SKEW)
        for order, n in ((2, 4), (4, 4), (6, 3))
    ),
    StressCase(
        "cavity, steady",
        "The steady flow at Re = 1e4 is sought on 4 × 4 elements of order 4.",
        _bounded(energy=0.5),
        partial(_cavity, 4, 4, 1e-4, "steady = true", ""),
        quick=True,
    ),
    StressCase(
        "cavity, steady, resolved",
        "The same at Re = 100, which is resolved: no warning.",
        (Within({"energy": 0.5, "warnings": 0.0}),),
        partial(_cavity, 6, 6, 1e-2, "steady = true", ""),
        quick=True,
    ),
    *(
        StressCase(
            f"shear layers, order {order}, {n} × {n}, skew-symmetric, {convection}",
            "The same in the form of convection that makes no energy, Newton's method and linear steps.",
            (Within({"energy": 1.0, "energy at the end": (0.3, 1.0)}),),
            partial(_box, _LAYER, order, n, f'{_SKEW}\nconvection = "{convection}"'),
            quick=order == 2 and convection == "linearised",
        )
        for order, n in ((2, 6), (4, 4), (8, 2))
        for convection in ("linearised", "extrapolated", "newton")
    ),
    *(
        StressCase(
            f"shear layers, order {order}, {n} × {n}{', ' + keys if keys else ''}",
            "Layers that roll up at Re = 1e4 between periodic sides: their energy can only fall.",
            _bounded(energy=1.01),
            partial(_box, _LAYER, order, n, keys),
            quick=order == 2 and not keys,
        )
        for order, n, keys in ((2, 6, ""), (4, 4, ""), (8, 2, ""), (4, 4, "grad_div = 0.1"))
    ),
    StressCase(
        "four vortices, order 4, 4 × 4",
        "An exact flow at Re = 1e4 that decays, and that these elements resolve: energy exp(-16 π² ν t), no warning.",
        (Within({"energy": 1.0, "energy at the end": (0.9684, 0.9694), "warnings": 0.0}),),
        partial(_box, _VORTICES, 4, 4, ""),
    ),
    StressCase(
        "four vortices, order 4, 4 × 4, skew-symmetric",
        "The same flow in the other form.",
        (Within({"energy": 1.0, "energy at the end": (0.9684, 0.9694), "warnings": 0.0}),),
        partial(_box, _VORTICES, 4, 4, _SKEW),
    ),
    *(
        StressCase(
            f"cylinder and flag{', ' + ' '.join(changes) if changes else ''}",
            "The flow of CFD3 at Re = 1e4 on elements of order 2: forces bounded by 10 times those of CFD3.",
            _bounded(drag=5e3, lift=5e3),
            partial(_flag, changes),
        )
        for changes in (
            [],
            ['fluid.convection="newton"'],
            ["time.dt=0.05", "time.steps=100"],
            ['fluid.convection_form="skew-symmetric"'],
        )
    ),
)
