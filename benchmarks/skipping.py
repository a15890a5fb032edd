"""What a scene does not need costs nothing: pairs of scenes with a need and without, step by step in turn.

All are made from the scene of FSI3: its fluid alone with a rigid flag, the flag alone, both coupled. The two runs of a
pair take their steps in turn, so that a slow minute of the machine meets both; a time is the processor's for a step,
the lower quintile of all, start-up left out. A steady scene and the same marched in time are whole runs. "floor" is a
loop that calls the fluid's solver and nothing else: what the time loop, the mesh and the coupling that are not there
add to it is the first ratio.
"""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from _result import ROOT, Result, parser, report
from hofsi import build, read_case, simulate
from hofsi.build import Problem
from hofsi.observers.fields import FieldWriter
from hofsi.records import StepRecord

Scene = dict[str, Any]
Steps = Iterator[object]
_LEAST = 0.2  # the times that this part of the steps stays below: the machine's other work lengthens some
_WARM = 3  # steps that are not counted: the first has no history, the second no factors


@dataclass(frozen=True)
class Side:
    """One of two runs: a scene, and how its steps are made."""

    name: str
    scene: Scene
    steps: Callable[[Problem], Steps] = simulate


@dataclass(frozen=True)
class Pair:
    """Two runs that differ by one need.

    Attributes
    ----------
    need : str
    without, having : Side
    counts : sequence of str
        As ``"fluid.factorisations"``: what proves that the first run leaves it out.
    whole : bool
        Whether the runs are made to their ends, one after the other, instead of step by step in turn.
    """

    need: str
    without: Side
    having: Side
    counts: Sequence[str] = field(default_factory=tuple)
    whole: bool = False


def whole_scene() -> Scene:
    """FSI3, shortened by nothing but its output."""
    scene = tomllib.loads((ROOT / "examples" / "fsi3.toml").read_text(encoding="utf-8"))
    scene["output"] = {"fields": False, "plots": False}
    return scene


def fluid_scene() -> Scene:
    """Its fluid, past a flag that is a wall."""
    scene = whole_scene()
    for name in ("solid", "mover"):
        del scene[name]
    del scene["time"]["solid"]
    scene["fluid"]["boundary"][1]["on"] = ["top", "bottom", "cylinder", "flag"]
    scene["quantities"] = {}
    return scene


def moving_scene(mover: Scene | None = None) -> Scene:
    """The same past a flag that is carried up and down by 1 mm."""
    scene = fluid_scene()
    scene["fluid"]["boundary"][1]["on"] = ["top", "bottom", "cylinder"]
    scene["fluid"]["boundary"].append({"on": "flag", "type": "no-slip"})
    scene["motion"] = [{"on": "flag", "x": 0, "y": "1e-3*sin(20*pi*t)*(x - 0.2489)/0.35"}]
    scene["mover"] = mover or {"type": "barrier"}
    return scene


def solid_scene(model: str, load: float) -> Scene:
    """The flag alone under its weight, with the elements of CSM1."""
    scene = tomllib.loads((ROOT / "examples" / "csm1.toml").read_text(encoding="utf-8"))
    scene["output"] = {"fields": False, "plots": False}
    scene["time"] = {"dt": 0.005, "end": 5.0}
    scene["solid"][0] |= {"model": model, "gravity": [0.0, -load]}
    return scene


def laminar_scene() -> Scene:
    """CFD1: the same channel and flag at Re = 20."""
    scene = tomllib.loads((ROOT / "examples" / "cfd1.toml").read_text(encoding="utf-8"))
    scene["output"] = {"fields": False, "plots": False}
    return scene


def changed(scene: Scene, **tables: Mapping[str, object]) -> Scene:
    """A copy of a scene with other entries in its tables."""
    new = copy.deepcopy(scene)
    for name, entries in tables.items():
        new[name] = {**new.get(name, {}), **entries}
    return new


def bare(problem: Problem) -> Steps:
    """Steps of the fluid's solver without time loop, mesh, coupling and records."""
    assert problem.fluid is not None
    solver, mesh, dt = problem.fluid.solver, problem.fluid.mesh, problem.case.time.dt  # type: ignore[union-attr]
    state, sizes = solver.initial_state(0.0), [dt]
    convection = solver.fluid.convection_of_steps(None)
    nobody = np.zeros((0, 2))
    for n in range(1, 10**9):
        step = solver.begin_step(state, mesh.points, sizes, n * dt, convection=convection)
        step.solve(nobody)
        state, sizes = step.accept(), [dt, *sizes][:3]
        yield state


def written(problem: Problem) -> Steps:
    """Steps whose fields are written, each of them."""
    with TemporaryDirectory() as folder:
        writer = FieldWriter(problem, Path(folder), 1)
        for record in simulate(problem):
            writer.observe(record)
            yield record
        writer.close()


def pairs() -> list[Pair]:
    """All of them."""
    whole, fluid, moving = whole_scene(), fluid_scene(), moving_scene()
    still = Side("fluid past a rigid flag", fluid)
    coupled = Side("FSI3", whole)
    # A rule for two vertices of the wake that leaves them where they are: all others that are not driven stand, too.
    far = moving_scene({"type": "rule", "vertex": [{"names": ["r1t", "r1b"], "x": 0, "y": 0}]})
    stokes = changed(fluid, fluid={"model": "stokes"})
    newton = changed(fluid, fluid={"convection": "newton"})
    constant = ("fluid.geometries", "fluid.constant_assemblies")
    work = ("fluid.factorisations", "fluid.iterations")
    return [
        Pair("time loop, mesh and coupling beside the solver", Side("floor", fluid, bare), still, constant),
        Pair("a moving mesh", still, Side("the flag carried up and down", moving), constant),
        Pair("a solid and its coupling", Side("the flag carried up and down", moving), coupled, work),
        Pair("convection", Side("Stokes", stokes), still, work),
        Pair(
            "convection that makes no energy",
            still,
            Side('convection_form = "skew-symmetric"', changed(fluid, fluid={"convection_form": "skew-symmetric"})),
            work,
        ),
        Pair(
            "steps in time",
            Side("CFD1, steady", laminar_scene()),
            Side("60 steps of 0.5 s", {**laminar_scene(), "time": {"dt": 0.5, "steps": 60}}),
            work,
            whole=True,
        ),
        Pair("Newton's iteration of the fluid", still, Side('convection = "newton"', newton), work),
        Pair(
            "refactoring in every iteration",
            Side("linear.lag", newton),
            Side("linear.lag = false", changed(newton, linear={"lag": False})),
            work,
        ),
        Pair(
            "a nonlinear solid",
            Side("linear flag", solid_scene("linear", 2.0)),
            Side("St. Venant–Kirchhoff", solid_scene("st-venant-kirchhoff", 2.0)),
            ("solid.factorisations", "solid.iterations"),
        ),
        Pair(
            "blocks that the mover moves",
            Side("those at the flag only", far),
            Side("all", moving),
            ("fluid.elements_kept", "blocks_regenerated"),
        ),
        Pair(
            "a mesh in every coupling iteration",
            coupled,
            Side('geometry = "implicit"', changed(whole, coupling={"geometry": "implicit"})),
            ("fluid.geometries", "fluid.factorisations", "coupling_iterations"),
        ),
        Pair(
            "iterations between fluid and solid",
            coupled,
            Side("coupling.condensed = false", changed(whole, coupling={"condensed": False})),
            ("coupling_iterations", "solid.factorisations"),
        ),
        Pair("field files", coupled, Side("written in every step", whole, written)),
    ]


def measure(pair: Pair, steps: int) -> dict[str, object]:
    """Take the steps of both runs in turn."""
    runs = [Run(side) for side in (pair.without, pair.having)]
    if pair.whole:
        return row(pair, runs, *(run.to_the_end() for run in runs))
    taken = np.empty((steps + _WARM, 2))
    for k in range(len(taken)):
        for side in (0, 1) if k % 2 else (1, 0):  # who comes second finds the processor as the first has left it
            taken[k, side] = runs[side].timed()
    return row(pair, runs, *np.quantile(taken[_WARM:], _LEAST, axis=0))


def row(pair: Pair, runs: Sequence[Run], without: float, having: float) -> dict[str, object]:
    """What is told of a pair, of the seconds of both runs."""
    return {
        "need": pair.need,
        "without": pair.without.name,
        "with": pair.having.name,
        "ms without": 1e3 * without,
        "ms with": 1e3 * having,
        "ratio": float(having / without),
        "counts without, with": "; ".join(
            f"{name} " + " / ".join(str(run.count(name)) for run in runs) for name in pair.counts
        ),
    }


class Run:
    """One side of a pair, as far as it has come."""

    def __init__(self, side: Side) -> None:
        self._problem = build(read_case(copy.deepcopy(side.scene), side.name))
        self._steps = side.steps(self._problem)
        self._sums = {"coupling_iterations": 0, "blocks_regenerated": 0}

    def timed(self) -> float:
        """Take a step and return its seconds."""
        began = process_time()
        record = next(self._steps)
        spent = process_time() - began
        if isinstance(record, StepRecord):
            if record.coupling is not None:
                self._sums["coupling_iterations"] += record.coupling.iterations
            if record.state.mesh is not None:
                self._sums["blocks_regenerated"] += record.state.mesh.regenerated
        return spent

    def to_the_end(self) -> float:
        """Take all steps and return their seconds."""
        began = process_time()
        for _ in self._steps:
            pass
        return process_time() - began

    def count(self, name: str) -> int:
        """A sum over the steps, or a count of the fluid or the solid."""
        part, _, count = name.partition(".")
        return int(getattr(self._problem.counts[part], count)) if count else self._sums[name]


def main(argv: Sequence[str] | None = None) -> Result:
    """Measure all pairs."""
    options = parser(__doc__)
    options.add_argument("--steps", type=int, default=40, help="of each run (default: %(default)s)")
    options.add_argument("--quick", action="store_true", help="6 steps")
    options.add_argument("--needs", nargs="+", metavar="WORD", help="only pairs whose need has one of these words")
    asked = options.parse_args(argv)
    steps = 6 if asked.quick else asked.steps
    some = [pair for pair in pairs() if not asked.needs or any(word in pair.need for word in asked.needs)]
    return report(Result("skipping", {"steps": steps}, [measure(pair, steps) for pair in some]), asked.json)


if __name__ == "__main__":
    main()
