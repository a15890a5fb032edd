"""Orders of convergence in space of exact flows on moving meshes: blocks made anew beside meshes moved as solids.

Flows and meshes are those of benchmarks/manufactured_flows. Both kinds of meshes follow the same boundary.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import process_time

from _result import Result, parser, report
from manufactured_flows.study import ELEMENTS, MESHES, in_space


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--flows", nargs="+", choices=list(ELEMENTS), default=list(ELEMENTS), help="both by default")
    options.add_argument("--meshes", nargs="+", choices=list(MESHES), default=list(MESHES), help="all by default")
    options.add_argument("--orders", type=int, nargs="+", default=[2, 3, 4, 5, 6], help="(default: 2 to 6)")
    options.add_argument("--elements", type=int, nargs=2, help="along each block edge (default: by order)")
    given = options.parse_args(argv)
    elements = tuple(given.elements) if given.elements else None
    rows = []
    for flow in given.flows:
        for mesh in given.meshes:
            for order in given.orders:
                start = process_time()
                found = in_space(flow, order, mesh, elements=elements)
                coarse, fine = elements or ELEMENTS[flow][order]
                rows.append(
                    {
                        "flow": flow,
                        "mesh": mesh,
                        "order": order,
                        "elements": f"{coarse}, {fine}",
                        "velocity": found.velocity[1],
                        "velocity order": found.velocity_order,
                        "pressure": found.pressure[1],
                        "pressure order": found.pressure_order,
                        "seconds": process_time() - start,
                    }
                )
                print(rows[-1], flush=True)
    settings = {"flows": given.flows, "meshes": given.meshes, "orders": given.orders, "elements": given.elements}
    return report(Result("fluid_order", settings, rows), given.json)


if __name__ == "__main__":
    main()
