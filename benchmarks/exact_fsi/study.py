"""Orders in space and in time of exact solutions of fluid–structure interaction, and of a flap in a channel."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exact_fsi.errors import Errors, Exact, Wave, errors_at, load_errors, orders
from exact_fsi.flap import flap
from exact_fsi.piston import Piston
from exact_fsi.rotating_disc import RotatingDisc
from exact_fsi.settings import Settings
from exact_fsi.shear_layer import ShearLayer
from hofsi.build import Problem, build
from hofsi.io.scene import read_case
from hofsi.quantities import evaluators
from hofsi.records import State, StepRecord
from hofsi.simulate import simulate
from hofsi.solvers.fluid import FluidState
from hofsi.solvers.solid import SolidState

Array = NDArray[np.float64]

__all__ = [
    "ELEMENTS",
    "IN_SPACE",
    "IN_TIME",
    "Observed",
    "built",
    "flap_series",
    "in_space",
    "in_time",
    "marched",
    "observed_of_flap",
]

IN_TIME: Mapping[str, tuple[Exact, float, Settings, tuple[int, int]]] = {
    "shear layer": (ShearLayer(), 2.0, Settings(order=5), (20, 40)),
    "shear layer, neo-Hooke": (ShearLayer(), 2.0, Settings(order=5, model="neo-hooke"), (20, 40)),
    "piston": (Piston(), 2.0, Settings(order=4), (40, 80)),
    "rotating disc": (RotatingDisc(), 0.4, Settings(order=5), (20, 40)),
}
"""Solution, end, mesh and numbers of steps by name; in space fine enough to leave the error in time alone."""

IN_SPACE: Mapping[str, tuple[Wave, float]] = {
    "shear layer": (ShearLayer(speed=1e-4, frequency=2.0, step=0.2), 0.2),
    "rotating disc": (RotatingDisc(step=0.05), 0.05),
}
"""Solution, discretised in time with a step. The shear layer moves the mesh so little that its nodes keep their y."""

ELEMENTS: Mapping[str, Mapping[int, tuple[int, int]]] = {
    "shear layer": {2: (2, 4), 3: (2, 4), 4: (2, 4), 5: (1, 2)},
    "rotating disc": {2: (2, 4), 3: (2, 4), 4: (2, 3), 5: (1, 2)},
}
"""Along each block edge, by order."""

_STEPS = 12
_FLAP_END = 1.0
_FLAP_QUANTITIES = ("u_x", "u_y", "f_x", "f_y")


@dataclass(frozen=True)
class Observed:
    """Errors of the finer of two runs, and the orders between them."""

    errors: Errors
    orders: Errors


def built(scene: str) -> Problem:
    """The problem of a scene."""
    return build(read_case(tomllib.loads(scene), "scene.toml"))


def marched(scene: str) -> tuple[Problem, list[StepRecord]]:
    """A scene's problem and all its steps."""
    problem = built(scene)
    return problem, list(simulate(problem))


def in_space(case: str, order: int, elements: tuple[int, int] | None = None) -> Observed:
    """Order in space, by solutions that are exact in time.

    Parameters
    ----------
    case : str
        One of ``IN_SPACE``.
    order : int
    elements : pair of int, optional
        Along each block edge; by default as in ``ELEMENTS``.
    """
    exact, step = IN_SPACE[case]
    counts = elements or ELEMENTS[case][order]
    found = []
    for n in counts:
        settings = Settings(order, n, dt=step, tolerance=1e-9)
        scene = exact.scene(settings, skewed=False) if isinstance(exact, ShearLayer) else exact.scene(settings)
        problem = built(scene)
        found.append(errors_at(exact, problem, journey(exact, problem, step, _STEPS)))
    return Observed(found[1], orders(*found, counts[1] / counts[0]))


def in_time(case: str, geometry: str, scheme: str, steps: tuple[int, int] | None = None) -> Observed:
    """Order in time of a scene as it is run, from the exact state.

    Errors of displacement and velocity are those at the end; that of the load is the root of its mean square over the
    second half, relative to the largest load.

    Parameters
    ----------
    case : str
        One of ``IN_TIME``.
    geometry, scheme : str
        As in `Settings`.
    steps : pair of int, optional
        The larger second; by default as in ``IN_TIME``.
    """
    exact, end, mesh, default = IN_TIME[case]
    counts = steps or default
    found = []
    for count in counts:
        settings = replace(mesh, dt=end / count, steps=count, geometry=geometry, scheme=scheme)
        problem, records = marched(exact.scene(settings))
        last = errors_at(exact, problem, records[-1])
        late = load_errors(exact, problem, records[count // 2 :])
        largest = max(float(np.abs(exact.load_at(record.time)).max()) for record in records)
        found.append(replace(last, load=float(np.sqrt(np.mean(late**2))) / largest))
    return Observed(found[1], orders(*found, counts[1] / counts[0]))


def flap_series(steps: int, geometry: str = "extrapolated", scheme: str = "bdf2") -> Array:
    """Displacement of the tip and force on the flap after each step to t = 1, shape (steps, 4)."""
    given = Settings(2, dt=_FLAP_END / steps, steps=steps, geometry=geometry, scheme=scheme, tolerance=1e-8)
    problem, records = marched(flap(replace(given, model="st-venant-kirchhoff")))
    read = evaluators(problem)
    return np.array([[read[name](record) for name in _FLAP_QUANTITIES] for record in records])


def observed_of_flap(series: Sequence[Array], reference: Array) -> tuple[Array, Array]:
    """Errors of the finer of two series and the orders between them, of the four quantities.

    They are roots of mean squares over the second half of the time, relative to the largest values.

    Parameters
    ----------
    series : sequence of ndarray, shape (steps, 4)
        Two, the coarser first.
    reference : ndarray, shape (many steps, 4)
    """
    found = []
    for values in series:
        n = len(values)
        stride = len(reference) // n
        late = (values - reference[stride - 1 :: stride])[n // 2 :]
        found.append(np.sqrt(np.mean(late**2, axis=0)) / np.abs(reference).max(axis=0))
    return found[1], np.log(found[0] / found[1]) / np.log(len(series[1]) / len(series[0]))


def journey(exact: Wave, problem: Problem, step: float, count: int) -> StepRecord:
    """Some steps of BDF2 from exact states at t = 0 and before.

    Parameters
    ----------
    exact : Wave
        Of the equations discretised in time with this step, so that all that is left is the error in space.
    problem : Problem
        Without prescribed motion.
    step : float
    count : int
    """
    fluid, solid = problem.fluid, problem.solid
    assert fluid is not None
    assert fluid.motion is not None
    assert solid is not None
    assert problem.interface is not None
    motion, nodes, wet = fluid.motion, solid.mesh.points, problem.interface.solid
    driven = fluid.mesh.points[motion.driven.nodes]
    before, now = (motion.move(motion.reference, exact.displacement_at(driven, t), t) for t in (-step, 0.0))
    points = now.mesh.points, before.mesh.points
    velocities = tuple(exact.velocity_at(x, t) for x, t in zip(points, (0.0, -step), strict=True))
    pressure = np.zeros(fluid.solver.space.pressure_count)
    times = -step * np.arange(6)
    state = State(
        FluidState(velocities, pressure, points, np.zeros_like(points[0]), 0.0),
        SolidState(
            tuple(exact.displacement_at(nodes, t) for t in times[:2]),
            tuple(exact.solid_velocity_at(nodes, t) for t in times[:2]),
            0.0,
            step=step,
        ),
        now,
        tuple(exact.displacement_at(nodes[wet], t) for t in times),
    )
    for k in range(1, count + 1):
        state, coupling = problem.march.step(state, [step] * 4, k * step)
    return StepRecord(count, count * step, step, state, coupling)
