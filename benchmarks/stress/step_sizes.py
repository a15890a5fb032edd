"""Steps that are very small or very large: what comes out tends to the limit, the state itself or the steady one."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np

from exact_fsi.couette import Couette
from exact_fsi.errors import errors_at, load_errors
from exact_fsi.settings import Settings
from exact_fsi.study import marched as exactly_marched
from stress.cantilever import Cantilever
from stress.case import Numbers, Stops, StressCase, Within
from stress.channel import Channel
from stress.flap import Flap
from stress.runs import Run, difference, marched

__all__ = ["CASES"]

_TINY = 1e-8  # of the natural time 1 of all scenes here
_HUGE = 1e8
_QUANTITIES = ("u_x", "u_y", "f_x", "f_y")


def _one_step(dt: float, steps: int = 1) -> str:
    return f"dt = {dt!r}\nsteps = {steps}"


def _huge_fluid(quick: bool) -> Numbers:
    """A rigid step's flow at Re = 20 in one step from rest, against the steady one."""
    flap = Flap(4, youngs_modulus=1e9, inflow="1")
    fluid = _without_solid(flap.scene)
    steady, one = marched(fluid), marched(fluid.replace("steady = true", _one_step(_HUGE)))
    return {name: difference(one.series[name], steady.series[name]) for name in ("f_x", "f_y")}


def _without_solid(scene: str) -> str:
    """The channel with a rigid flap."""
    start, end = scene.index("[[solid]]"), scene.index("[time]")
    scene = scene[:start] + scene[end:].replace("[coupling]\n", "")
    scene = scene.replace('solid = [["b0", "c0", "c1", "b1"]]', "").replace('root = [["b0", "c0"]]', "")
    scene = scene.replace('[[mesh.count]]\non = [["b0", "c0"]]\nelements = 1\n', "")
    for axis in "xy":
        probe = scene.index(f"[quantities.u_{axis}]")
        scene = scene[:probe] + scene[scene.index(f"[quantities.f_{axis}]") :]
    return scene.replace('on = "walls"\ntype', 'on = ["walls", "flap"]\ntype')


def _huge_solid(scheme: str, quick: bool) -> Numbers:
    """A bar that bends far under its weight in one step, against the static one."""
    bar = Cantilever(4, 4, body="gravity = [0, -0.3]", youngs_modulus=500.0)
    static = marched(bar.scene)
    one = marched(replace(bar, time=f"{_one_step(_HUGE)}\n{scheme}").scene)
    return {name: difference(one.series[name], static.series[name]) for name in ("u_x", "u_y", "f_y")}


@cache
def _steady_flap(young: float) -> Run:
    return marched(Flap(3, youngs_modulus=young).scene)


def _huge_coupled(geometry: str, young: float, dt: float, steps: int, quick: bool) -> Numbers:
    """A flap bent by a flow that is there at once, in few huge steps, against the steady state."""
    coupling = f'geometry = "{geometry}"'
    found = marched(Flap(3, youngs_modulus=young, time=_one_step(dt, steps), coupling=coupling).scene)
    steady = _steady_flap(young)
    return {name: abs(found.series[name][-1] / steady.series[name][0] - 1.0) for name in _QUANTITIES}


def _tiny_fluid(quick: bool) -> Numbers:
    """Poiseuille flow that is left alone."""
    exact = "4*y*(1 - y)"
    channel = Channel(3, 3, 3, initial=exact)
    rest, found = marched(channel.scene), marched(replace(channel, time=_one_step(_TINY, 50)).scene)
    return {name: difference(found.series[name], rest.series[name]) for name in ("drag", "inlet_pressure", "energy")}


def _tiny_impulse(quick: bool) -> Numbers:
    """Flow at once in tiny steps: the impulse of the pressure is that of an ideal fluid, ρ U length, once."""
    channel = Channel(2, 2, 2, inflow="1", viscosity=1e-3)
    slip = channel.scene.replace('type = "no-slip"', 'type = "slip"')
    found = marched(slip.replace("steady = true", _one_step(_TINY, 30)))
    impulse = np.cumsum(found.series["inlet_pressure"]) * _TINY
    late = np.abs(found.series["inlet_pressure"][5:]).max()
    return {
        "impulse": float(impulse[-1]) / 2.0,
        "pressure later": float(late),
        "energy": float(found.series["energy"][-1]),
    }


def _tiny_solid(scheme: str, quick: bool) -> Numbers:
    """A free fall in tiny steps: d = g t²/2, and what was at rest under its weight stays there."""
    bar = Cantilever(3, 3, body="gravity = [0, -1]", time=f"{_one_step(_TINY, 100)}\n{scheme}")
    free = bar.scene.replace('type = "fixed"', 'type = "free"')
    found = marched(free)
    fall = -0.5 * found.times[-1] ** 2
    return {"fall": float(found.series["u_y"][-1] / fall), "strain": float(found.series["strain"].max())}


def _tiny_coupled(dt: float, geometry: str, scheme: str, quick: bool) -> Numbers:
    """The exact steady Couette flow over a sheared solid in tiny steps."""
    solution = Couette(0.5)
    settings = Settings(3, dt=dt, steps=10 if quick else 50, geometry=geometry, scheme=scheme)
    problem, records = exactly_marched(solution.scene(settings))
    found = errors_at(solution, problem, records[-1])
    load = float(np.abs(load_errors(solution, problem, records)).max())
    assert records[-1].state.fluid is not None
    pressure = float(np.abs(records[-1].state.fluid.pressure).max())
    return {"displacement": found.displacement, "velocity": found.velocity, "load": load, "pressure": pressure}


def _tiny_start(quick: bool) -> Numbers:
    """A flap and a flow from rest, inflow growing from 0, in tiny steps: nothing happens, and no force runs away."""
    found = marched(replace(Flap(3, inflow="t"), time=_one_step(_TINY, 20)).scene)
    forces = np.hypot(found.series["f_x"], found.series["f_y"])
    moved = np.hypot(found.series["u_x"], found.series["u_y"]).max()
    return {"iterations": found.mean, "growth": float(forces[-1] / forces[1]), "moved": float(moved)}


_BDF, _ALPHA = 'solid = "bdf2"', 'solid = "generalised-alpha"\nspectral_radius = 0.0'
_SAME = dict.fromkeys(_QUANTITIES, 1e-5)
_REFUSED = Stops("ConvergenceError", "the interface ends .* from where it was predicted|Use smaller steps")

CASES = (
    StressCase(
        "one huge step: fluid",
        "One implicit step of 1e8 natural times from rest is the steady flow.",
        (Within({"f_x": 1e-6, "f_y": 1e-6}),),
        _huge_fluid,
        quick=True,
    ),
    *(
        StressCase(
            f"one huge step: solid, {scheme.split(chr(34))[1]}",
            "One implicit step of 1e8 natural times from rest is static equilibrium at a large deflection.",
            (Within({"u_x": 1e-6, "u_y": 1e-6, "f_y": 1e-6}),),
            partial(_huge_solid, scheme),
            quick=True,
        )
        for scheme in (_BDF, _ALPHA)
    ),
    *(
        StressCase(
            f"{name}: coupled, {geometry}, {kind} flap",
            text,
            (Within(_SAME), *((_REFUSED,) if may_be_refused else ())),
            partial(_huge_coupled, geometry, young, dt, steps),
            quick=geometry == "implicit" and steps == 1,
        )
        for name, dt, steps, text in (
            ("one huge step", _HUGE, 1, "One step of 1e8 natural times from rest: the steady state, or it is refused."),
            ("large steps", 50.0, 12, "Twelve steps of 50 natural times from rest: the steady state, or refused."),
        )
        for kind, young in (("soft", 600.0), ("stiff", 6e4))
        for geometry in ("implicit", "extrapolated")
        # The mesh of an extrapolated step stands where the interface was, and that of a soft flap may not follow.
        for may_be_refused in (geometry == "extrapolated" or kind == "soft",)
    ),
    StressCase(
        "tiny steps: fluid",
        "Poiseuille flow in 50 steps of 1e-8 natural times: force and pressure stay.",
        (Within({"drag": 1e-5, "inlet_pressure": 1e-5, "energy": 1e-12}),),
        _tiny_fluid,
        quick=True,
    ),
    StressCase(
        "tiny steps: fluid set in motion at once",
        "Inflow between slip walls at once: the pressure's impulse is ρ U length, nothing is left of it later.",
        (Within({"impulse": (0.99, 1.01), "pressure later": 1e-5, "energy": (0.999, 1.001)}),),
        _tiny_impulse,
        quick=True,
    ),
    *(
        StressCase(
            f"tiny steps: solid, {scheme.split(chr(34))[1]}",
            "A free bar that begins to fall follows g t²/2 in 100 steps of 1e-8 natural times, without strain.",
            (Within({"fall": (0.98, 1.02), "strain": 1e-20}),),
            partial(_tiny_solid, scheme),
            quick=True,
        )
        for scheme in (_BDF, 'solid = "generalised-alpha"', 'solid = "energy-momentum"')
    ),
    *(
        StressCase(
            f"steps of {dt:g}: coupled, {geometry}, {scheme}",
            "Couette flow over a sheared solid in 50 tiny steps: rounding only, or an error that says so.",
            (
                Within({"displacement": 1e-12, "velocity": 1e-6, "load": 1e-3, "pressure": 1e-3}),
                Stops("CouplingError", "rounding|larger step"),
            ),
            partial(_tiny_coupled, dt, geometry, scheme),
            quick=geometry == "extrapolated" and scheme == "bdf2",
        )
        for dt in (1e-6, _TINY)
        for geometry in ("extrapolated", "implicit")
        for scheme in ("bdf2", "generalised-alpha", "energy-momentum")
    ),
    StressCase(
        "tiny steps: coupled from rest",
        "A flow that sets in as u = t in steps of 1e-8: the force, an acceleration, stays as it is.",
        (Within({"iterations": 4.0, "growth": (0.5, 2.0), "moved": 1e-12}),),
        _tiny_start,
        quick=True,
    ),
)
