"""Meshes that move with a part of their boundary: driven nodes → block vertices → new points, certified."""

from hoblock.motion.crossings import BoundaryCrossing, boundary_crossing
from hoblock.motion.driven_edges import DrivenEdges, driven_edges
from hoblock.motion.mesh_motion import MeshMotion
from hoblock.motion.mesh_state import MeshState

__all__ = ["BoundaryCrossing", "DrivenEdges", "MeshMotion", "MeshState", "boundary_crossing", "driven_edges"]
