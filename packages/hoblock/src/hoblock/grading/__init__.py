"""Gradings: how element corners are distributed along a block edge, maps of [0, 1] onto itself."""

from hoblock.grading.derived import Reversed
from hoblock.grading.grading import EdgeGrading, EdgeShape, Grading
from hoblock.grading.paper import Cubic, Quadratic, Uniform
from hoblock.grading.positions import element_corners, node_parameters
from hoblock.grading.stretching import Exponential

__all__ = [
    "Cubic",
    "EdgeGrading",
    "EdgeShape",
    "Exponential",
    "Grading",
    "Quadratic",
    "Reversed",
    "Uniform",
    "element_corners",
    "node_parameters",
]
