"""Direct and iterative solution of the fluid's linear systems: iterations, seconds and memory against size and order.

The mesh is that of examples/dfg_2d_1.toml with k, 2k and 6k elements along its blocks, or one of the scenes named by
``--scene`` with all its numbers of elements multiplied. Every row is measured in a process of its own.

Problems: "stokes", the steady Stokes equations; "newton", the steady flow by Newton's method from rest; "step", steps
at five times the inflow (Re = 100 in the DFG channel) from a parabolic profile, each linear, solved to 1e-10: the
first, with all that it needs, and the third, perhaps with a preconditioner that is kept.
"""

from __future__ import annotations

import re
import resource
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from time import process_time

import numpy as np

from _result import ROOT, Result, parser, report
from hofsi import build, load_case
from hofsi.errors import LinearSolverError
from hofsi.solvers.fluid import FluidSolver

NOBODY = np.zeros((0, 2))
PROBLEMS = ("stokes", "newton", "step 0.01", "step 0.001")


def scene_settings(scene: str, k: int) -> list[str]:
    """Multiply the numbers of elements of a scene, those of the channel by k / 2."""
    text = (ROOT / "examples" / scene).read_text(encoding="utf-8")
    counts = [int(number) for number in re.findall(r"^elements *= *(\d+)", text, re.MULTILINE)]
    factor = k / counts[0] if scene == "dfg_2d_1.toml" else k
    return [f"mesh.count[{entry}].elements={round(factor * count)}" for entry, count in enumerate(counts)]


def fluid_solver(scene: str, order: int, k: int, problem: str, solver: str, extra: Sequence[str]) -> FluidSolver:
    """The fluid of a scene, with the model and inflow of a problem."""
    settings = [f"mesh.order={order}", f"linear.solver={solver}", *scene_settings(scene, k), *extra]
    if problem == "stokes":
        settings.append('fluid.model="stokes"')
    if problem.startswith("step"):
        constants = re.search(r"^U = ([0-9.]+)", (ROOT / "examples" / scene).read_text(encoding="utf-8"), re.MULTILINE)
        assert constants is not None
        settings += [f"constants.U={5.0 * float(constants[1])}"]
    return build(load_case(ROOT / "examples" / scene, settings)).fluid.solver


def held(solver: FluidSolver) -> np.ndarray:
    """Velocity of the nodes that a solid would prescribe."""
    return np.zeros((len(solver.boundary.interface), 2))


def steady(solver: FluidSolver) -> dict[str, object]:
    """Solve the steady problem, and say what that took."""
    points = solver.mesh.points
    step = solver.begin_steady(solver.initial_state(), points)
    start = process_time()
    step.solve(held(solver))
    seconds = process_time() - start
    solves = solver.counts.solves
    return {"solves": solves, "iterations": solver.counts.linear_iterations / solves, "solve s": seconds}


def stepped(solver: FluidSolver, dt: float) -> dict[str, object]:
    """Make three linear steps from a parabolic profile, and say what the first and the third took."""
    points, made, seconds, iterations = solver.mesh.points, [], [], []
    state = solver.initial_state()
    low, high = points[:, 1].min(), points[:, 1].max()
    y = (points[:, 1] - low) / (high - low)
    inflow = solver.boundary.impose(np.zeros(points.shape), points, np.zeros(points.shape), held(solver), 0.0)
    profile = np.stack([4.0 * inflow[:, 0].max() * y * (1.0 - y), np.zeros(len(y))], axis=-1)
    state = type(state)((profile,), state.pressure, state.points, state.reaction, state.time)
    for number in range(3):
        made.insert(0, dt)
        before = solver.counts.linear_iterations
        start = process_time()
        step = solver.begin_step(state, points, made, dt * (number + 1), convection="extrapolated")
        step.solve(held(solver))
        state = step.accept()
        seconds.append(process_time() - start)
        iterations.append(solver.counts.linear_iterations - before)
    return {
        "solves": 1,
        "iterations": float(iterations[0]),
        "solve s": seconds[0],
        "third: iterations": float(iterations[2]),
        "third: s": seconds[2],
    }


def measure(scene: str, order: int, k: int, problem: str, solver: str, extra: Sequence[str] = ()) -> dict[str, object]:
    """One row; to be called in a process of its own."""
    fluid = fluid_solver(scene, order, k, problem, solver, extra)
    points = fluid.mesh.points
    start = process_time()
    system = fluid.system(points)
    system.prepare()
    row: dict[str, object] = {
        "scene": scene.removesuffix(".toml"),
        "order": order,
        "k": k,
        "unknowns": fluid.space.size,
        "condensed": len(system.unknowns),
        "problem": problem,
        "solver": solver,
        "prepare s": process_time() - start,
    }
    nothing: dict[str, object] = {"solves": 0, "iterations": None, "solve s": None}
    try:
        found = stepped(fluid, float(problem.split()[1])) if problem.startswith("step") else steady(fluid)
    except (LinearSolverError, MemoryError) as error:
        found = nothing
        print(f"{row}: {error}", flush=True)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    row |= {"third: iterations": None, "third: s": None} | found
    return row | {"preconditioners": fluid.counts.preconditioners, "peak GiB": peak}


def alone(*what: object) -> dict[str, object]:
    """`measure` in a new process."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(measure, *what).result()  # type: ignore[arg-type]


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--scene", default="dfg_2d_1.toml")
    options.add_argument("--orders", type=int, nargs="+", default=[2, 4])
    options.add_argument("--k", type=int, nargs="+", default=[4, 8], help="numbers of elements (default: %(default)s)")
    options.add_argument("--problems", nargs="+", default=list(PROBLEMS))
    options.add_argument("--solvers", nargs="+", default=["direct", "amg"])
    options.add_argument("--set", nargs="+", default=[], metavar="KEY=VALUE", help="settings of the scene")
    chosen = options.parse_args(argv)
    rows = []
    for order in chosen.orders:
        for k in chosen.k:
            for problem in chosen.problems:
                for solver in chosen.solvers:
                    rows.append(alone(chosen.scene, order, k, problem, solver, tuple(chosen.set)))
                    print({name: rows[-1][name] for name in rows[-1] if name != "scene"}, flush=True)
    settings = {"scene": chosen.scene, "set": chosen.set}
    path = chosen.json or Path(ROOT / "results" / "fluid_linear_solvers.json")
    return report(Result("fluid_linear_solvers", settings, rows), path)


if __name__ == "__main__":
    main()
