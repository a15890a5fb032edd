"""hoblock: high-order block-structured quad meshes, generated anew whenever their blocks move.

A block structure is a coarse mesh of quads whose edges carry geometry and grading; transfinite maps fill it with
elements of any order. Importing this package loads NumPy only; scenes,
operations on blocks, files and drawings come in when they are first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from hoblock.blocks import BlockStructure
from hoblock.curves import (
    Arc,
    ArcLength,
    Bezier,
    BSpline,
    Curve,
    Ellipse,
    LagrangeEdge,
    LevelSet,
    NodalCurve,
    Nurbs,
    Parametric,
    Polyline,
    Spline,
)
from hoblock.errors import (
    CurveError,
    ExpressionError,
    FieldError,
    GradingError,
    HoblockError,
    InvalidMeshError,
    LocationError,
    MeshFileError,
    MissingExtraError,
    MoverError,
    SceneError,
    TemplateError,
    TopologyError,
)
from hoblock.generate import changed_blocks, generate, regenerate
from hoblock.grading import (
    BoundaryLayer,
    Cosine,
    Cubic,
    EdgeGrading,
    Exponential,
    Geometric,
    Grading,
    Listed,
    Pieces,
    Quadratic,
    Tanh,
    Uniform,
)
from hoblock.mesh import QuadMesh
from hoblock.node_order import line_node_order, node_order
from hoblock.quality import (
    Certificate,
    QualitySummary,
    aspect_ratio,
    certify,
    det_jacobian,
    det_jacobian_bounds,
    equiangular_skewness,
    jacobian_ratio,
    minimum_det_jacobian,
    quality_summary,
    scaled_jacobian,
    size_jump,
)
from hoblock.topology import BlockTopology

if TYPE_CHECKING:
    from hoblock.building import build_structure
    from hoblock.coarse_quads import structure_from_mesh, structure_from_quads
    from hoblock.fields import GridField, MeshField
    from hoblock.fit import fit_errors
    from hoblock.io.block_file import read_structure
    from hoblock.io.mesh_file import read_mesh, write_mesh
    from hoblock.motion import MeshMotion, MeshState
    from hoblock.movers import AngleOptimisation, BarrierEnergy, PseudoSolid, Rule
    from hoblock.operations import (
        chains,
        extracted,
        merge,
        mirrored,
        rotated,
        scaled,
        split,
        split_block,
        translated,
    )
    from hoblock.plot import plot_mesh
    from hoblock.resampling import resample

__version__ = "0.1.0"

_ON_USE = {
    "AngleOptimisation": "hoblock.movers",
    "BarrierEnergy": "hoblock.movers",
    "GridField": "hoblock.fields",
    "MeshField": "hoblock.fields",
    "MeshMotion": "hoblock.motion",
    "MeshState": "hoblock.motion",
    "PseudoSolid": "hoblock.movers",
    "Rule": "hoblock.movers",
    "build_structure": "hoblock.building",
    "chains": "hoblock.operations",
    "extracted": "hoblock.operations",
    "fit_errors": "hoblock.fit",
    "merge": "hoblock.operations",
    "mirrored": "hoblock.operations",
    "plot_mesh": "hoblock.plot",
    "read_mesh": "hoblock.io.mesh_file",
    "read_structure": "hoblock.io.block_file",
    "resample": "hoblock.resampling",
    "rotated": "hoblock.operations",
    "scaled": "hoblock.operations",
    "split": "hoblock.operations",
    "split_block": "hoblock.operations",
    "structure_from_mesh": "hoblock.coarse_quads",
    "structure_from_quads": "hoblock.coarse_quads",
    "translated": "hoblock.operations",
    "write_mesh": "hoblock.io.mesh_file",
}


def __getattr__(name: str) -> object:
    """Import what is not always needed when it is first asked for."""
    if name not in _ON_USE:
        raise AttributeError(f"module 'hoblock' has no attribute {name!r}")
    found = globals()[name] = getattr(importlib.import_module(_ON_USE[name]), name)
    return found


__all__ = [
    "AngleOptimisation",
    "Arc",
    "ArcLength",
    "BSpline",
    "BarrierEnergy",
    "Bezier",
    "BlockStructure",
    "BlockTopology",
    "BoundaryLayer",
    "Certificate",
    "Cosine",
    "Cubic",
    "Curve",
    "CurveError",
    "EdgeGrading",
    "Ellipse",
    "Exponential",
    "ExpressionError",
    "FieldError",
    "Geometric",
    "Grading",
    "GradingError",
    "GridField",
    "HoblockError",
    "InvalidMeshError",
    "LagrangeEdge",
    "LevelSet",
    "Listed",
    "LocationError",
    "MeshField",
    "MeshFileError",
    "MeshMotion",
    "MeshState",
    "MissingExtraError",
    "MoverError",
    "NodalCurve",
    "Nurbs",
    "Parametric",
    "Pieces",
    "Polyline",
    "PseudoSolid",
    "QuadMesh",
    "Quadratic",
    "QualitySummary",
    "Rule",
    "SceneError",
    "Spline",
    "Tanh",
    "TemplateError",
    "TopologyError",
    "Uniform",
    "aspect_ratio",
    "build_structure",
    "certify",
    "chains",
    "changed_blocks",
    "det_jacobian",
    "det_jacobian_bounds",
    "equiangular_skewness",
    "extracted",
    "fit_errors",
    "generate",
    "jacobian_ratio",
    "line_node_order",
    "merge",
    "minimum_det_jacobian",
    "mirrored",
    "node_order",
    "plot_mesh",
    "quality_summary",
    "read_mesh",
    "read_structure",
    "regenerate",
    "resample",
    "rotated",
    "scaled",
    "scaled_jacobian",
    "size_jump",
    "split",
    "split_block",
    "structure_from_mesh",
    "structure_from_quads",
    "translated",
    "write_mesh",
]
