"""Do block vertices move as smoothly as the body? Their acceleration as dt is halved, and what makes the paper's noisy.

The flap of WR swings as A sin(2πt), tip ±1.3 cm. Over the second period the ratio of the largest second difference of a
vertex to the largest of an interface node is taken. A smooth mesh is a function of the interface: its ratio does not
depend on dt. The published optimisation's grows; each of its causes is removed in turn.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from _result import ROOT, Result, parser, report
from hoblock import HoblockError
from hoblock.motion import MeshMotion
from hoblock.movers import AngleOptimisation, BarrierEnergy, Mover, PseudoSolid
from motion_cases import MotionCase, motion_case
from motion_contest.journey import MARKS

Array = NDArray[np.float64]


def _published(**changes: object) -> Callable[[MotionCase], Mover]:
    return lambda case: AngleOptimisation.as_published(case.structure, case.driven, **changes)  # type: ignore[arg-type]


MOVERS: dict[str, Callable[[MotionCase], Mover]] = {
    "barrier, bar": lambda case: BarrierEnergy(case.structure, case.driven, edges=case.edges),
    "barrier, ang": lambda case: BarrierEnergy(case.structure, case.driven, edges=case.edges, energy="ang"),
    "pseudo-solid, m = -1": lambda case: PseudoSolid(case.structure, case.driven),
    "pseudo-solid, m = 1": lambda case: PseudoSolid(case.structure, case.driven, exponent=1.0),
    "angles, published": _published(),
    "published, no radius": _published(radius=1e6),
    "published, 20 sweeps": _published(sweeps=20),
    "published, 20 sweeps, no radius": _published(radius=1e6, sweeps=20),
    "published, n = 1": _published(power=1),
    "published, n = 1, 20 sweeps": _published(power=1, sweeps=20),
    "angles, best setting": lambda case: AngleOptimisation(case.structure, case.driven),
}


def swing(case: MotionCase, mover: Mover, amplitude: float, order: int, steps: int) -> tuple[Array, Array]:
    """Free vertices and driven nodes over two periods, (2 steps + 1, …, 2)."""
    motion = MeshMotion(case.structure, order, case.edges, mover, halvings=0)
    state = motion.start()
    x = motion.reference.positions
    vertices, nodes = [state.vertices[mover.free]], [state.positions]
    for s in amplitude * np.sin(2.0 * np.pi * np.arange(1, 2 * steps + 1) / steps):
        state = motion.move(state, case.motion(x, s))
        vertices.append(state.vertices[mover.free])
        nodes.append(state.positions)
    return np.stack(vertices), np.stack(nodes)


def largest_acceleration(path: Array, dt: float) -> float:
    """Largest second difference over the second half of a path (k, n, 2)."""
    second = np.diff(path[len(path) // 2 :], n=2, axis=0) / dt**2
    return float(np.hypot(second[..., 0], second[..., 1]).max())


def velocity_error(case: MotionCase, amplitude: float, order: int, energy: str) -> float:
    """Largest difference of the barrier's exact vertex velocity from differences of order four, relative to it."""
    mover = BarrierEnergy(case.structure, case.driven, edges=case.edges, energy=energy)
    motion = MeshMotion(case.structure, order, case.edges, mover)
    x, start = motion.reference.positions, motion.start()
    worst, h = 0.0, 1e-3
    rows = motion.driven.end_rows(mover.tangent_edges)
    for t in np.linspace(0.02, 0.98, 9):
        positions = [case.motion(x, amplitude * np.sin(2.0 * np.pi * (t + k * h))) for k in (-2, -1, 0, 1, 2)]
        weights = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * h)
        states = [motion.move(start, p) for p in positions]
        tangents = [motion.driven.tangents(p, rows) for p in positions]
        difference, driven, turning = (
            np.tensordot(weights, np.stack(values), axes=1)
            for values in ([s.vertices for s in states], [p[motion.driven.vertex_rows] for p in positions], tangents)
        )
        exact = mover.velocity(states[2].vertices, driven, tangents[2], turning)
        worst = max(worst, float(np.abs(exact - difference).max() / np.abs(difference).max()))
    return worst


def draw(series: dict[str, tuple[Array, float]], file: Path) -> Path:
    """Accelerations of the vertex that is worst, over the second period, in terms of the interface's largest."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 2.1 * len(series)), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (name, (values, dt)) in zip(
        np.atleast_1d(figure.subplots(len(series), sharex=True)), series.items(), strict=True
    ):
        axes.plot(1.0 + dt * np.arange(len(values)), values, linewidth=0.8)
        axes.set_title(name, fontsize=9)
        axes.grid(alpha=0.3)
    figure.supxlabel("t in periods")
    figure.supylabel("vertical acceleration of a vertex, in terms of the interface's largest")
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=130)
    return file


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--steps", type=int, default=60, help="in a period, first; halved dt after (default: 60)")
    options.add_argument("--halvings", type=int, default=4)
    options.add_argument("--order", type=int, default=4)
    options.add_argument("--layout", default="f4", choices=["f4", "f1"])
    options.add_argument("--picture", type=Path, default=ROOT / "results" / "mesh_motion_smoothness.png")
    given = options.parse_args(argv)
    case = motion_case("WR", given.layout, 2)
    amplitude = MARKS["WR"]
    rows: list[dict[str, object]] = []
    series: dict[str, tuple[Array, float]] = {}
    for name, make in MOVERS.items():
        row: dict[str, object] = {"mover": name}
        for k in range(given.halvings + 1):
            steps = given.steps * 2**k
            try:
                vertices, nodes = swing(case, make(case), amplitude, given.order, steps)
            except HoblockError as error:
                row[f"dt = 1/{steps}"] = type(error).__name__
                continue
            interface = largest_acceleration(nodes, 1.0 / steps)
            row[f"dt = 1/{steps}"] = largest_acceleration(vertices, 1.0 / steps) / interface
            if k == min(2, given.halvings) and name in ("barrier, bar", "pseudo-solid, m = -1", "angles, published"):
                second = np.diff(vertices[steps:], n=2, axis=0)[..., 1] * steps**2 / interface
                worst = int(np.abs(second).max(axis=0).argmax())
                series[f"{name}, {steps} steps a period"] = second[:, worst], 1.0 / steps
        row["velocity error"] = (
            velocity_error(case, amplitude, given.order, name[-3:]) if name.startswith("barrier") else ""
        )
        rows.append(row)
    print(draw(series, given.picture))
    settings = {name: getattr(given, name) for name in ("steps", "halvings", "order", "layout")}
    return report(Result("mesh_motion_smoothness", settings, rows), given.json)


if __name__ == "__main__":
    main()
