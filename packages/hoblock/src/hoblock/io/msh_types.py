"""Gmsh's element types: numbers, orders, counts of nodes."""

from __future__ import annotations

__all__ = ["HIGHEST_ORDER", "LINES", "NODES", "QUADS", "describe"]

QUADS = {3: 1, 10: 2, 36: 3, 37: 4, 38: 5, 47: 6, 48: 7, 49: 8, 50: 9, 51: 10}
"""Order of each type of complete quadrangle."""

LINES = {1: 1, 8: 2, 26: 3, 27: 4, 28: 5, 62: 6, 63: 7, 64: 8, 65: 9, 66: 10}
"""Order of each type of line."""

HIGHEST_ORDER = 10

_TRIANGLES = {2: 3, 9: 6, 20: 9, 21: 10, 22: 12, 23: 15, 24: 15, 25: 21, 42: 28, 43: 36, 44: 45, 45: 55, 46: 66}
_SERENDIPITY = {16: 8, 39: 12, 40: 16, 41: 20}
_SOLIDS = {4: 4, 5: 8, 6: 6, 7: 5, 11: 10, 12: 27, 13: 18, 14: 14, 17: 20, 18: 15, 19: 13, 29: 20, 30: 35, 31: 56}

NODES = {
    15: 1,
    **{kind: order + 1 for kind, order in LINES.items()},
    **{kind: (order + 1) ** 2 for kind, order in QUADS.items()},
    **_TRIANGLES,
    **_SERENDIPITY,
    **_SOLIDS,
}
"""Count of nodes of each known type."""


def describe(kind: int) -> tuple[str, str]:
    """Plural name of a type that is not welcome, and what to do about it."""
    if kind in _TRIANGLES:
        return "triangles", "In Gmsh: Mesh.RecombineAll = 1 and Mesh.SubdivisionAlgorithm = 1 make all of them quads."
    if kind in _SERENDIPITY:
        return "quadrangles without inner nodes", "In Gmsh: Mesh.SecondOrderIncomplete = 0."
    if kind in _SOLIDS:
        return "elements of volumes", "Mesh the surface only, or save only its physical group."
    return f"elements of type {kind}", "Save quadrangles of order 1 to 10 and lines only."
