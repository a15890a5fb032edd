"""Motion of the fluid mesh: driven edges → block vertices → new points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock import (
    BlockStructure,
    GradingError,
    InvalidMeshError,
    MoverError,
    QuadMesh,
    changed_blocks,
    det_jacobian_bounds,
    regenerate,
)
from hoblock.curves import NodalCurve
from hoblock.generate import raise_if_invalid
from hoblock.layout import layout
from hoblock.movers import Mover
from hofsi.errors import MeshMotionError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["DrivenEdges", "MeshMotion", "MeshState", "driven_edges"]


@dataclass(frozen=True)
class DrivenEdges:
    """Block edges whose nodes are given, and those nodes.

    Attributes
    ----------
    edges : tuple of int
    nodes : ndarray, shape (k,)
        Mesh nodes on the edges, ascending.
    rows : tuple of ndarray
        For each edge, the rows of ``nodes`` along it.
    vertices : ndarray
        Block vertices on the edges, ascending.
    vertex_rows : ndarray
        Their rows in ``nodes``.
    """

    edges: tuple[int, ...]
    nodes: Index
    rows: tuple[Index, ...]
    vertices: Index
    vertex_rows: Index


def driven_edges(structure: BlockStructure, order: int, edges: tuple[int, ...]) -> DrivenEdges:
    """Collect the nodes and vertices of some block edges."""
    plan = layout(structure, order)
    along = [plan.nodes_of_edge(edge) for edge in edges]
    nodes = np.unique(np.concatenate(along))
    vertices = np.unique(structure.topology.edges[list(edges)])
    return DrivenEdges(
        edges,
        nodes,
        tuple(np.searchsorted(nodes, line) for line in along),
        vertices,
        np.searchsorted(nodes, plan.vertex_nodes[vertices]),
    )


@dataclass(frozen=True)
class MeshState:
    """A position of the fluid mesh.

    Attributes
    ----------
    structure : BlockStructure
    mesh : QuadMesh
    min_det_J : float
        Certified lower bound of det J over all elements.
    regenerated : int
        Blocks that were generated anew since the state it was made from, counted once for every mesh made on the way.
    """

    structure: BlockStructure
    mesh: QuadMesh
    min_det_J: float
    regenerated: int = 0


class MeshMotion:
    """Generates the fluid mesh for given positions of the driven nodes.

    Parameters
    ----------
    structure : BlockStructure
        The fluid's blocks in their reference position.
    mesh : QuadMesh
        Their mesh.
    mover : Mover
        Places the block vertices that are not driven.
    driven : DrivenEdges
    """

    def __init__(self, structure: BlockStructure, mesh: QuadMesh, mover: Mover, driven: DrivenEdges) -> None:
        self.driven = driven
        self._mover = mover
        self.reference = MeshState(structure, mesh, float(det_jacobian_bounds(mesh)[0].min()))

    def move(self, current: MeshState, displacement: Array, time: float) -> MeshState:
        """Generate the mesh for a displacement of the driven nodes from the reference.

        Parameters
        ----------
        current : MeshState
            The last accepted position, from which incremental movers start.
        displacement : ndarray, shape (k, 2)
            Of ``driven.nodes``.
        time : float
            For messages.

        Raises
        ------
        MeshMotionError
            Naming the block, element and place where the mesh would be invalid.
        """
        driven, reference = self.driven, self.reference
        positions = reference.mesh.points[driven.nodes] + displacement
        where = f"fluid mesh, t = {time:g}"
        try:
            vertices = self._mover.move(current.structure.vertices, positions[driven.vertex_rows])
            curves = {
                edge: NodalCurve(positions[rows], reference.mesh.order)
                for edge, rows in zip(driven.edges, driven.rows, strict=True)
            }
            structure = reference.structure.moved(vertices, curves)
            mesh = regenerate(reference.mesh, structure, previous=reference.structure)
            lower = float(det_jacobian_bounds(mesh)[0].min())
            if not lower > 0.0:
                raise_if_invalid(mesh, structure)
        except (GradingError, InvalidMeshError, MoverError) as error:
            raise MeshMotionError(
                f"{error} Use smaller steps, another [mover], or more blocks around the moving body.",
                "invalid mesh",
                where,
            ) from error
        return MeshState(structure, mesh, lower, int(changed_blocks(reference.structure, structure).sum()))
