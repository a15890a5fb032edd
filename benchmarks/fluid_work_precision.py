"""DFG 2D-1, steady flow past a cylinder at Re = 20: errors of drag, lift and pressure difference against time.

The scene is examples/dfg_2d_1.toml with k, 2k and 6k elements along its blocks. Reference: FeatFlow (TU Dortmund).
"""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter

from _result import ROOT, Result, parser, report
from hofsi import build, evaluators, load_case, simulate

REFERENCE = {"c_D": 5.57953523384, "c_L": 0.010618948146, "dp": 0.11752016697}


def measure(order: int, k: int) -> dict[str, object]:
    counts = [f"mesh.count[{entry}].elements={factor * k}" for entry, factor in enumerate((1, 2, 6))]
    start = perf_counter()
    problem = build(load_case(ROOT / "examples" / "dfg_2d_1.toml", [f"mesh.order={order}", *counts]))
    built = perf_counter()
    (record,) = simulate(problem)
    found = {name: evaluate(record) for name, evaluate in evaluators(problem).items()}
    stop = perf_counter()
    row: dict[str, object] = {
        "order": order,
        "k": k,
        "elements": 48 * k**2,
        "velocity nodes": record.state.fluid.velocity.shape[0],
        "build s": built - start,
        "solve s": stop - built,
    }
    return row | {f"error of {name}": abs(found[name] - value) for name, value in REFERENCE.items()}


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--orders", type=int, nargs="+", default=[2, 3, 4, 6, 8])
    options.add_argument("--k", type=int, nargs="+", default=[1, 2], help="numbers of elements (default: %(default)s)")
    chosen = options.parse_args(argv)
    measure(2, 1)  # imports what the solver needs
    rows = [measure(order, k) for k in chosen.k for order in chosen.orders]
    return report(Result("fluid_work_precision", {"reference": REFERENCE}, rows), chosen.json)


if __name__ == "__main__":
    main()
