"""Classical mesh motion, to compare the block movers with: every node of the mesh is placed by the method itself."""

from full_mesh_movers.biharmonic import Biharmonic
from full_mesh_movers.elastic import Elastic
from full_mesh_movers.errors import MotionFailed
from full_mesh_movers.full_mesh_mover import FullMeshMover
from full_mesh_movers.interpolated_vertices import InterpolatedVertices
from full_mesh_movers.inverse_distance import InverseDistance
from full_mesh_movers.laplace import Laplace
from full_mesh_movers.macro_elements import MacroElements
from full_mesh_movers.neo_hooke import NeoHooke
from full_mesh_movers.radial_basis import RadialBasis

__all__ = [
    "Biharmonic",
    "Elastic",
    "FullMeshMover",
    "InterpolatedVertices",
    "InverseDistance",
    "Laplace",
    "MacroElements",
    "MotionFailed",
    "NeoHooke",
    "RadialBasis",
]
