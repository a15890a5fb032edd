"""Motion of the fluid mesh in a simulation: displacements at a time → positions, errors → those of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure, GradingError, InvalidMeshError, MoverError, QuadMesh
from hoblock.motion import DrivenEdges, MeshState
from hoblock.motion import MeshMotion as BlockMotion
from hoblock.movers import Mover
from hofsi.errors import MeshMotionError

Array = NDArray[np.float64]

__all__ = ["MeshMotion", "MeshPosition", "MeshState"]


@dataclass(frozen=True, eq=False)
class MeshPosition:
    """The numbers of a `MeshState`: all but what the meshes of a motion share.

    Attributes
    ----------
    points, vertices, positions : ndarray, shape (n, 2)
        Nodes, block vertices and driven nodes.
    min_det_J : float
    regenerated, substeps : int
    amplification : float
    """

    points: Array
    vertices: Array
    positions: Array
    min_det_J: float
    regenerated: int
    substeps: int
    amplification: float

    @staticmethod
    def of(state: MeshState) -> MeshPosition:
        """Return the numbers of a state."""
        return MeshPosition(
            state.mesh.points,
            state.vertices,
            state.positions,
            state.min_det_J,
            state.regenerated,
            state.substeps,
            state.amplification,
        )


class MeshMotion:
    """Generates the fluid mesh for given displacements of the driven nodes; see `hoblock.motion.MeshMotion`.

    Parameters
    ----------
    structure : BlockStructure
        The fluid's blocks in their reference position.
    mesh : QuadMesh
        Their mesh.
    mover : Mover
        Places the block vertices that are not driven.
    driven : DrivenEdges
    inherit : {"auto", "all", "none"}
        Which inner edges take on the shape of a driven one.
    halvings : int
        How often a motion that fails is halved before it is given up.

    Attributes
    ----------
    driven : DrivenEdges
    reference : MeshState
        What the mover makes of the reference position.
    """

    def __init__(
        self,
        structure: BlockStructure,
        mesh: QuadMesh,
        mover: Mover,
        driven: DrivenEdges,
        *,
        inherit: Literal["auto", "all", "none"] = "auto",
        halvings: int = 4,
    ) -> None:
        self.driven = driven
        self._motion = BlockMotion(
            structure, mesh.order, driven.edges, mover, mesh=mesh, inherit=inherit, halvings=halvings
        )
        self._start = self._motion.reference.positions
        self.reference = self._motion.start()

    @property
    def moving(self) -> dict[str, int]:
        """How many blocks, block vertices and nodes can move."""
        motion = self._motion
        return {
            "blocks": len(motion.moving_blocks),
            "vertices": len(motion.moving_vertices),
            "nodes": len(motion.moving_nodes),
        }

    def state_at(self, position: MeshPosition) -> MeshState:
        """Return the state with given numbers; `MeshPosition.of` is the way back."""
        state = MeshState(
            self.reference.mesh.with_points(position.points),
            position.vertices,
            position.positions,
            position.min_det_J,
            position.regenerated,
            position.substeps,
            position.amplification,
        )
        return self._motion.with_structure(state)

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
        try:
            return self._motion.move(current, self._start + displacement)
        except (GradingError, InvalidMeshError, MoverError) as error:
            raise MeshMotionError(
                f"{error} Use smaller steps, another [mover], or more blocks around the moving body.",
                "invalid mesh",
                f"fluid mesh, t = {time:g}",
            ) from error
