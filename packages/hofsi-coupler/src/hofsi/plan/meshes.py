"""The parts of the mesh, as a run makes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.building import build_structure
from hoblock.errors import HoblockError
from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.motion import driven_edges
from hofsi.case import Case, RuleSettings
from hofsi.errors import CaseError
from hofsi.movers import placed_vertices

Index = NDArray[np.int64]

__all__ = ["Meshes", "meshes_of", "still_blocks"]


@dataclass(frozen=True, eq=False)
class Meshes:
    """The parts of the mesh, as a run makes them."""

    fluid: tuple[BlockStructure, QuadMesh] | None
    solid: tuple[BlockStructure, QuadMesh] | None
    wet: tuple[int, int]
    driven: Index


def meshes_of(case: Case) -> Meshes:
    """Generate the parts of the mesh.

    Raises
    ------
    CaseError
        If an element is invalid.
    """
    structure = build_structure(case.mesh)
    groups = [name for solid in case.solids for name in solid.blocks]
    solid = _part(structure, groups, case.mesh.order) if groups else None
    if case.fluid is None:
        return Meshes(None, solid, (0, 0), np.zeros(0, dtype=np.int64))
    fluid = _part(structure, case.fluid.blocks, case.mesh.order)
    wet = structure.shared_edges(case.fluid.blocks, groups) if groups else np.zeros(0, dtype=np.int64)
    ends = structure.topology.edges
    nodes = len(np.unique(ends[wet])) + int((structure.topology.counts[wet] * case.mesh.order - 1).sum())
    names = structure.topology.vertex_names
    topology = fluid[0].topology
    coupled = [topology.edge(*(topology.vertex(names[v]) for v in ends[edge]))[0] for edge in wet]
    named = topology.edge_groups
    moving = [int(edge) for motion in case.motions for name in motion.on for edge in named[name]]
    return Meshes(fluid, solid, (len(wet), nodes), np.unique(np.array([*coupled, *moving], dtype=np.int64)))


def still_blocks(case: Case, meshes: Meshes) -> int:
    """How many of the fluid's blocks cannot move, where its boundary moves: no vertex does, and no edge may bend."""
    assert meshes.fluid is not None
    structure, mesh = meshes.fluid
    driven = driven_edges(structure, mesh.order, meshes.driven)
    if isinstance(case.mover, RuleSettings):  # vertices without a rule stay
        named = [structure.topology.vertex(rule.name) for rule in case.mover.vertices]
        moving = np.array([*driven.vertices, *named], dtype=np.int64)
    else:
        moving = np.concatenate([driven.vertices, *placed_vertices(case.mover, structure, driven)])
    topology = structure.topology
    # Edges opposite to a driven one, and those opposite to them, may take on its shape.
    bending = np.isin(topology.chains, topology.chains[meshes.driven])
    still = ~np.isin(topology.quads, moving).any(axis=1) & ~bending[topology.block_edges].any(axis=1)
    return int(still.sum())


def _part(structure: BlockStructure, groups: Sequence[str], order: int) -> tuple[BlockStructure, QuadMesh]:
    part = structure.restricted(groups)
    try:
        return part, generate(part, order)
    except HoblockError as error:
        raise CaseError(str(error), "mesh") from error
