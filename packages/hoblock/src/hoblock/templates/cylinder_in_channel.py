"""A circular cylinder in a channel."""

from __future__ import annotations

import math

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import TemplateError
from hoblock.grading import Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.parameters import Count, Length, Point, Stretch
from hoblock.templates.template import template

__all__ = ["cylinder_in_channel"]

_RING = (("c1", "b2"), ("c2", "a2"), ("c3", "a1"), ("c4", "b1"))
"""Vertices of the circle at 45, 135, 225 and 315 degrees, and of the square around it."""


@template
def cylinder_in_channel(
    *,
    length: Length = 2.2,
    height: Length = 0.41,
    center: Point = (0.2, 0.2),
    radius: Length = 0.05,
    square: Length = 0.2,
    elements_inlet: Count = 2,
    elements_below: Count = 2,
    elements_above: Count = 2,
    elements_quarter: Count = 4,
    elements_radial: Count = 4,
    elements_wake: Count = 12,
    stretch_radial: Stretch = 1.5,
    stretch_wake: Stretch = 1.8,
) -> BlockStructure:
    """Circular cylinder in a channel; by default the benchmark 2D-1 of the DFG.

    Vertices ``i``, ``a``, ``b``, ``o`` (columns from inlet to outlet) with 0 to 3 from bottom to top, ``c1`` to ``c4``
    on the circle at 45, 135, 225 and 315 degrees; blocks ``fluid``; edges ``inlet``, ``outlet``, ``top``, ``bottom``,
    ``cylinder``.

    Parameters
    ----------
    length : float
        Of the channel; its lower left corner is at (0, 0).
    height : float
        Of the channel, from bottom to top.
    center : (float, float)
        Centre of the cylinder.
    radius : float
        Its radius.
    square : float
        Side of the square around it that the ring of blocks fills.
    elements_inlet : int
        Elements from the inlet to that square.
    elements_below : int
        Elements from the bottom to that square.
    elements_above : int
        Elements from that square to the top.
    elements_quarter : int
        Elements along each quarter of the cylinder, and each side of the square.
    elements_radial : int
        Elements from the cylinder to the square.
    elements_wake : int
        Elements from the square to the outlet.
    stretch_radial : float
        Exponential grading from the cylinder to the square, dense at the cylinder for positive values.
    stretch_wake : float
        Exponential grading from the square to the outlet, dense at the square for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or the cylinder or its square does not fit.

    References
    ----------
    M. Schäfer, S. Turek, Benchmark computations of laminar flow around a cylinder, Notes on Numerical Fluid Mechanics
    52 (1996) 547–566, doi:10.1007/978-3-322-89849-4_39.
    """
    half = 0.5 * square
    if radius >= half:
        raise TemplateError(f"got {square:g}; expected more than 2 radius = {2.0 * radius:g}.", "square")
    for k, (place, size, name) in enumerate(((center[0], length, "length"), (center[1], height, "height"))):
        if not half < place < size - half:
            raise TemplateError(
                f"got {center[k]:g} as {'xy'[k]}; expected between {half:g} and {size - half:g}: the square of side "
                f"{square:g} must lie inside the channel of {name} {size:g}. Move the cylinder or make square smaller.",
                "center",
            )
    draft = Draft()
    x = (0.0, center[0] - half, center[0] + half, length)
    y = (0.0, center[1] - half, center[1] + half, height)
    draft.grid("fluid", x, y, keep=lambda i, j: (i, j) != (1, 1), name=lambda i, j: f"{'iabo'[i]}{j}")
    for k, (name, _) in enumerate(_RING):
        angle = math.radians(45 + 90 * k)
        draft.vertex(name, (center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle)))
    for (first, outer), (second, next_outer) in zip(_RING, (*_RING[1:], _RING[0]), strict=True):
        draft.block("fluid", first, outer, next_outer, second)
        draft.curve(first, second, Arc.from_center(center, draft.vertices[first], draft.vertices[second]))
    draft.call("inlet", "i0", "i1", "i2", "i3")
    draft.call("outlet", "o0", "o1", "o2", "o3")
    draft.call("top", "i3", "a3", "b3", "o3")
    draft.call("bottom", "i0", "a0", "b0", "o0")
    draft.call("cylinder", "c1", "c2", "c3", "c4", "c1")
    draft.count(elements_inlet, "i0", "a0")
    draft.count(elements_below, "a0", "a1")
    draft.count(elements_above, "a2", "a3")
    draft.count(elements_quarter, "c1", "c2", "c3", "c4", "c1")
    draft.count(elements_radial, "c1", "b2")
    draft.count(elements_wake, "b0", "o0")
    draft.grade(Exponential(stretch_radial), *_RING)
    draft.grade(Exponential(stretch_wake), *((f"b{j}", f"o{j}") for j in range(4)))
    return draft.structure()
