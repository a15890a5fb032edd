"""Flaps of thickness to length 1:200 and thinner, against beams, elasticas and finer solutions."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np

from stress.cantilever import Cantilever
from stress.case import Expectation, Numbers, Stops, StressCase, Within
from stress.flap import Flap
from stress.runs import Run, marched

__all__ = ["CASES"]

# P L²/(E I): deflections across and along of the tip by the length; Mattiasson, Int. J. Numer. Methods Eng. 17
# (1981) 145-153, doi:10.1002/nme.1620170113.
_ELASTICA = {1.0: (0.30172, 0.05643), 2.0: (0.49346, 0.16064), 5.0: (0.71379, 0.38763), 10.0: (0.81061, 0.55500)}


def _bar(slenderness: float, order: int, along: int, model: str = "st-venant-kirchhoff") -> Cantilever:
    """A bar of length 1 with a bending stiffness of 1."""
    h = 1.0 / slenderness
    bar = Cantilever(order, along, 1, thickness=h, youngs_modulus=1.0, model=model)
    return replace(bar, youngs_modulus=1.0 / bar.stiffness)


def _weight(slenderness: float, order: int, along: int, quick: bool) -> Numbers:
    """Deflection under a small weight, q L⁴/(8 E I) by Euler and Bernoulli."""
    bar = _bar(slenderness, order, along)
    q = 1e-3
    found = marched(replace(bar, body=f'body_force = ["0", "{-q / bar.thickness!r}"]').scene)
    return {
        "error": abs(float(found.series["u_y"][0]) / (-q / 8.0) - 1.0),
        "reaction error": abs(abs(float(found.series["f_y"][0])) / q - 1.0),
    }


def _elastica(load: float, slenderness: float, order: int, along: int, model: str, quick: bool) -> Numbers:
    """A dead load on the tip, in one static step."""
    bar = _bar(slenderness, order, along, model)
    found = marched(replace(bar, tip=f'type = "traction"\ny = {load / bar.thickness!r}').scene)
    across, along_it = _ELASTICA[load]
    return {
        "u_y error": abs(float(found.series["u_y"][0]) - across),
        "u_x error": abs(-float(found.series["u_x"][0]) - along_it),
        "iterations": found.problem.counts["solid"].iterations,
    }


def _frequency(slenderness: float, quick: bool) -> Numbers:
    """First bending frequency from a small swing of some periods."""
    k = 1.8751040687119611
    s = (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k))
    bar = _bar(slenderness, 4, 6)
    bar = replace(bar, density=slenderness)  # mass 1 per length
    exact = k**2 / (2.0 * np.pi)
    mode = f"1e-3*(cosh({k}*x) - cos({k}*x) - {float(s)!r}*(sinh({k}*x) - sin({k}*x)))"
    time = f"dt = {1.0 / exact / 80.0!r}\nsteps = 320"
    found = marched(replace(bar, body=f'initial_velocity = ["0", "{mode}"]', time=time).scene)
    u, t = found.series["u_y"], found.times
    up = np.flatnonzero((u[:-1] < 0.0) & (u[1:] >= 0.0))
    crossings = t[up] - u[up] * (t[up + 1] - t[up]) / (u[up + 1] - u[up])
    frequency = float((len(crossings) - 1) / (crossings[-1] - crossings[0]))
    return {"frequency error": abs(frequency / exact - 1.0)}


@cache
def _in_flow(slenderness: float, order: int, time: str, quick: bool) -> Run:
    """A flap of height 0.5 with the stiffness of one of thickness 0.1 and E = 600, and as heavy."""
    h = 0.5 / slenderness
    inflow = "1" if time.startswith("steady") else "sin(pi*t/2)**2 if t < 1 else 1"
    coupling = "" if time.startswith("steady") else "tolerance = 1e-7"
    flap = Flap(order, 3, 0.5, h, 0.2 / h, 600.0 * (0.1 / h) ** 3, inflow=inflow, time=time, coupling=coupling)
    return marched(flap.scene)


def _steady(slenderness: float, quick: bool) -> Numbers:
    """Steady deflection in a flow, orders 4 and 5; the flap of zero thickness is the limit of all of them."""
    coarse, fine = (_in_flow(slenderness, order, "steady = true", quick).series for order in (4, 5))
    thicker = _in_flow(100.0, 5, "steady = true", quick).series
    return {
        "u_x": float(fine["u_x"][0]),
        "orders differ": abs(float(coarse["u_x"][0] / fine["u_x"][0]) - 1.0),
        "1:100 differs": abs(float(thicker["u_x"][0] / fine["u_x"][0]) - 1.0),
    }


def _marching(slenderness: float, quick: bool) -> Numbers:
    """A flow that sets in smoothly bends the flap; all slender flaps of this stiffness do nearly the same."""
    time = "dt = 0.02\nsteps = 75"
    thin, thicker = (_in_flow(one, 4, time, quick) for one in (slenderness, 100.0))
    scale = np.abs(thicker.series["u_x"]).max()
    n = min(len(thin.at_whole_steps("u_x")), len(thicker.at_whole_steps("u_x")))
    off = np.abs(thin.at_whole_steps("u_x")[:n] - thicker.at_whole_steps("u_x")[:n]).max() / scale
    return {"iterations": thin.mean, "halved": float((~thin.whole).sum()), "1:100 differs": float(off)}


# From 1:1000 on the condition of the matrix may be more than double precision has; the error has to say that.
_TOO_THIN = (Stops("LinearSolverError", "so thin.* that double precision does not tell its bending from rounding"),)


def _ends(slenderness: float, **bounds: float | tuple[float, float]) -> tuple[Expectation, ...]:
    """Within bounds; what is very thin may be refused instead."""
    return (Within(bounds), *(_TOO_THIN if slenderness >= 1e3 else ()))


_SLENDER = (200.0, 1e3, 1e4, 1e5)
# The clamp holds the thickness; an element beside it cannot tell how soon that fades, which costs up to 1 %.
_BEAM = {2: (16, 0.02), 3: (8, 0.01), 4: (6, 0.01), 6: (4, 0.01)}

CASES = (
    *(
        StressCase(
            f"weight, 1:{slenderness:g}, order {order}",
            "Small deflection of a thin bar against Euler and Bernoulli's, with the modulus of plane strain.",
            _ends(slenderness, **{"error": most, "reaction error": 1e-6}),
            partial(_weight, slenderness, order, along),
            quick=slenderness in (200.0, 1e4),
        )
        for slenderness in _SLENDER
        for order, (along, most) in _BEAM.items()
    ),
    *(
        StressCase(
            f"elastica, P L²/(E I) = {load:g}, 1:{slenderness:g}, {model}",
            "A thin bar bent far by a dead load on its tip in one static step, against the elastica.",
            _ends(slenderness, **{"u_y error": 3e-3, "u_x error": 3e-3, "iterations": 400}),
            partial(_elastica, load, slenderness, 4, 8, model),
            quick=load == 2.0 and slenderness == 200.0,
        )
        for load in _ELASTICA
        for slenderness in (200.0, 1e3, 1e4)
        for model in ("st-venant-kirchhoff", "neo-hooke")
        if model == "st-venant-kirchhoff" or slenderness == 200.0
    ),
    *(
        StressCase(
            f"frequency, 1:{slenderness:g}",
            "A thin bar swings in its first mode with the frequency of a beam, less BDF2's 0.2 %.",
            (Within({"frequency error": 5e-3}),),
            partial(_frequency, slenderness),
        )
        for slenderness in (200.0, 1e3)
    ),
    *(
        StressCase(
            f"steady in a flow, 1:{slenderness:g}",
            "A thin flap bent by a steady flow: orders 4 and 5 agree, and a flap of 1:100 of the same stiffness.",
            _ends(slenderness, **{"u_x": (0.01, 0.5), "orders differ": 0.02, "1:100 differs": 0.03}),
            partial(_steady, slenderness),
        )
        for slenderness in (200.0, 1e3, 1e4)
    ),
    *(
        StressCase(
            f"bent by a flow in time, 1:{slenderness:g}",
            "A thin flap, as heavy as one of 1:100, in a flow that sets in: few iterations and the same motion.",
            (
                Within({"iterations": 4.0, "halved": 0, "1:100 differs": 0.03}),
                Stops("ConvergenceError", "interface ends|does not|Newton's method"),
            )[: 1 if slenderness <= 1e3 else 2],
            partial(_marching, slenderness),
        )
        for slenderness in (200.0, 1e3, 1e4)
    ),
)
