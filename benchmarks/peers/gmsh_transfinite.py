"""The same blocks meshed by hoblock and by Gmsh (transfinite curves and surfaces, recombined, setOrder).

Gmsh reads the geometry once; its time is that of meshing the given block structure, raising the order and handing the
arrays over (`mesh.generate(2)`, `setOrder(p)`, `getNodes`, `getElements`), which is what a Python program needs.
hoblock's time covers numbering, connectivity and points, with and without its certificate; Gmsh checks nothing.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import gmsh
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from _result import Result, fastest, parser, report
from hoblock import Arc, BlockStructure, generate
from hoblock.curves import Reversed
from mesh_scaling import channel


def build_in_gmsh(structure: BlockStructure) -> None:
    """Give Gmsh the blocks: lines and arcs, transfinite with the structure's counts, uniform."""
    geo = gmsh.model.geo
    topology = structure.topology
    for k, (x, y) in enumerate(structure.vertices, start=1):
        geo.addPoint(x, y, 0.0, tag=k)
    centers: dict[tuple[float, float], int] = {}
    for edge, (first, second) in enumerate(topology.edges + 1):
        curve = structure.curves.get(edge)
        arc = curve.curve if isinstance(curve, Reversed) else curve
        if isinstance(arc, Arc):
            if arc.center not in centers:
                centers[arc.center] = geo.addPoint(*arc.center, 0.0)
            geo.addCircleArc(first, centers[arc.center], second, tag=edge + 1)
        else:
            geo.addLine(first, second, tag=edge + 1)
        geo.mesh.setTransfiniteCurve(edge + 1, int(topology.counts[edge]) + 1)
    for block, sides in enumerate(topology.block_edges + 1, start=1):
        bottom, right, top, left = map(int, sides)
        geo.addCurveLoop([bottom, right, -top, -left], tag=block)
        geo.addPlaneSurface([block], tag=block)
        geo.mesh.setTransfiniteSurface(block, cornerTags=[int(v) + 1 for v in topology.quads[block - 1]])
        geo.mesh.setRecombine(2, block)
    geo.synchronize()


def mesh_by_gmsh(order: int) -> tuple[float, int]:
    """Seconds for the mesh and its arrays, and the number of nodes."""
    gmsh.model.mesh.clear()
    start = perf_counter()
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)
    tags, _, _ = gmsh.model.mesh.getNodes()
    gmsh.model.mesh.getElements(2)
    return perf_counter() - start, len(tags)


def measure(nodes: int, order: int, repeats: int) -> dict[str, object]:
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        build_in_gmsh(channel(nodes, order, "equal"))
        theirs, their_nodes = min(mesh_by_gmsh(order) for _ in range(repeats))
    finally:
        gmsh.finalize()
    # A new structure each time, so that nothing is remembered from the last.
    structures = iter([channel(nodes, order, "equal") for _ in range(2 * repeats)])
    ours = fastest(lambda: generate(next(structures), order, check=False), repeats)
    certified = fastest(lambda: generate(next(structures), order), repeats)
    mesh = generate(channel(nodes, order, "equal"), order, check=False)
    assert np.isclose(len(mesh.points), their_nodes, rtol=0.01), "not the same mesh"
    return {
        "order": order,
        "nodes": len(mesh.points),
        "gmsh s": theirs,
        "hoblock s": ours,
        "with certificate s": certified,
        "ratio": theirs / ours,
        "ratio with certificate": theirs / certified,
    }


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--nodes", type=int, default=1_000_000)
    options.add_argument("--orders", type=int, nargs="+", default=[1, 2, 4, 8])
    options.add_argument("--repeats", type=int, default=3)
    chosen = options.parse_args(argv)
    rows = [measure(chosen.nodes, order, chosen.repeats) for order in chosen.orders]
    settings = {"nodes": chosen.nodes, "repeats": chosen.repeats, "gmsh": gmsh.__version__}
    return report(Result("gmsh_transfinite", settings, rows), chosen.json)


if __name__ == "__main__":
    main()
