"""Orders of convergence in space and in time of flows on moving meshes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from full_mesh_movers import Elastic
from hofsi.simulate import simulate
from manufactured_flows.errors import l2_errors
from manufactured_flows.flow import Flow
from manufactured_flows.flows import IMPOSED, KOVASZNAY, LINEAR, VORTEX
from manufactured_flows.journey import MakeMover, built, journey
from manufactured_flows.scenes import curved_channel, imposed, waving_square

Array = NDArray[np.float64]

__all__ = [
    "CASES",
    "ELEMENTS",
    "MESHES",
    "Observed",
    "Pattern",
    "as_scene",
    "at_rest",
    "in_space",
    "in_time",
    "observed",
]

Pattern = Literal["equal", "varying"]

CASES: Mapping[str, tuple[Flow, Callable[..., str]]] = {
    "vortex": (VORTEX, waving_square),
    "imposed": (IMPOSED, imposed),
    "linear": (LINEAR, imposed),
}
"""Flow and moving mesh by name."""

MESHES: Mapping[str, MakeMover | None] = {
    "blocks": None,
    "pseudo-solid": lambda *mesh: Elastic(*mesh, exponent=0.0),
    "pseudo-solid, area": lambda *mesh: Elastic(*mesh, stiffening="area", exponent=-1.0),
    "pseudo-solid, area, incremental": lambda *mesh: Elastic(*mesh, stiffening="area", exponent=-1.0, incremental=True),
}
"""Blocks made anew from vertices placed by the barrier mover, and movers of all nodes."""

ELEMENTS: Mapping[str, Mapping[int, tuple[int, int]]] = {
    "vortex": {2: (4, 8), 3: (8, 12), 4: (4, 6), 5: (8, 10), 6: (3, 4)},
    "imposed": {2: (4, 8), 3: (8, 12), 4: (4, 6), 5: (4, 6), 6: (3, 4)},
}
"""Along each block edge, by order. Odd orders come to their rate on finer meshes than even ones."""

_STEP: Mapping[str, float] = {"vortex": 0.05, "imposed": 0.01}
"""Time step times 3^order: the boundary of the vortex moves more slowly."""

_START, _STEPS, _APPROACH = 0.3, 8, 10


@dataclass(frozen=True)
class Observed:
    """Errors in L² on the coarser and the finer of two meshes, or with the larger and the smaller of two time steps.

    Attributes
    ----------
    velocity, pressure : tuple of float
    velocity_order, pressure_order : float
    """

    velocity: tuple[float, float]
    pressure: tuple[float, float]
    velocity_order: float
    pressure_order: float


def observed(errors: Sequence[tuple[float, float]], ratio: float) -> Observed:
    """Orders from errors of velocity and pressure on two meshes or with two steps.

    Parameters
    ----------
    errors : sequence of (float, float)
        Two of them.
    ratio : float
        Of the mesh widths or the steps, above 1.
    """
    (u0, p0), (u1, p1) = errors
    orders = np.log([u0 / u1, p0 / p1]) / np.log(ratio)
    return Observed((u0, u1), (p0, p1), float(orders[0]), float(orders[1]))


def in_space(
    case: str, order: int, mesh: str = "blocks", *, mover: str = "barrier", elements: tuple[int, int] | None = None
) -> Observed:
    """Order in space, after a few steps from an exact start on a mesh in motion.

    The steps are so small that the error of the time scheme is below a few percent of the finer mesh's.

    Parameters
    ----------
    case : {"vortex", "imposed"}
    order : int
    mesh : str
        One of ``MESHES``.
    mover : str
        Of the blocks.
    elements : pair of int, optional
        Along each block edge; by default as in ``ELEMENTS``.
    """
    flow, scene = CASES[case]
    times = _START + _STEP[case] / 3**order * np.arange(_STEPS + 2)
    counts = elements or ELEMENTS[case][order]
    errors = []
    for n in counts:
        problem = built(scene(flow, order, n, mover=mover))
        assert problem.fluid is not None
        state = journey(flow, problem, times.tolist(), MESHES[mesh], approach=_APPROACH)
        errors.append(l2_errors(flow, problem.fluid.solver, state))
    return observed(errors, counts[1] / counts[0])


def in_time(
    case: str,
    pattern: Pattern,
    convection: str,
    *,
    order: int,
    elements: int,
    interval: tuple[float, float],
    steps: tuple[int, int],
) -> Observed:
    """Order in time on a mesh in motion that is fine enough to leave the time scheme's error alone.

    Parameters
    ----------
    case : str
        One of ``CASES``.
    pattern : {"equal", "varying"}
        "varying": every other step is 1.6 times as long.
    convection : str
        As in a scene.
    order, elements : int
    interval : pair of float
        The first step ends after its start.
    steps : pair of int
        Even; the larger second.
    """
    flow, scene = CASES[case]
    problem = built(scene(flow, order, elements, convection=convection))
    assert problem.fluid is not None
    errors = []
    for count in steps:
        sizes = np.tile([1.0, 1.6] if pattern == "varying" else [1.0, 1.0], count // 2)
        times = interval[0] + (interval[1] - interval[0]) * np.concatenate([[0.0], np.cumsum(sizes) / sizes.sum()])
        state = journey(flow, problem, times.tolist())
        errors.append(l2_errors(flow, problem.fluid.solver, state))
    return observed(errors, steps[1] / steps[0])


def at_rest(order: int, elements: tuple[int, int] | None = None) -> Observed:
    """Order in space of Kovasznay's flow on curved blocks at rest.

    Parameters
    ----------
    order : int
    elements : pair of int, optional
        Along each block edge.
    """
    counts = elements or {2: (6, 12), 3: (6, 12), 4: (3, 6), 5: (3, 6), 6: (3, 4)}[order]
    errors = []
    for n in counts:
        problem = built(curved_channel(KOVASZNAY, order, n))
        assert problem.fluid is not None
        (record,) = simulate(problem)
        assert record.state.fluid is not None
        errors.append(l2_errors(KOVASZNAY, problem.fluid.solver, record.state.fluid))
    return observed(errors, counts[1] / counts[0])


def as_scene(case: str, *, order: int, elements: int, end: float, steps: tuple[int, int]) -> Observed:
    """Order in time of a scene as it is run: from its initial velocity, the first step by BDF1, default convection.

    Parameters
    ----------
    case : str
        One of ``CASES``.
    order, elements : int
    end : float
        From t = 0.
    steps : pair of int
        The larger second.
    """
    flow, scene = CASES[case]
    errors = []
    for count in steps:
        problem = built(scene(flow, order, elements, time=f"dt = {end / count!r}\nsteps = {count}"))
        assert problem.fluid is not None
        *_, record = simulate(problem)
        assert record.state.fluid is not None
        errors.append(l2_errors(flow, problem.fluid.solver, record.state.fluid))
    return observed(errors, steps[1] / steps[0])
