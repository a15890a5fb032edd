"""Gradings: how element corners are distributed along a block edge, maps of [0, 1] onto itself."""

from hoblock.grading.boundary_layer import BoundaryLayer
from hoblock.grading.cosine import Cosine
from hoblock.grading.derived import Part, Reversed, ReversedEdgeGrading, restrict, reverse
from hoblock.grading.ends import Ends
from hoblock.grading.function import Function
from hoblock.grading.grading import EdgeGrading, EdgeShape, Grading
from hoblock.grading.listed import Listed
from hoblock.grading.paper import Cubic, Quadratic, Uniform
from hoblock.grading.pieces import Pieces
from hoblock.grading.positions import element_corners, node_parameters
from hoblock.grading.stretching import Exponential, Geometric
from hoblock.grading.tanh import Tanh, TanhSpacing

__all__ = [
    "BoundaryLayer",
    "Cosine",
    "Cubic",
    "EdgeGrading",
    "EdgeShape",
    "Ends",
    "Exponential",
    "Function",
    "Geometric",
    "Grading",
    "Listed",
    "Part",
    "Pieces",
    "Quadratic",
    "Reversed",
    "ReversedEdgeGrading",
    "Tanh",
    "TanhSpacing",
    "Uniform",
    "element_corners",
    "node_parameters",
    "restrict",
    "reverse",
]
