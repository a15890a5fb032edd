"""Solids that are nearly incompressible, ν = 0.4999: do elements lock, and does Newton's method converge?"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np

from stress.cantilever import Cantilever
from stress.case import Numbers, StressCase, Within
from stress.flap import Flap
from stress.runs import marched, reported

__all__ = ["CASES"]

_NU = 0.4999
_COOK = """
[mesh]
order = {order}
elements = {elements}
[mesh.vertices]
a = [0, 0]
b = [48, 44]
c = [48, 60]
d = [0, 44]
[mesh.blocks]
solid = [["a", "b", "c", "d"]]
[mesh.edges]
left = [["a", "d"]]
right = [["b", "c"]]
rest = [["a", "b"], ["d", "c"]]
[[solid]]
density = 1
youngs_modulus = 250
poissons_ratio = {nu}
model = "linear"
[[solid.boundary]]
on = "left"
type = "fixed"
[[solid.boundary]]
on = "rest"
type = "free"
[[solid.boundary]]
on = "right"
type = "traction"
y = "100/16"
[time]
steady = true
[quantities.top]
type = "probe"
field = "displacement"
component = "y"
at = "c"
"""

_RING = """
[mesh]
order = {order}
elements = {elements}
[mesh.vertices]
i0 = [1, 0]
i1 = [0, 1]
o0 = [2, 0]
o1 = [0, 2]
[mesh.blocks]
solid = [["i0", "o0", "o1", "i1"]]
[mesh.edges]
inner = [["i0", "i1"]]
outer = [["o0", "o1"]]
cuts = [["i0", "o0"], ["i1", "o1"]]
[[mesh.curve]]
on = ["inner", "outer"]
kind = "arc"
center = [0, 0]
[[solid]]
density = 1
youngs_modulus = 1
poissons_ratio = {nu}
model = "linear"
[[solid.boundary]]
on = "inner"
type = "pressure"
value = 1
[[solid.boundary]]
on = "outer"
type = "free"
[[solid.boundary]]
on = "cuts"
type = "symmetry"
[time]
steady = true
[quantities.inside]
type = "probe"
field = "displacement"
component = "x"
at = "i0"
"""


def _cook(order: int, elements: int, quick: bool) -> Numbers:
    """Cook's membrane against the published 7.769, and whether its user is warned."""
    summary, series = reported(_COOK.format(order=order, elements=elements, nu=_NU))
    return {"error": abs(float(series["top"][0]) / 7.769 - 1.0), "notes": len(summary["notes"])}


def _ring(order: int, elements: int, quick: bool) -> Numbers:
    """A ring under pressure from inside, against Lamé's solution."""
    found = float(marched(_RING.format(order=order, elements=elements, nu=_NU)).series["inside"][0])
    exact = (1.0 + _NU) / 3.0 * ((1.0 - 2.0 * _NU) + 4.0)
    return {"error": abs(found / exact - 1.0)}


@cache
def _bent(order: int, along: int, model: str) -> tuple[float, float, int]:
    """Tip of a bar that bends by more than a half of its length, reaction of the clamp, Newton iterations."""
    bar = Cantilever(order, along, 2, poissons_ratio=_NU, model=model, tip='type = "traction"\ny = 4.0')
    found = marched(bar.scene)
    counts = found.problem.counts["solid"]
    return float(found.series["u_y"][0]), float(found.series["f_y"][0]), counts.iterations


def _bending(order: int, along: int, model: str, quick: bool) -> Numbers:
    tip, reaction, iterations = _bent(order, along, model)
    finest = _bent(8, 10, model)[0]
    return {
        "error": abs(tip / finest - 1.0),
        "reaction error": abs(reaction / (4.0 * 0.1) - 1.0),
        "iterations": iterations,
        "tip": tip,
    }


def _squeezed(quick: bool) -> Numbers:
    """A block pressed to four fifths of its height between rough plates: how far it bulges, and the force, by order."""
    bulges, forces = [], []
    for order in (3, 5):
        bar = Cantilever(order, 4, 4, thickness=1.0, poissons_ratio=_NU, model="neo-hooke")
        found = marched(replace(bar, tip='type = "displacement"\nx = -0.2\ny = 0').scene)
        assert found.problem.solid is not None
        assert found.last.state.solid is not None
        middle = np.argmin(np.hypot(*(found.problem.solid.mesh.points - 0.5).T))
        bulges.append(float(found.last.state.solid.displacement[middle, 1]))
        forces.append(float(found.series["f_x"][0]))
    return {
        "bulge": bulges[1],
        "difference of bulge": abs(bulges[0] / bulges[1] - 1.0),
        "difference of force": abs(forces[0] / forces[1] - 1.0),
    }


def _coupled(quick: bool) -> Numbers:
    """A rubber flap in a flow, ν = 0.4999 against 0.49, which differ little."""
    time = "dt = 0.05\nsteps = 20"
    flap = Flap(4, 3, poissons_ratio=_NU, model="neo-hooke", inflow="sin(pi*t/2)**2 if t < 1 else 1", time=time)
    rubber, softer = marched(flap.scene), marched(replace(flap, poissons_ratio=0.49).scene)
    off = max(abs(rubber.series[name][-1] / softer.series[name][-1] - 1.0) for name in ("u_x", "f_x"))
    return {"iterations": rubber.mean, "difference": float(off)}


def _swinging(model: str, scheme: str, quick: bool) -> Numbers:
    """A bar let go: the pressure waves of a nearly incompressible solid do not grow, no step is divided."""
    bar = Cantilever(3, 6, 1, poissons_ratio=_NU, model=model, body='initial_velocity = ["0", "2*x**2"]')
    time = f'dt = 0.02\nsteps = {20 if quick else 100}\nsolid = "{scheme}"\nhalvings = 0'
    found = marched(replace(bar, time=time).scene)
    energy = found.series["strain"] + found.series["kinetic"]
    drift = energy / energy[0] - 1.0
    return {
        "energy gained": float(drift.max()),
        "energy lost": float(-drift.min()),
        "tip": float(np.abs(found.series["u_y"]).max()),
        "iterations": found.problem.counts["solid"].iterations / len(found.times),
    }


_COOK_BOUNDS = {2: (16, 0.03), 3: (8, 0.02), 4: (8, 0.01), 6: (4, 0.01), 8: (4, 0.01)}
_RING_BOUNDS = {2: (6, 2e-2), 3: (6, 1e-3), 4: (4, 1e-3), 6: (4, 1e-5), 8: (4, 1e-7), 12: (2, 1e-7)}
_BENT_BOUNDS = {2: (10, 0.05), 3: (10, 0.02), 4: (10, 0.01), 6: (10, 0.01)}

CASES = (
    *(
        StressCase(
            f"Cook's membrane, order {order}",
            "The classical test of locking at ν = 0.4999 in plane strain.",
            (Within({"error": most}),),
            partial(_cook, order, elements),
            quick=order == 8,
        )
        for order, (elements, most) in _COOK_BOUNDS.items()
    ),
    StressCase(
        "Cook's membrane, order 1",
        "Linear elements are known to lock: the deflection must be right, or the run must say so in its notes.",
        (Within({"error": 0.05}), Within({"error": 1.0, "notes": (1, np.inf)})),
        partial(_cook, 1, 16),
        quick=True,
    ),
    *(
        StressCase(
            f"ring under pressure, order {order}",
            "Curved elements at ν = 0.4999 against Lamé's exact solution.",
            (Within({"error": most}),),
            partial(_ring, order, elements),
            quick=order < 12,
        )
        for order, (elements, most) in _RING_BOUNDS.items()
    ),
    *(
        StressCase(
            f"bar bent far, {model}, order {order}",
            "A bar with ν = 0.4999 under a dead load on its tip, static in one step, against order 8.",
            (Within({"error": most, "reaction error": 1e-8, "iterations": 100, "tip": (0.3, 1.0)}),),
            partial(_bending, order, along, model),
        )
        for model in ("neo-hooke", "st-venant-kirchhoff")
        for order, (along, most) in _BENT_BOUNDS.items()
    ),
    StressCase(
        "block squeezed between rough plates",
        "A neo-Hookean block at 80 % of its height bulges; the corners are singular.",
        (Within({"bulge": (0.05, 0.2), "difference of bulge": 0.01, "difference of force": 0.05}),),
        _squeezed,
    ),
    StressCase(
        "rubber flap in a flow",
        "Coupled steps of a solid with ν = 0.4999 take no more iterations, and ν = 0.49 gives nearly the same.",
        (Within({"iterations": 3.5, "difference": 0.03}),),
        _coupled,
    ),
    *(
        StressCase(
            f"rubber bar swinging, {model}, {scheme}",
            "A bar with ν = 0.4999 swings: its energy does not grow, and stays under the scheme that keeps it.",
            (
                Within(
                    {
                        "energy gained": 1e-7 if scheme == "energy-momentum" else 1e-2,
                        "energy lost": 1e-7 if scheme == "energy-momentum" else 0.2,
                        "tip": (0.01, 1.0),
                        "iterations": 25.0,
                    }
                ),
            ),
            partial(_swinging, model, scheme),
            quick=model == "st-venant-kirchhoff",
        )
        for model in ("st-venant-kirchhoff", "neo-hooke")
        for scheme in ("bdf2", "generalised-alpha", "energy-momentum")
    ),
)
