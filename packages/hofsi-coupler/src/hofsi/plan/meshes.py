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
from hofsi.case import Case
from hofsi.errors import CaseError

Index = NDArray[np.int64]

__all__ = ["Meshes", "meshes_of"]


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


def _part(structure: BlockStructure, groups: Sequence[str], order: int) -> tuple[BlockStructure, QuadMesh]:
    part = structure.restricted(groups)
    try:
        return part, generate(part, order)
    except HoblockError as error:
        raise CaseError(str(error), "mesh") from error
