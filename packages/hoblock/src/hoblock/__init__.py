"""hoblock: high-order block-structured quad meshes, generated anew whenever their blocks move.

A block structure is a coarse mesh of quads whose edges carry geometry and grading; transfinite maps fill it with
elements of any order. Importing this package loads NumPy only.
"""

from hoblock.blocks import BlockStructure
from hoblock.build import build_structure
from hoblock.curves import Arc, Curve, NodalCurve, Parametric
from hoblock.errors import (
    CurveError,
    ExpressionError,
    GradingError,
    HoblockError,
    InvalidMeshError,
    MeshFileError,
    MissingExtraError,
    MoverError,
    SceneError,
    TopologyError,
)
from hoblock.generate import changed_blocks, generate, regenerate
from hoblock.grading import Cubic, Exponential, Grading, Quadratic, Uniform
from hoblock.mesh import QuadMesh
from hoblock.node_order import line_node_order, node_order
from hoblock.quality import (
    det_jacobian,
    det_jacobian_bounds,
    equiangular_skewness,
    jacobian_ratio,
    minimum_det_jacobian,
    scaled_jacobian,
)
from hoblock.topology import BlockTopology

__version__ = "0.1.0"

__all__ = [
    "Arc",
    "BlockStructure",
    "BlockTopology",
    "Cubic",
    "Curve",
    "CurveError",
    "Exponential",
    "ExpressionError",
    "Grading",
    "GradingError",
    "HoblockError",
    "InvalidMeshError",
    "MeshFileError",
    "MissingExtraError",
    "MoverError",
    "NodalCurve",
    "Parametric",
    "QuadMesh",
    "Quadratic",
    "SceneError",
    "TopologyError",
    "Uniform",
    "build_structure",
    "changed_blocks",
    "det_jacobian",
    "det_jacobian_bounds",
    "equiangular_skewness",
    "generate",
    "jacobian_ratio",
    "line_node_order",
    "minimum_det_jacobian",
    "node_order",
    "regenerate",
    "scaled_jacobian",
]
