"""An annulus or a part of one."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import TemplateError
from hoblock.grading import Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.parameters import Angle, Bounds, Count, Length, Point, Stretch
from hoblock.templates.template import template

__all__ = ["annulus"]

_WIDEST = 150.0
"""Largest opening of one sector in degrees: the chords of its arcs must leave room between them."""


@template
def annulus(
    *,
    inner_radius: Length = 1.0,
    outer_radius: Length = 2.0,
    center: Point = (0.0, 0.0),
    start: Angle = 0.0,
    opening: Annotated[float, Bounds("degrees", above=0.0, maximum=360.0)] = 360.0,
    sectors: Annotated[int, Bounds("blocks", minimum=1, maximum=1000)] = 4,
    elements_radial: Count = 4,
    elements_angular: Count = 4,
    stretch: Stretch = 0.0,
) -> BlockStructure:
    """Annulus, full or a part of one.

    Vertices ``a0``, ``a1``, … on the inner and ``b0``, ``b1``, … on the outer circle; blocks ``domain``; edges
    ``inner``, ``outer`` and, of a part, ``first`` and ``last``: its straight ends.

    Parameters
    ----------
    inner_radius : float
        Radius of the inner circle.
    outer_radius : float
        Radius of the outer circle.
    center : (float, float)
        Their centre.
    start : float
        Direction of the first vertices, counter-clockwise from the x axis.
    opening : float
        Angle of the part; 360 closes the ring.
    sectors : int
        Blocks around, none wider than 150 degrees.
    elements_radial : int
        Elements from circle to circle.
    elements_angular : int
        Elements across each sector.
    stretch : float
        Exponential grading from circle to circle, dense at the inner one for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or the radii are out of order.
    """
    if inner_radius >= outer_radius:
        raise TemplateError(
            f"got {inner_radius:g}; expected less than outer_radius = {outer_radius:g}.", "inner_radius"
        )
    if opening / sectors > _WIDEST:
        raise TemplateError(
            f"got {sectors} for an opening of {opening:g} degrees; expected at least "
            f"{math.ceil(opening / _WIDEST - 1e-12)}, so that no sector is wider than {_WIDEST:g} degrees.",
            "sectors",
        )
    closed = opening == 360.0
    places = sectors if closed else sectors + 1
    draft = Draft()
    for name, radius in (("a", inner_radius), ("b", outer_radius)):
        for k in range(places):
            angle = math.radians(start + opening * k / sectors)
            draft.vertex(f"{name}{k}", (center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle)))
    walk = [*range(places), *([0] if closed else [])]
    for k, j in pairwise(walk):
        draft.block("domain", f"a{k}", f"b{k}", f"b{j}", f"a{j}")
        for name in "ab":
            ends = (draft.vertices[f"{name}{k}"], draft.vertices[f"{name}{j}"])
            draft.curve(f"{name}{k}", f"{name}{j}", Arc.from_center(center, *ends))
    draft.call("inner", *(f"a{k}" for k in walk))
    draft.call("outer", *(f"b{k}" for k in walk))
    if not closed:
        draft.call("first", "a0", "b0")
        draft.call("last", f"a{sectors}", f"b{sectors}")
    draft.count(elements_radial, "a0", "b0")
    draft.count(elements_angular, *(f"a{k}" for k in walk))
    draft.grade(Exponential(stretch), *((f"a{k}", f"b{k}") for k in range(places)))
    return draft.structure()
