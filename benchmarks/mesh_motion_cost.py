"""What an update of the mesh costs: block movers with regeneration and certificate, and full-mesh methods, in one run.

The flap of WR makes a small step: block movers near the benchmark's largest deflection, full-mesh methods near the
start, where all of them are valid. Each time is the shortest of several.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from numpy import linspace, setdiff1d

from _result import Result, fastest, parser, report
from full_mesh_movers import Biharmonic, Elastic, FullMeshMover, InverseDistance, Laplace, NeoHooke, RadialBasis
from hoblock import QuadMesh, certify, generate
from hoblock.motion import MeshMotion, driven_edges
from hoblock.movers import AngleOptimisation, BarrierEnergy, Mover, PseudoSolid
from motion_cases import MotionCase, motion_case
from motion_contest.contestants import boundary_nodes
from motion_contest.journey import MARKS

BLOCKS: dict[str, Callable[[MotionCase], Mover]] = {
    "barrier, bar": lambda case: BarrierEnergy(case.structure, case.driven, edges=case.edges),
    "barrier, bar, sliding": lambda case: BarrierEnergy(
        case.structure, case.driven, edges=case.edges, sliding=case.sliding
    ),
    "pseudo-solid": lambda case: PseudoSolid(case.structure, case.driven),
    "angles, published": lambda case: AngleOptimisation.as_published(case.structure, case.driven),
    "angles, best setting": lambda case: AngleOptimisation(case.structure, case.driven),
}
FULL: dict[str, Callable[..., FullMeshMover]] = {
    "full-mesh pseudo-solid, refactored": lambda *a: Elastic(*a, cached=False),
    "full-mesh pseudo-solid, cached factor": Elastic,
    "full-mesh pseudo-solid, incremental": lambda *a: Elastic(*a, exponent=-1.5, incremental=True),
    "full-mesh Laplace, cached factor": Laplace,
    "full-mesh biharmonic, cached factor": Biharmonic,
    "full-mesh biharmonic, incremental": lambda *a: Biharmonic(*a, incremental=True),
    "full-mesh RBF, cached factor": RadialBasis,
    "full-mesh RBF, incremental": lambda *a: RadialBasis(*a, incremental=True),
    "full-mesh IDW, cached weights": InverseDistance,
    "full-mesh neo-Hooke": NeoHooke,
}


def block_rows(case: MotionCase, order: int, repeats: int) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = []
    for name, make in BLOCKS.items():
        setup = fastest(lambda make=make: make(case), 2)
        motion = MeshMotion(case.structure, order, case.edges, make(case), halvings=0)
        x = motion.reference.positions
        before = motion.start()
        for s in linspace(0.0, 0.97 * MARKS["WR"], 31):
            before = motion.move(before, case.motion(x, s))
        positions = case.motion(x, MARKS["WR"])
        total = fastest(lambda m=motion, b=before, p=positions: m.move(b, p), repeats)
        certificate = fastest(lambda m=motion, b=before: certify(m.certified_part(b.mesh)), repeats)
        rows.append(
            {
                "method": name,
                "nodes": len(motion.reference.mesh.points),
                "set-up s": setup,
                "move and regenerate ms": 1e3 * (total - certificate),
                "certificate ms": 1e3 * certificate,
                "all ms": 1e3 * total,
            }
        )
    return rows


def full_row(
    name: str, make: Callable[..., FullMeshMover], case: MotionCase, mesh: QuadMesh, repeats: int
) -> dict[str, object]:
    driven = driven_edges(case.structure, mesh.order, case.edges).nodes
    fixed = setdiff1d(boundary_nodes(case, mesh.order), driven)
    mover: list[FullMeshMover] = []
    setup = fastest(lambda: mover.append(make(mesh, driven, fixed)), 1)
    x = mesh.points[driven]
    small = 0.02 * MARKS["WR"]  # where every method's mesh is valid
    before = mover[0].move(mesh.points, case.motion(x, small))
    positions = case.motion(x, 0.03 * MARKS["WR"] + small)
    move = fastest(lambda: mover[0].move(before, positions), repeats)
    certificate = fastest(lambda: certify(mesh), repeats)
    return {
        "method": name,
        "nodes": len(mesh.points),
        "set-up s": setup,
        "move and regenerate ms": 1e3 * move,
        "certificate ms": 1e3 * certificate,
        "all ms": 1e3 * (move + certificate),
    }


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument(
        "--elements", type=int, nargs="+", default=[2, 11], help="along each block edge: 4e3, 1e5 nodes"
    )
    options.add_argument("--order", type=int, default=4)
    options.add_argument("--repeats", type=int, default=30)
    given = options.parse_args(argv)
    rows: list[dict[str, object]] = []
    for elements in given.elements:
        case = motion_case("WR", "f4", elements)
        mesh = generate(case.structure, given.order)
        some = block_rows(case, given.order, given.repeats)
        for name, make in FULL.items():
            some.append(full_row(name, make, case, mesh, max(1, min(given.repeats, 3 if elements > 4 else 5))))
        barrier = some[0]
        for row in some:
            for key in ("all ms", "move and regenerate ms"):
                row[f"{key[:-3]}, barriers"] = float(row[key]) / float(barrier[key])  # type: ignore[arg-type]
        rows += some
    settings = {name: getattr(given, name) for name in ("elements", "order", "repeats")}
    return report(Result("mesh_motion_cost", settings, rows), given.json)


if __name__ == "__main__":
    main()
