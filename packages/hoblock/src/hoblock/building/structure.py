"""From the mesh part of a scene to a block structure; every error names its place in the scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.building.curves import build_curves
from hoblock.building.gradings import build_gradings
from hoblock.building.isolines import project_vertices
from hoblock.building.paths import Pair, at, edge_pairs, pairs_of
from hoblock.building.projections import project_onto_curves
from hoblock.building.quads import build_quads
from hoblock.building.template import build_template
from hoblock.errors import TopologyError
from hoblock.scene import CountScene, MeshScene
from hoblock.topology import BlockTopology

Index = NDArray[np.int64]

__all__ = ["build_structure"]


def build_structure(scene: MeshScene) -> BlockStructure:
    """Build the block structure that a scene describes.

    Parameters
    ----------
    scene : MeshScene

    Returns
    -------
    BlockStructure
        With the scene's names of vertices, groups of blocks and edges.

    Raises
    ------
    TopologyError
        If the blocks do not form a valid structure, a path leaves the block edges, an edge has two curves or two
        gradings, or a chain of opposite edges two numbers of elements.
    CurveError
        If a curve does not exist or misses its vertices.
    ExpressionError
        If a parametric curve is not finite somewhere.
    GradingError
        If a grading is impossible.
    """
    scene = project_onto_curves(project_vertices(scene))
    sides = {
        frozenset(pair) for quads in scene.blocks.values() for quad in quads for pair in pairs_of((*quad, quad[0]))
    }
    edges = {name: edge_pairs(paths, sides, f"mesh.edges.{name}") for name, paths in scene.edges.items()}
    curves = build_curves(scene, sides)
    gradings = build_gradings(scene.gradings, sides)
    for count in scene.counts:
        edge_pairs(count.on, sides, count.place)
    with at("mesh"):
        given = _given(scene)
        if given is None:
            structure = BlockStructure.build(
                scene.vertices, scene.blocks, edges=edges, curves=curves, gradings=gradings
            )
        else:
            structure = given.moved(np.array(list(scene.vertices.values())))
            structure = structure.with_curves(curves).with_gradings(gradings)
            for name, pairs in edges.items():
                structure = structure.with_edge_group(name, pairs)
    counts = _chain_counts(structure.topology, scene)
    return replace(structure, topology=replace(structure.topology, counts=counts))


def _given(scene: MeshScene) -> BlockStructure | None:
    """Return the structure that a template or a mesh file brings, if there is one."""
    if scene.template is not None:
        return build_template(scene.template)
    return None if scene.quads is None else build_quads(scene.quads)


def _chain_counts(topology: BlockTopology, scene: MeshScene) -> Index:
    """Number of elements of every edge; two numbers for one chain are an error that names both places."""
    given: dict[int, tuple[CountScene, Pair]] = {}
    for count in scene.counts:
        for pair in (pair for path in count.on for pair in pairs_of(path)):
            edge, _ = topology.edge(topology.vertex(pair[0]), topology.vertex(pair[1]))
            chain = int(topology.chains[edge])
            other, other_pair = given.setdefault(chain, (count, pair))
            if other.elements != count.elements:
                members = ", ".join(topology.edge_name(int(k)) for k in np.flatnonzero(topology.chains == chain))
                raise TopologyError(
                    f"{count.place}: {count.elements} elements on edge {pair[0]}–{pair[1]}, but {other.place} asks for "
                    f"{other.elements} on edge {other_pair[0]}–{other_pair[1]}. Both belong to one chain of opposite "
                    f"edges ({members}), which needs one number. Change or remove one."
                )
    numbers = {chain: count.elements for chain, (count, _) in given.items()}
    others = np.full(len(topology.edges), scene.elements) if scene.template is None else topology.counts
    pairs = zip(topology.chains.tolist(), others.tolist(), strict=True)
    return np.array([numbers.get(chain, other) for chain, other in pairs], dtype=np.int64)
