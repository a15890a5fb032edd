"""Does a mesh come back? A body moves to and fro for many cycles; how far from its first place a block vertex ends.

The flap of WR with its tip between ±1.3 cm, and the block of T4b between ±60°. "cold - warm" is the largest difference
on the way between a move from the last state and one from the reference: 0 where a position has one mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from _result import Result, parser, report
from hoblock import HoblockError
from hoblock.motion import MeshMotion
from hoblock.movers import AngleOptimisation, BarrierEnergy, Mover, PseudoSolid
from motion_cases import MotionCase, motion_case
from motion_contest.journey import MARKS

TESTS = (("WR", "f4", MARKS["WR"]), ("WR", "f1", MARKS["WR"]), ("T4b", "cross24", 60.0), ("T4b", "O10r3", 60.0))
MOVERS: dict[str, Callable[[MotionCase], Mover]] = {
    "barrier, bar": lambda case: BarrierEnergy(case.structure, case.driven, edges=case.edges),
    "barrier, bar, sliding": lambda case: BarrierEnergy(
        case.structure, case.driven, edges=case.edges, sliding=case.sliding
    ),
    "barrier, ang": lambda case: BarrierEnergy(case.structure, case.driven, edges=case.edges, energy="ang"),
    "pseudo-solid, m = -1": lambda case: PseudoSolid(case.structure, case.driven),
    "pseudo-solid, m = 1": lambda case: PseudoSolid(case.structure, case.driven, exponent=1.0),
    "pseudo-solid, m = -1, incremental": lambda case: PseudoSolid(case.structure, case.driven, incremental=True),
    "angles, published": lambda case: AngleOptimisation.as_published(case.structure, case.driven),
    "angles, best setting": lambda case: AngleOptimisation(case.structure, case.driven),
}


def there_and_back(
    case: MotionCase, mover: Mover, amplitude: float, order: int, cycles: int, steps: int
) -> dict[str, object]:
    """Distance of the vertices from their first places, by the number of cycles."""
    motion = MeshMotion(case.structure, order, case.edges, mover, halvings=0)
    first = state = motion.start()
    x = motion.reference.positions
    row: dict[str, object] = {}
    gap, bound = 0.0, np.inf
    for cycle in range(1, cycles + 1):
        for s in amplitude * np.sin(2.0 * np.pi * np.arange(1, steps + 1) / steps):
            try:
                state = motion.move(state, case.motion(x, s))
            except HoblockError as error:
                return {**row, f"after {cycles}": f"{type(error).__name__} in cycle {cycle}"}
            bound = min(bound, state.min_det_J)
            if cycle == 1 and not mover.depends_on_state:
                cold = motion.move(first, state.positions)
                gap = max(gap, float(np.abs(cold.vertices - state.vertices).max()))
        if cycle in (1, 10, cycles):
            row[f"after {cycle}"] = float(np.abs(state.vertices - first.vertices).max())
    row["cold - warm"] = "" if mover.depends_on_state else gap
    row["mesh, after all"] = float(np.abs(state.mesh.points - first.mesh.points).max())
    row["least det J bound"] = bound
    return row


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--cycles", type=int, default=50)
    options.add_argument("--steps", type=int, default=60, help="in a cycle (default: %(default)s)")
    options.add_argument("--order", type=int, default=4)
    options.add_argument("--elements", type=int, default=2, help="along each block edge (default: %(default)s)")
    given = options.parse_args(argv)
    rows: list[dict[str, object]] = []
    for test, layout, amplitude in TESTS:
        case = motion_case(test, layout, given.elements)
        for name, make in MOVERS.items():
            row = there_and_back(case, make(case), amplitude, given.order, given.cycles, given.steps)
            rows.append({"test": test, "layout": layout, "mover": name, **row})
    columns = list(dict.fromkeys(key for row in rows for key in row))
    settings = {name: getattr(given, name) for name in ("cycles", "steps", "order", "elements")}
    return report(
        Result("mesh_motion_return", settings, [{k: row.get(k, "") for k in columns} for row in rows]), given.json
    )


if __name__ == "__main__":
    main()
