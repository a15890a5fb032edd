"""From the quads of a mesh file in a scene to their block structure."""

from __future__ import annotations

from hoblock.blocks import BlockStructure
from hoblock.building.paths import at
from hoblock.coarse_quads import structure_from_quads
from hoblock.scene import QuadsScene

__all__ = ["build_quads"]


def build_quads(scene: QuadsScene) -> BlockStructure:
    """Build the block structure whose blocks are the quads of a file.

    Raises
    ------
    TopologyError
        If the quads form no block structure; names the place of the file.
    """
    with at(scene.place):
        return structure_from_quads(
            scene.points,
            scene.quads,
            order=scene.order,
            node_order=scene.node_order,
            spacing=scene.spacing,
            names=scene.names,
            block_groups=scene.block_groups,
            edge_groups=scene.edge_groups,
        )
