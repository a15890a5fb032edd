"""Orders of convergence of coupled problems: exact waves in space and in time, and a flap in a channel in time.

Solutions and scenes are those of benchmarks/exact_fsi.
"""

from __future__ import annotations

from collections.abc import Sequence

from _result import Result, parser, report
from exact_fsi.settings import SCHEMES
from exact_fsi.study import IN_SPACE, IN_TIME, flap_series, in_space, in_time, observed_of_flap

GEOMETRIES = ("extrapolated", "implicit")


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--orders", type=int, nargs="*", default=[2, 3, 4, 5], help="in space (default: 2 to 5)")
    options.add_argument("--cases", nargs="*", choices=list(IN_TIME), default=list(IN_TIME), help="in time (all)")
    options.add_argument(
        "--geometries", nargs="+", choices=GEOMETRIES, default=list(GEOMETRIES), help="both by default"
    )
    options.add_argument("--schemes", nargs="+", choices=SCHEMES, default=list(SCHEMES), help="of the solid (all)")
    options.add_argument("--steps", type=int, nargs=2, help="in time (default: by case)")
    options.add_argument("--flap", type=int, nargs=3, help="steps of the flap and of its reference, as 40 80 320")
    given = options.parse_args(argv)
    rows = []
    for case in IN_SPACE:
        for order in given.orders:
            found = in_space(case, order)
            rows.append(_row(f"{case}, p = {order}", "", "bdf2", vars(found.errors), vars(found.orders)))
    variants = [(geometry, scheme) for geometry in given.geometries for scheme in given.schemes]
    steps = tuple(given.steps) if given.steps else None
    for case in given.cases:
        for geometry, scheme in variants:
            found = in_time(case, geometry, scheme, steps)
            rows.append(_row(f"{case}, in time", geometry, scheme, vars(found.errors), vars(found.orders)))
    if given.flap:
        *counts, many = given.flap
        reference = flap_series(many)
        for geometry, scheme in variants:
            series = [flap_series(count, geometry, scheme) for count in counts]
            (ux, uy, fx, fy), orders = observed_of_flap(series, reference)
            errors = {"displacement": max(ux, uy), "load": max(fx, fy)}
            least = {"displacement": min(orders[:2]), "load": min(orders[2:])}
            rows.append(_row("flap, in time", geometry, scheme, errors, least))
    return report(Result("fsi_order", {**vars(given), "json": None}, rows), given.json)


def _row(
    case: str, geometry: str, scheme: str, errors: dict[str, float], orders: dict[str, float]
) -> dict[str, object]:
    row: dict[str, object] = {"case": case, "geometry": geometry, "scheme": scheme}
    for name in ("displacement", "velocity", "load"):
        row[name] = float(errors[name]) if name in errors else ""
        row[f"{name} order"] = float(orders[name]) if name in orders else ""
    print(row, flush=True)
    return row


if __name__ == "__main__":
    main()
