"""Curves: the geometry of block edges, maps t ∈ [0, 1] → (n, 2)."""

from hoblock.curves.affine import Affine, transformed
from hoblock.curves.arc import Arc
from hoblock.curves.arc_length import ArcLength, LengthTable, length_table
from hoblock.curves.b_spline import BSpline, Nurbs
from hoblock.curves.between import Between
from hoblock.curves.bezier import Bezier
from hoblock.curves.closest import closest_parameters, cut_at
from hoblock.curves.crossing import crossing_of_level_sets
from hoblock.curves.curve import Curve, CuttableCurve, PiecewiseCurve
from hoblock.curves.derived import Displaced, Reversed, reverse, with_ends
from hoblock.curves.ellipse import Ellipse
from hoblock.curves.lagrange_edge import LagrangeEdge
from hoblock.curves.level_set import LevelSet
from hoblock.curves.nearest import nearest_on_level_set
from hoblock.curves.nodal import NodalCurve
from hoblock.curves.parametric import Parametric
from hoblock.curves.piece import Piece, piece
from hoblock.curves.polyline import Polyline
from hoblock.curves.spline import Spline

__all__ = [
    "Affine",
    "Arc",
    "ArcLength",
    "BSpline",
    "Between",
    "Bezier",
    "Curve",
    "CuttableCurve",
    "Displaced",
    "Ellipse",
    "LagrangeEdge",
    "LengthTable",
    "LevelSet",
    "NodalCurve",
    "Nurbs",
    "Parametric",
    "Piece",
    "PiecewiseCurve",
    "Polyline",
    "Reversed",
    "Spline",
    "closest_parameters",
    "crossing_of_level_sets",
    "cut_at",
    "length_table",
    "nearest_on_level_set",
    "piece",
    "reverse",
    "transformed",
    "with_ends",
]
