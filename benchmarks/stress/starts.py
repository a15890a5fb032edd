"""Impulsive starts: a flow, a load or both at once; oscillations from step to step do not grow."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from stress.cantilever import Cantilever
from stress.case import Numbers, StressCase, Within
from stress.channel import Channel
from stress.flap import Flap
from stress.runs import Run, difference, example, marched, teeth

Array = NDArray[np.float64]

__all__ = ["CASES"]


def _teeth(prefix: str, values: Array) -> Numbers:
    """How large teeth of the second half are, beside those of the first and beside the values."""
    first, second = teeth(values)
    return {
        f"{prefix} teeth": second / float(np.abs(values[len(values) // 2 :]).max()),
        f"{prefix} growth": second / first,
    }


def _channel(dt: float, quick: bool) -> Numbers:
    """Flow through a channel from rest at once; its drag tends to that of Poiseuille flow without teeth."""
    steps = 60
    found = marched(Channel(3, 4, 4, time=f"dt = {dt!r}\nsteps = {steps}").scene)
    return dict(_teeth("drag", found.series["drag"][1:]))


def _cylinder(quick: bool) -> Numbers:
    """The flow of DFG 2D-1's kind past a cylinder at once."""
    steps = 30 if quick else 80
    changes = ["mesh.order=3", "time.dt=0.01", f"time.steps={steps}", "output.fields=false", "output.plots=false"]
    found = marched(example("cfd3", *changes, "fluid.viscosity=1.0", 'fluid.boundary[0].x="4*1.5*y*(0.41-y)/0.1681"'))
    return {**_teeth("drag", found.series["drag"][3:]), "drag": float(found.series["drag"][-1])}


def _loaded(scheme: str, model: str, quick: bool) -> Numbers:
    """A bar pulled at its end at once: twice the static stretch at most, and the energy is that of the load."""
    pull = 0.1
    bar = Cantilever(
        3,
        10,
        1,
        youngs_modulus=100.0,
        poissons_ratio=0.0,
        model=model,
        tip=f'type = "traction"\nx = {pull!r}',
        time=f"dt = 0.01\nsteps = 200\n{scheme}",
    )
    found = marched(bar.scene)
    stretch = pull / 100.0
    work = pull * 0.1 * found.series["u_x"]
    energy = found.series["strain"] + found.series["kinetic"]
    return {
        "overshoot": float(found.series["u_x"].max()) / stretch,
        "energy - work": float((energy - work).max() / (pull * 0.1 * 2.0 * stretch)),
        "growth": float(energy[100:].max() / energy[:100].max()),
    }


def _bent(scheme: str, quick: bool) -> Numbers:
    """A bar bent far by its weight at once: it swings about its static deflection and never gains energy."""
    bar = Cantilever(3, 6, 1, body="gravity = [0, -0.3]", youngs_modulus=500.0)
    static = abs(float(marched(bar.scene).series["u_y"][0]))
    found = marched(replace(bar, time=f"dt = 0.05\nsteps = {100 if quick else 400}\n{scheme}").scene)
    u = np.abs(found.series["u_y"])
    half = len(u) // 2
    return {"overshoot": float(u.max()) / static, "growth": float(u[half:].max() / u[:half].max())}


@cache
def _flap(dt: float, geometry: str, scheme: str, condensed: bool, density: float) -> Run:
    time = f"dt = {dt!r}\nend = 0.4\n{scheme}"
    coupling = f'geometry = "{geometry}"\ncondensed = {str(condensed).lower()}\ntolerance = 1e-7'
    return marched(Flap(3, density=density, time=time, coupling=coupling).scene)


def _coupled(geometry: str, scheme: str, condensed: bool, density: float, quick: bool) -> Numbers:
    """A flow at once against a flap."""
    found = _flap(0.01, geometry, scheme, condensed, density)
    force = found.at_whole_steps("f_x")[3:]
    return {"iterations": found.mean, **_teeth("force", force), "u_x": float(np.abs(found.series["u_x"]).max())}


def _converging(geometry: str, density: float, quick: bool) -> Numbers:
    """The tip at t = 0.4 with steps of 0.01 and 0.005."""
    tips = [float(_flap(dt, geometry, "", True, density).series["u_x"][-1]) for dt in (0.01, 0.005)]
    return {"difference": abs(tips[0] / tips[1] - 1.0)}


def _ramped(density: float, quick: bool) -> Numbers:
    """A flow at once against one that sets in within 1/200, in the same small steps, from t = 0.05 to 0.2."""
    time = "dt = 0.00125\nend = 0.2"
    sudden, steep = (
        marched(Flap(2, density=density, inflow=inflow, time=time).scene) for inflow in ("1", "min(t/0.005, 1)")
    )
    late = steep.times[steep.whole] > 0.05
    return {
        name: difference(sudden.at_whole_steps(name)[late], steep.at_whole_steps(name)[late]) for name in ("u_x", "f_x")
    }


def _pulse(quick: bool) -> Numbers:
    """The pressure pulse, which begins at once and ends at once, at half the step: the walls do the same."""
    end = "time.end=0.003"
    coarse, fine = (marched(example("pressure_pulse", "mesh.order=3", end, f"time.dt={dt}")) for dt in (1e-4, 5e-5))
    names = ("wall_1", "outflow")
    found = {
        f"{name} differs": difference(fine.at_whole_steps(name)[1::2], coarse.at_whole_steps(name))
        for name in names[:1]
    }
    return {**found, **_teeth("pressure", coarse.at_whole_steps("pressure")[2:])}


_SCHEMES = {
    "BDF2": 'solid = "bdf2"',
    "generalised-α": 'solid = "generalised-alpha"',
    "energy-momentum": 'solid = "energy-momentum"',
}

CASES = (
    *(
        StressCase(
            f"flow at once, dt = {dt:g}",
            "A channel's full inflow from rest: the drag has no teeth that grow.",
            (Within({"drag teeth": 1e-3, "drag growth": 1.0}),),
            partial(_channel, dt),
            quick=True,
        )
        for dt in (1e-4, 1e-2, 1.0, 100.0)
    ),
    StressCase(
        "flow past a cylinder at once",
        "The inflow of CFD2 against a cylinder and a flag from rest.",
        (Within({"drag teeth": 1e-3, "drag growth": 1.0, "drag": (50.0, 500.0)}),),
        _cylinder,
    ),
    *(
        StressCase(
            f"solid pulled at once, {model}, {name}",
            "Waves run along a bar; it is stretched twice as far as at rest and no further.",
            (Within({"overshoot": (1.8, 2.1), "energy - work": 0.02, "growth": 1.02}),),
            partial(_loaded, scheme, model),
            quick=model == "linear",
        )
        for model in ("linear", "st-venant-kirchhoff", "neo-hooke")
        for name, scheme in _SCHEMES.items()
    ),
    *(
        StressCase(
            f"solid bent by its weight at once, {name}",
            "A slender bar swings far; it never swings further than at first.",
            (Within({"overshoot": (1.5, 2.2), "growth": 1.02}),),
            partial(_bent, scheme),
            quick=name == "BDF2",
        )
        for name, scheme in _SCHEMES.items()
    ),
    *(
        StressCase(
            f"coupled at once, {geometry}, {name}, {'condensed' if condensed else 'plain'}, density {density:g}",
            "The full inflow from rest against an elastic flap: the force has no teeth that grow.",
            (
                Within(
                    {
                        "iterations": 8.0 if condensed else 25.0,
                        "force growth": 1.0,
                        "u_x": (1e-3, 0.6),
                    }
                ),
            ),
            partial(_coupled, geometry, scheme, condensed, density),
            quick=(geometry, name, condensed, density) == ("extrapolated", "BDF2", True, 1.0),
        )
        for density in (1.0, 0.01)
        for geometry in ("extrapolated", "implicit")
        for name, scheme in _SCHEMES.items()
        for condensed in ((True, False) if name == "BDF2" and density == 1.0 else (True,))
    ),
    *(
        StressCase(
            f"coupled at once, {geometry}, density {density:g}: smaller steps",
            "The deflection some time after an impulsive start hardly depends on the step.",
            (Within({"difference": 0.02}),),
            partial(_converging, geometry, density),
        )
        for geometry in ("extrapolated", "implicit")
        for density in (1.0, 0.01)
    ),
    *(
        StressCase(
            f"coupled at once, density {density:g}: a steep ramp",
            "An impulsive start moves the flap as an inflow does that sets in within four steps.",
            (Within({"u_x": 0.05}),),
            partial(_ramped, density),
        )
        for density in (10.0, 0.01)
    ),
    StressCase(
        "pressure at once between elastic walls",
        "The pulse with steps of 1e-4 and half of that.",
        (Within({"wall_1 differs": 0.1, "pressure teeth": 0.02}),),
        _pulse,
    ),
)
