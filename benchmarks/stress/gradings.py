"""Gradings of 1:1e4 to 1:1e8: elements with such aspect ratios keep exact solutions, moving meshes included."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from exact_fsi.couette import Couette
from exact_fsi.errors import errors_at, load_errors
from exact_fsi.settings import Settings
from exact_fsi.study import marched as exactly_marched
from hoblock import generate
from hoblock.building import build_structure
from stress.cantilever import Cantilever
from stress.case import Numbers, StressCase, Within
from stress.channel import Channel
from stress.runs import marched, read
from stress.sampling import sampled_det_J

__all__ = ["CASES"]

_RATIOS = (1e4, 1e6, 1e8)


def _grading(on: str, ratio: float) -> str:
    """Elements that grow geometrically from the first vertex."""
    return f'[[mesh.grading]]\non = {on}\nkind = "geometric"\ntotal = {ratio!r}\n'


def _graded(order: int, ratio: float, time: str) -> Channel:
    """Sixteen elements across that grow from the bottom, one of length 1 along."""
    gradings = _grading('["left", "right"]', ratio)
    return Channel(order, 2, 16, gradings=gradings, initial="0" if "steady" in time else "4*y*(1 - y)", time=time)


def _poiseuille(order: int, ratio: float, time: str, quick: bool) -> Numbers:
    """Exact on any rectangles."""
    found = marched(_graded(order, ratio, time).scene)
    assert found.problem.fluid is not None
    state = found.last.state.fluid
    assert state is not None
    mesh = found.problem.fluid.mesh
    y = mesh.points[:, 1]
    corners = mesh.points[mesh.corners]
    aspect = np.abs(corners[:, 1, 0] - corners[:, 0, 0]) / np.abs(corners[:, 3, 1] - corners[:, 0, 1])
    return {
        "velocity": float(np.abs(state.velocity - np.stack([4.0 * y * (1.0 - y), 0.0 * y], axis=-1)).max()),
        "pressure": abs(float(found.series["inlet_pressure"][-1]) / 1.6 - 1.0),
        "drag": abs(float(found.series["drag"][-1]) / 1.6 - 1.0),
        "aspect": float(max(aspect.max(), 1.0 / aspect.min())),
    }


def _corner(order: int, ratio: float, quick: bool) -> Numbers:
    """Graded both ways to one corner: squares of 1e-6, needles beside them."""
    channel = _graded(order, ratio, "steady = true")
    both = channel.gradings + _grading('["bottom", "top"]', ratio)
    found = marched(replace(channel, along=12, across=12, gradings=both).scene)
    assert found.problem.fluid is not None
    assert found.last.state.fluid is not None
    y = found.problem.fluid.mesh.points[:, 1]
    u = found.last.state.fluid.velocity
    return {
        "velocity": float(np.abs(u - np.stack([4.0 * y * (1.0 - y), 0.0 * y], axis=-1)).max()),
        "drag": abs(float(found.series["drag"][0]) / 1.6 - 1.0),
    }


def _couette(ratio: float, geometry: str, steps: int, dt: float, quick: bool) -> Numbers:
    """The exact coupled state between bodies graded towards their interface."""
    solution = Couette(0.5)
    settings = Settings(3, 8, dt=dt, steps=steps, geometry=geometry)
    fluid, solid = _grading('[["i0", "t0"], ["i1", "t1"]]', ratio), _grading('[["i0", "s0"], ["i1", "s1"]]', ratio)
    scene = solution.scene(settings, distorted=False).replace("\n[fluid]\n", f"\n{fluid}{solid}[fluid]\n")
    problem, records = exactly_marched(scene)
    found = errors_at(solution, problem, records[-1])
    load = float(np.abs(load_errors(solution, problem, records)).max())
    return {"displacement": found.displacement, "velocity": found.velocity, "load": load}


def _stretched(ratio: float, quick: bool) -> Numbers:
    """A uniform finite strain of a bar graded both ways."""
    bar = Cantilever(3, 12, 12, thickness=1.0, tip='type = "displacement"\nx = 0.2', youngs_modulus=2.6)
    scene = bar.scene.replace('type = "fixed"', 'type = "roller"').replace(
        'on = "sides"\ntype = "free"', 'on = "sides"\ntype = "roller"'
    )
    gradings = _grading('"sides"', ratio) + _grading('["clamp", "tip"]', ratio)
    found = marched(scene.replace("[[solid]]", f"{gradings}[[solid]]", 1))
    assert found.problem.solid is not None
    assert found.last.state.solid is not None
    x = found.problem.solid.mesh.points[:, 0]
    d = found.last.state.solid.displacement
    stress = (2.6 * 0.3 / (1.3 * 0.4) + 2.0) * (1.2**3 - 1.2) / 2.0
    return {
        "displacement": float(np.abs(d - np.stack([0.2 * x, 0.0 * x], axis=-1)).max()),
        "force": abs(abs(float(found.series["f_x"][0])) / stress - 1.0),
    }


def _certified(ratio: float, quick: bool) -> Numbers:
    """det J of elements graded both ways, down to the square of the ratio: certified, positive, and right."""
    both = _grading('["left", "right"]', ratio) + _grading('["bottom", "top"]', ratio)
    case = read(replace(Channel(4, 12, 12), gradings=both).scene)
    mesh = generate(build_structure(case.mesh), 4)
    det_J = sampled_det_J(mesh)
    corners = mesh.points[mesh.corners]
    sides = corners[:, 2] - corners[:, 0]
    exact = (0.25 * sides[:, 0] * sides[:, 1])[:, None, None]
    return {"smallest": float(det_J.min()), "relative error": float(np.abs(det_J / exact - 1.0).max())}


def _limits(ratio: float) -> float:
    """What rounding may leave of an element's solution: its condition is that of the aspect ratio."""
    return {1e4: 1e-9, 1e6: 1e-8, 1e8: 1e-6}[ratio]


_MARCH = "dt = 0.1\nsteps = 20"

CASES = (
    *(
        StressCase(
            f"Poiseuille, 1:{ratio:g}, order {order}, {time.split()[0]}",
            "Elements grow from one wall to the other by that factor.",
            (
                Within(
                    {
                        "velocity": _limits(ratio),
                        "pressure": 10.0 * _limits(ratio),
                        "drag": 10.0 * _limits(ratio),
                        "aspect": (ratio, np.inf),
                    }
                ),
            ),
            partial(_poiseuille, order, ratio, time),
            quick=order == 3,
        )
        for ratio in _RATIOS
        for order in (2, 3, 6)
        for time in ("steady = true", _MARCH)
    ),
    *(
        StressCase(
            f"Poiseuille towards a corner, 1:{ratio:g}",
            "Elements grow both ways from one corner by that factor.",
            (Within({"velocity": _limits(ratio), "drag": 10.0 * _limits(ratio)}),),
            partial(_corner, 3, ratio),
        )
        for ratio in _RATIOS
    ),
    *(
        StressCase(
            f"Couette over a solid, 1:{ratio:g}, {geometry}, dt = {dt:g}",
            "Fluid and solid graded towards their interface on a mesh that moves with it.",
            (Within({"displacement": _limits(ratio), "velocity": _limits(ratio), "load": 10.0 * _limits(ratio)}),),
            partial(_couette, ratio, geometry, 5, dt),
            quick=geometry == "extrapolated" and ratio == 1e6 and dt == 0.1,
        )
        for ratio in _RATIOS
        for geometry in ("extrapolated", "implicit")
        for dt in (0.1, 1e-4)
    ),
    *(
        StressCase(
            f"stretched solid, 1:{ratio:g}",
            "A uniform finite strain of a solid graded both ways by that factor.",
            (Within({"displacement": _limits(ratio), "force": 10.0 * _limits(ratio)}),),
            partial(_stretched, ratio),
            quick=ratio == 1e6,
        )
        for ratio in _RATIOS
    ),
    *(
        StressCase(
            f"certificate, 1:{ratio:g}",
            "Elements graded both ways have det J of down to ratio⁻²; all are certified, and are what they should be.",
            (Within({"smallest": (1e-300, np.inf), "relative error": 1e-6}),),
            partial(_certified, ratio),
            quick=True,
        )
        for ratio in _RATIOS
    ),
)
