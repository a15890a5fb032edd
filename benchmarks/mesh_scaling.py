"""Generation and regeneration of one mesh from 10⁴ to 10⁷ nodes, on the blocks of a channel with a flag that bends."""

from __future__ import annotations

import tracemalloc
from collections.abc import Sequence
from itertools import pairwise
from time import perf_counter

import numpy as np

from _result import ROOT, Result, fastest, parser, report
from hoblock import BlockStructure, Exponential, Uniform, build_structure, generate, regenerate
from hoblock.curves import NodalCurve
from hoblock.io.scene import load_mesh_scene
from hoblock.layout import layout
from hoblock.movers import PseudoSolid

FLAG = ("T0", "T1", "T2", "T3", "T4", "T5", "B5", "B4", "B3", "B2", "B1", "B0")


def channel(nodes: int, order: int, gradings: str) -> BlockStructure:
    """The 57 blocks of examples/fsi1.toml with about so many nodes.

    Gradings are uniform ("equal"), those of the scene, or unlike on both pairs of opposite edges of every block
    ("different").
    """
    scene = load_mesh_scene(ROOT / "examples" / "fsi1.toml")
    structure = build_structure(scene)
    topology = structure.topology
    elements = topology.counts[topology.block_edges[:, 0]] * topology.counts[topology.block_edges[:, 3]]
    factor = max(1, round((nodes / (elements.sum() * order**2)) ** 0.5))
    counts = {
        tuple(map(str, pair)): int(n) * factor for pair, n in zip(_names(structure), topology.counts, strict=True)
    }
    given = dict(zip(_names(structure), structure.gradings, strict=True))
    if gradings == "equal":
        given = dict.fromkeys(given, Uniform())
    elif gradings == "different":
        given = {pair: Exponential(0.2 + k / len(given)) for k, pair in enumerate(given)}
    curves = {_names(structure)[edge]: curve for edge, curve in structure.curves.items()}
    return BlockStructure.build(scene.vertices, scene.blocks, counts=counts, curves=curves, gradings=given, edges=None)


def _names(structure: BlockStructure) -> list[tuple[str, str]]:
    names = structure.topology.vertex_names
    return [(names[a], names[b]) for a, b in structure.topology.edges]


def bent(structure: BlockStructure, order: int) -> BlockStructure:
    """The structure with the flag bent: its edges take nodes, as from a simulation; a mover places the rest."""
    topology = structure.topology
    pairs = [topology.find_edge(topology.vertex(a), topology.vertex(b)) for a, b in pairwise(FLAG)]
    edges = [edge for edge in pairs if edge is not None]
    plan, points = layout(structure, order), generate(structure, order, check=False).points

    def deflected(places: np.ndarray) -> np.ndarray:
        x = np.maximum(places[:, :1] - 0.25, 0.0) / 0.35
        return places + np.concatenate([-0.01 * x**3, 0.05 * x**2], axis=1)

    driven = np.unique(topology.edges[edges])
    vertices = PseudoSolid(structure, driven).move(structure.vertices, deflected(structure.vertices[driven]))
    curves = {edge: NodalCurve(deflected(points[plan.nodes_of_edge(edge)]), order) for edge in edges}
    return structure.moved(vertices, curves)


def measure(nodes: int, order: int, gradings: str, repeats: int) -> dict[str, object]:
    structure = channel(nodes, order, gradings)
    generate(channel(10, order, gradings), order)  # tables of the reference element
    tracemalloc.start()
    mesh = generate(structure, order)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    structure = channel(nodes, order, gradings)
    start = perf_counter()
    mesh = generate(structure, order, check=False)
    whole = perf_counter() - start
    moved = bent(structure, order)
    buffer = np.empty_like(mesh.points)
    again = fastest(lambda: regenerate(mesh, moved, out=buffer), repeats)
    certified = fastest(lambda: generate(structure, order), max(1, repeats // 3))
    copy = fastest(lambda: np.copyto(buffer, mesh.points), repeats)
    return {
        "nodes": len(mesh.points),
        "gradings": gradings,
        "generate ms": whole * 1e3,
        "with certificate ms": certified * 1e3,
        "regenerate ms": again * 1e3,
        "copy ms": copy * 1e3,
        "regenerate/copy": again / copy,
        "generate ns/node": whole / len(mesh.points) * 1e9,
        "regenerate ns/node": again / len(mesh.points) * 1e9,
        "peak/arrays": peak / (mesh.points.nbytes + mesh.cells.nbytes),
    }


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--nodes", type=int, nargs="+", default=[10**4, 10**5, 10**6, 10**7])
    options.add_argument("--order", type=int, default=4)
    options.add_argument("--repeats", type=int, default=7)
    chosen = options.parse_args(argv)
    kinds = ("equal", "scene", "different")
    rows = [measure(nodes, chosen.order, kind, chosen.repeats) for kind in kinds for nodes in chosen.nodes]
    settings = {"order": chosen.order, "repeats": chosen.repeats}
    return report(Result("mesh_scaling", settings, rows), chosen.json)


if __name__ == "__main__":
    main()
