"""All methods of mesh motion on all tests: largest reach with certified validity, quality on the way, time an update.

The tests are defined in docs/meshing/mesh_motion_tests.md. A body moves in equal steps until the first mesh that is not
certified. Written: a table for every test, JSON, and one picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from _result import ROOT, Result, parser, report
from motion_cases import CASES, motion_case
from motion_contest import travel
from motion_contest.contestants import CONTESTANTS, chosen


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--orders", type=int, nargs="+", default=[4], help="(default: 4)")
    options.add_argument("--steps", type=int, default=60, help="over the range of a test (default: %(default)s)")
    options.add_argument("--elements", type=int, default=4, help="along each block edge (default: %(default)s)")
    options.add_argument("--tests", nargs="+", metavar="TEST", help="such as T3b or WR; all by default")
    options.add_argument("--layouts", nargs="+", metavar="LAYOUT", help="such as cross4x; all by default")
    families = sorted({one.family for one in CONTESTANTS})
    options.add_argument("--families", nargs="+", choices=families, help="all by default")
    options.add_argument("--movers", nargs="+", metavar="WORD", help="those with one of these words in their names")
    options.add_argument("--limit", type=float, default=120.0, help="processor seconds a run (default: %(default)s)")
    options.add_argument("--picture", type=Path, default=ROOT / "results" / "mesh_motion.png")
    given = options.parse_args(argv)
    rows = []
    for test, layout in CASES:
        if (given.tests and test not in given.tests) or (given.layouts and layout not in given.layouts):
            continue
        case = motion_case(test, layout, given.elements)
        for order in given.orders:
            for one in chosen(given.families, given.movers):
                trip = travel(case, order, one, given.steps, given.limit)
                row: dict[str, object] = {"test": test, "layout": layout, "end": case.end, "order": order}
                row |= {"family": one.family, "mover": one.name}
                row |= {name.replace("_", " "): "" if value != value else value for name, value in vars(trip).items()}
                if test in ("WR", "TH"):
                    row["tip"] = case.tip(trip.reach)
                rows.append({"tip": "", **row} if "tip" not in row else row)
                print(
                    f"{test} {layout} p = {order} {one.name}: {trip.reach:.4g} of {case.end:g} ({trip.outcome})",
                    flush=True,
                )
    names = ("orders", "steps", "elements", "limit")
    columns = list(rows[0])
    result = Result(
        "mesh_motion", {k: getattr(given, k) for k in names}, [{k: row[k] for k in columns} for row in rows]
    )
    if len(given.orders) == 1:
        from motion_contest.picture import draw_reaches

        print(draw_reaches(rows, given.picture))
    return report(result, given.json)


if __name__ == "__main__":
    main()
