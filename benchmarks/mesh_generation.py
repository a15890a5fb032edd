"""Time to generate and to regenerate a mesh, against a plain copy of its points."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from time import perf_counter

import numpy as np

from _result import Result, fastest, parser, report
from hoblock import BlockStructure, Exponential, generate, regenerate
from hoblock.generate import raise_if_invalid


def structure_of(side: int, count: int, different: bool) -> BlockStructure:
    """A square of side × side blocks with count × count elements each, lines bent; opposite gradings equal or not."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, side + 1), np.linspace(0.0, 1.0, side + 1))
    bent = np.stack([x + 0.1 * np.sin(3.0 * y), y + 0.1 * np.sin(3.0 * x)], axis=-1).reshape(-1, 2)
    row = side + 1
    corner = [j * row + i for j in range(side) for i in range(side)]
    gradings = {
        (j * row + i, j * row + i + 1): Exponential(-1.0 if different and j % 2 else 1.0)
        for j in range(row)
        for i in range(side)
    }
    quads = [(k, k + 1, k + row + 1, k + row) for k in corner]
    return BlockStructure.build(bent, quads, counts=count, gradings=gradings)


def measure(order: int, blocks: int, different: bool, nodes: int, repeats: int) -> dict[str, object]:
    side = max(1, round(blocks**0.5))
    count = max(1, round(nodes**0.5 / (side * order)))
    structure = structure_of(side, count, different)
    start = perf_counter()
    mesh = generate(structure, order, check=False)
    first = perf_counter() - start
    moved = structure.moved(structure.vertices * 1.01)
    buffer = np.empty_like(mesh.points)
    again = fastest(lambda: generate(moved, order, check=False), repeats)
    regenerated = fastest(lambda: regenerate(mesh, moved, out=buffer), repeats)
    check = fastest(lambda: raise_if_invalid(mesh, structure), min(repeats, 2))
    copy = fastest(lambda: np.copyto(buffer, mesh.points), repeats)
    return {
        "order": order,
        "blocks": side * side,
        "gradings": "different" if different else "equal",
        "nodes": len(mesh.points),
        "first s": first,
        "generate nodes/s": len(mesh.points) / again,
        "regenerate nodes/s": len(mesh.points) / regenerated,
        "generate/copy": again / copy,
        "regenerate/copy": regenerated / copy,
        "certify s": check,
    }


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--nodes", type=int, default=1_000_000, help="about how many nodes (default: %(default)s)")
    options.add_argument("--orders", type=int, nargs="+", default=[1, 2, 4, 8])
    options.add_argument("--blocks", type=int, nargs="+", default=[1, 64, 1024])
    options.add_argument("--repeats", type=int, default=5)
    chosen = options.parse_args(argv)
    cases = product(chosen.orders, chosen.blocks, (False, True))
    rows = [measure(p, blocks, different, chosen.nodes, chosen.repeats) for p, blocks, different in cases]
    settings = {"nodes": chosen.nodes, "repeats": chosen.repeats}
    return report(Result("mesh_generation", settings, rows), chosen.json)


if __name__ == "__main__":
    main()
