"""Curves: the geometry of block edges, maps t ∈ [0, 1] → (n, 2)."""

from hoblock.curves.arc import Arc
from hoblock.curves.curve import Curve, CuttableCurve, PiecewiseCurve
from hoblock.curves.derived import Displaced, Reversed, reverse, with_ends
from hoblock.curves.nodal import NodalCurve
from hoblock.curves.parametric import Parametric

__all__ = [
    "Arc",
    "Curve",
    "CuttableCurve",
    "Displaced",
    "NodalCurve",
    "Parametric",
    "PiecewiseCurve",
    "Reversed",
    "reverse",
    "with_ends",
]
