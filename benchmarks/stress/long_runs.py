"""Up to 1e5 steps of small problems: energy, mass, volume and free stream do not drift."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from exact_fsi.couette import Couette
from exact_fsi.errors import errors_at
from exact_fsi.settings import Settings
from exact_fsi.study import built
from hofsi.fem.nodal_weights import nodal_weights
from hofsi.quantities import evaluators
from hofsi.simulate import simulate
from manufactured_flows.flows import UNIFORM
from manufactured_flows.scenes import waving_square
from stress.cantilever import Cantilever
from stress.case import Numbers, StressCase, Within
from stress.channel import Channel
from stress.runs import marched

Array = NDArray[np.float64]

__all__ = ["CASES"]

_QUICK = 2000


def _swinging(model: str, steps: int, quick: bool) -> Numbers:
    """A bar of one element that swings freely, with the scheme that keeps its energy."""
    steps = min(steps, _QUICK if model == "linear" else 200) if quick else steps
    bar = Cantilever(
        2,
        1,
        1,
        model=model,
        body='initial_velocity = ["0", "3*x**2"]',
        time=f'dt = 0.02\nsteps = {steps}\nsolid = "energy-momentum"',
    )
    found = marched(bar.scene)
    energy = found.series["strain"] + found.series["kinetic"]
    parts = np.array_split(np.abs(found.series["u_y"]), 4)
    return {
        "energy drift": float(np.abs(energy / energy[0] - 1.0).max()),
        "halved": float((~found.whole).sum()),
        "amplitude, last/first": float(parts[-1].max() / parts[0].max()),
    }


def _drifting(quick: bool) -> Numbers:
    """A free body that turns: momentum and angular momentum."""
    steps = 200 if quick else 3000
    bar = Cantilever(
        2,
        2,
        1,
        body='initial_velocity = ["1 - 2*y", "2*(x - 0.5)"]',
        time=f'dt = 0.02\nsteps = {steps}\nsolid = "energy-momentum"',
    )
    found = marched(bar.scene.replace('type = "fixed"', 'type = "free"'))
    energy = found.series["strain"] + found.series["kinetic"]
    assert found.problem.solid is not None
    assert found.last.state.solid is not None
    weights = nodal_weights(found.problem.solid.mesh)
    moved = np.asarray(weights @ found.last.state.solid.displacement / weights.sum())
    return {
        "energy drift": float(np.abs(energy / energy[0] - 1.0).max()),
        "way": float(moved[0] / found.times[-1]),
        "aside": abs(float(moved[1])),
    }


def _poiseuille(quick: bool) -> Numbers:
    """Poiseuille flow that is left alone."""
    steps = 1000 if quick else 5000
    found = marched(Channel(2, 1, 1, initial="4*y*(1 - y)", time=f"dt = 0.1\nsteps = {steps}").scene)
    return {name: float(np.abs(found.series[name] / found.series[name][0] - 1.0).max()) for name in ("energy", "drag")}


def _free_stream(quick: bool) -> Numbers:
    """A uniform flow on a mesh whose boundary waves for hundreds of periods, and the volume of it."""
    steps = 160 if quick else 1600
    scene = waving_square(UNIFORM, 2, 1, time=f"dt = 0.05\nsteps = {steps}")
    scene += '\n[quantities.area]\ntype = "area"\n[quantities.balance]\ntype = "flow-balance"\n'
    problem = built(scene)
    read = evaluators(problem)
    off, balance, areas = 0.0, 0.0, []
    for record in simulate(problem):
        assert record.state.fluid is not None
        off = max(off, float(np.abs(record.state.fluid.velocity - 1.0).max()))
        balance = max(balance, abs(read["balance"](record)))
        if record.step % 80 == 0:  # a period of the wave is 4
            areas.append(read["area"](record))
    return {"velocity": off, "flow balance": balance, "area drift": float(np.ptp(areas))}


def _couette(quick: bool) -> Numbers:
    """The exact steady state of a coupled problem of eight elements."""
    steps = 100 if quick else 1500
    solution = Couette(0.5)
    problem = built(solution.scene(Settings(2, 2, dt=0.1, steps=steps), distorted=False))
    for record in simulate(problem):
        last = record
    found = errors_at(solution, problem, last)
    return {"displacement": found.displacement, "velocity": found.velocity, "load": found.load}


def _returning(quick: bool) -> Numbers:
    """An enclosed fluid whose walls wave: after whole periods its area and its mesh are those of the start."""
    steps = 160 if quick else 1600
    scene = waving_square(UNIFORM, 2, 1, time=f"dt = 0.05\nsteps = {steps}", mover="pseudo-solid")
    problem = built(scene)
    assert problem.fluid is not None
    for record in simulate(problem):
        last = record
    assert last.state.mesh is not None
    return {"mesh": float(np.abs(last.state.mesh.mesh.points - problem.fluid.mesh.points).max())}


CASES = (
    StressCase(
        "swinging bar, St. Venant-Kirchhoff, 3e3 steps",
        "A bar swings with large amplitudes; the scheme keeps its energy to the tolerance of Newton's method.",
        (Within({"energy drift": 1e-6, "halved": 0, "amplitude, last/first": (0.9, 1.1)}),),
        partial(_swinging, "st-venant-kirchhoff", 3000),
    ),
    StressCase(
        "swinging bar, neo-Hooke, 3e3 steps",
        "The same with the other law and its correction of the stress.",
        (Within({"energy drift": 1e-6, "halved": 0, "amplitude, last/first": (0.9, 1.1)}),),
        partial(_swinging, "neo-hooke", 3000),
    ),
    StressCase(
        "free body turning, 3e3 steps",
        "A free bar flies and turns: it goes straight on, its energy stays.",
        (Within({"energy drift": 1e-6, "way": (1.0 - 1e-8, 1.0 + 1e-8), "aside": 1e-6}),),
        _drifting,
    ),
    StressCase(
        "Poiseuille flow, 5e3 steps",
        "A steady flow stays what it is.",
        (Within({"energy": 1e-9, "drag": 1e-9}),),
        _poiseuille,
        quick=True,
    ),
    StressCase(
        "free stream on a waving mesh, 1600 steps",
        "A uniform flow stays uniform, what flows in flows out, the area comes back every period.",
        (Within({"velocity": 1e-9, "flow balance": 1e-10, "area drift": 1e-12}),),
        _free_stream,
        quick=True,
    ),
    StressCase(
        "mesh after many periods",
        "The mesh of a waving square is that of the start after whole periods.",
        (Within({"mesh": 1e-10}),),
        _returning,
    ),
    StressCase(
        "Couette flow over a solid, 1500 steps",
        "The exact coupled steady state stays, coupling iterations and moving mesh included.",
        (Within({"displacement": 1e-7, "velocity": 1e-7, "load": 1e-7}),),
        _couette,
        quick=True,
    ),
    StressCase(
        "swinging bar, linear, 1e5 steps",
        "A bar of one linear element swings; energy and amplitude stay, however many roundings add up.",
        (Within({"energy drift": 1e-9, "halved": 0, "amplitude, last/first": (0.99, 1.01)}),),
        partial(_swinging, "linear", 100_000),
        quick=True,
    ),
)
