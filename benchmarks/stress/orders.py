"""Orders 2 to 12: what is exact stays exact, and what is not converges."""

from __future__ import annotations

import tomllib
from functools import partial

import numpy as np

from exact_fsi.couette import Couette
from exact_fsi.errors import errors_at, load_errors
from exact_fsi.settings import Settings
from exact_fsi.study import marched as exactly_marched
from hofsi.build import build
from hofsi.io.scene import read_case
from hofsi.simulate import simulate
from manufactured_flows.flows import KOVASZNAY
from manufactured_flows.scenes import curved_channel
from stress.cantilever import Cantilever
from stress.case import Numbers, StressCase, Within
from stress.channel import Channel
from stress.flap import Flap
from stress.runs import marched

__all__ = ["CASES"]

ORDERS = tuple(range(2, 13))


def _poiseuille(order: int, quick: bool) -> Numbers:
    """Exact at any order."""
    channel = Channel(order, 2, 2)
    found = marched(channel.scene)
    assert found.problem.fluid is not None
    assert found.last.state.fluid is not None
    y = found.problem.fluid.mesh.points[:, 1]
    u = found.last.state.fluid.velocity
    return {
        "velocity": float(np.abs(u - np.stack([4.0 * y * (1.0 - y), 0.0 * y], axis=-1)).max()),
        "drag": abs(float(found.series["drag"][0]) / 1.6 - 1.0),
    }


def _kovasznay(order: int, quick: bool) -> Numbers:
    """Largest error of the velocity at nodes of curved elements, Re = 40."""
    problem = build(read_case(tomllib.loads(curved_channel(KOVASZNAY, order, 1)), "scene.toml"))
    (record,) = simulate(problem)
    assert problem.fluid is not None
    assert record.state.fluid is not None
    exact = KOVASZNAY.velocity_at(problem.fluid.mesh.points, 0.0)
    return {"velocity": float(np.abs(record.state.fluid.velocity - exact).max())}


def _stretched(order: int, quick: bool) -> Numbers:
    """A St. Venant-Kirchhoff bar between rollers under the load P = (λ + 2η) (F³ - F)/2 of the stretch F = 1.2."""
    bar = Cantilever(order, 2, 2, tip='type = "traction"\nx = "T"', youngs_modulus=2.6)
    lame, shear = 2.6 * 0.3 / (1.3 * 0.4), 1.0
    F = 1.2
    scene = bar.scene.replace('"T"', repr((lame + 2.0 * shear) * (F**3 - F) / 2.0))
    scene = scene.replace('type = "fixed"', 'type = "roller"').replace(
        'on = "sides"\ntype = "free"', 'on = "sides"\ntype = "roller"'
    )
    found = marched(scene)
    return {"displacement": abs(float(found.series["u_x"][0]) / (F - 1.0) - 1.0)}


def _bent(order: int, quick: bool) -> Numbers:
    """A bar bent far in one static step; order 12 on three elements is the reference."""
    tip, finest = (
        float(marched(Cantilever(p, 3, 1, tip='type = "traction"\ny = 4.0').scene).series["u_y"][0])
        for p in (order, 12)
    )
    return {"error": abs(tip / finest - 1.0), "tip": tip}


def _couette(order: int, geometry: str, distorted: bool, quick: bool) -> Numbers:
    """The exact coupled state, after steps in time."""
    solution = Couette(0.5)
    settings = Settings(order, dt=0.1, steps=4, geometry=geometry)
    problem, records = exactly_marched(solution.scene(settings, distorted=distorted))
    found = errors_at(solution, problem, records[-1])
    load = float(np.abs(load_errors(solution, problem, records)).max())
    return {"displacement": found.displacement, "velocity": found.velocity, "load": load}


def _flap(order: int, quick: bool) -> Numbers:
    """A flap bent by a flow that sets in, ten steps: iterations, and the tip against that of order 8."""
    time = "dt = 0.05\nsteps = 10"
    tips = []
    for p in (order, 8):
        found = marched(Flap(p, 1, inflow="sin(pi*t)**2", time=time).scene)
        tips.append((float(found.series["u_x"][-1]), found.mean))
    return {"error": abs(tips[0][0] / tips[1][0] - 1.0), "iterations": tips[0][1]}


def _kovasznay_bound(order: int) -> float:
    """Exponential: a factor of four an order, down to rounding."""
    return max(0.5 * 4.0 ** -(order - 2), 1e-9)


CASES = (
    *(
        StressCase(
            f"Poiseuille flow, order {order}",
            "A quadratic flow is exact at every order.",
            (Within({"velocity": 1e-9, "drag": 1e-9}),),  # Newton stops at 1e-10
            partial(_poiseuille, order),
            quick=order in (2, 7, 12),
        )
        for order in ORDERS
    ),
    *(
        StressCase(
            f"Kovasznay's flow, order {order}",
            "A steady flow with convection on curved elements converges with the order, down to rounding at 12.",
            (Within({"velocity": _kovasznay_bound(order)}),),
            partial(_kovasznay, order),
            quick=order in (2, 7, 12),
        )
        for order in ORDERS
    ),
    *(
        StressCase(
            f"stretched bar, order {order}",
            "A uniform finite strain is exact at every order.",
            (Within({"displacement": 1e-8}),),
            partial(_stretched, order),
            quick=order in (2, 7, 12),
        )
        for order in ORDERS
    ),
    *(
        StressCase(
            f"bent bar, order {order}",
            "A bar bent far in one static step; its corners are singular, so that orders help slowly.",
            (Within({"error": 0.1 if order == 2 else 0.01, "tip": (0.3, 1.0)}),),
            partial(_bent, order),
        )
        for order in ORDERS
    ),
    *(
        StressCase(
            f"Couette flow over a solid, {geometry}, order {order}",
            "The exact coupled state on distorted curved elements stays, at every order.",
            (Within({"displacement": 1e-9, "velocity": 1e-9, "load": 1e-9}),),
            partial(_couette, order, geometry, True),
            quick=order in (2, 7, 12) and geometry == "extrapolated",
        )
        for geometry in ("extrapolated", "implicit")
        for order in ORDERS
    ),
    *(
        StressCase(
            f"flap in a channel, order {order}",
            "A coupled problem with singular corners on the coarsest mesh: few iterations at every order.",
            (Within({"error": 0.3 if order == 2 else 0.1, "iterations": 4.0}),),
            partial(_flap, order),
        )
        for order in (2, 3, 4, 6, 8, 10, 12)
    ),
)
