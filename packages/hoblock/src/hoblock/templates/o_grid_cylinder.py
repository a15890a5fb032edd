"""A circular cylinder in a large domain, wrapped in rings of elements."""

from __future__ import annotations

import math
from typing import Annotated

from hoblock.blocks import BlockStructure
from hoblock.curves import Arc
from hoblock.errors import TemplateError
from hoblock.grading import BoundaryLayer, Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.layer import wall_layer
from hoblock.templates.parameters import Count, Example, Growth, Length, Point, Stretch
from hoblock.templates.template import template

__all__ = ["o_grid_cylinder"]

_CORNERS = ("p2_2", "p1_2", "p1_1", "p2_1")
"""Grid vertices around the ring at 45, 135, 225 and 315 degrees."""


@template
def o_grid_cylinder(
    *,
    radius: Length = 0.5,
    center: Point = (0.0, 0.0),
    ring_radius: Length = 1.5,
    square: Length = 5.0,
    upstream: Length = 10.0,
    downstream: Length = 25.0,
    half_height: Length = 10.0,
    first_height: Annotated[Length, Example(1e-3)] | None = None,
    growth: Growth = 1.5,
    elements_quarter: Count = 6,
    elements_ring: Count = 6,
    elements_square: Count = 3,
    elements_upstream: Count = 4,
    elements_downstream: Count = 14,
    elements_side: Count = 4,
    stretch: Stretch = 1.2,
) -> BlockStructure:
    """Circular cylinder in a rectangle, wrapped in an O-grid with an optional boundary layer.

    Rings of elements around the cylinder, a square around the rings, the rectangle around the square. Vertices ``c1``
    to ``c4`` (cylinder) and ``r1`` to ``r4`` (outermost ring) at 45, 135, 225 and 315 degrees, ``p0_0`` to ``p3_3``
    (grid, column first); blocks ``fluid``; edges ``inflow``, ``outflow``, ``top``, ``bottom``, ``cylinder``.

    Parameters
    ----------
    radius : float
        Of the cylinder.
    center : (float, float)
        Its centre.
    ring_radius : float
        Radius of the outermost ring.
    square : float
        Side of the square around the rings, more than their diameter.
    upstream : float
        Distance from the centre to the inflow.
    downstream : float
        Distance from the centre to the outflow.
    half_height : float
        Distance from the centre to both top and bottom.
    first_height : float or None
        Height of the elements at the cylinder. Without one, ``elements_ring`` rings grow by ``growth``.
    growth : float
        Height of a ring over that of the ring inside it. With a first height it is the largest allowed, and
        the number of rings follows from it.
    elements_quarter : int
        Elements along each quarter of the cylinder.
    elements_ring : int
        Rings, if there is no first height.
    elements_square : int
        Elements from the rings to the square.
    elements_upstream : int
        Elements from the square to the inflow.
    elements_downstream : int
        Elements from the square to the outflow.
    elements_side : int
        Elements from the square to both top and bottom.
    stretch : float
        Exponential grading of all these outside the rings, dense at the cylinder for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or the lengths are out of order.
    """
    half = 0.5 * square
    _check_order(radius, ring_radius, square, first_height)
    for name, distance in (("upstream", upstream), ("downstream", downstream), ("half_height", half_height)):
        if distance <= half:
            raise TemplateError(f"got {distance:g}; expected more than half of square = {square:g}.", name)
    draft = Draft()
    x = [center[0] + step for step in (-upstream, -half, half, downstream)]
    y = [center[1] + step for step in (-half_height, -half, half, half_height)]
    draft.grid("fluid", x, y, keep=lambda i, j: (i, j) != (1, 1))
    for k, corner in enumerate(_CORNERS):
        direction = (math.cos(math.radians(45 + 90 * k)), math.sin(math.radians(45 + 90 * k)))
        for name, distance in (("c", radius), ("r", ring_radius)):
            draft.vertex(f"{name}{k + 1}", [center[d] + distance * direction[d] for d in (0, 1)])
        j = (k + 1) % 4
        draft.block("fluid", f"c{k + 1}", f"r{k + 1}", f"r{j + 1}", f"c{j + 1}")
        draft.block("fluid", f"r{k + 1}", corner, _CORNERS[j], f"r{j + 1}")
    for name in "cr":
        for k, j in ((1, 2), (2, 3), (3, 4), (4, 1)):
            ends = (draft.vertices[f"{name}{k}"], draft.vertices[f"{name}{j}"])
            draft.curve(f"{name}{k}", f"{name}{j}", Arc.from_center(center, *ends))
    _name_edges(draft)
    layer: BoundaryLayer | Exponential
    rings, layer = elements_ring, Exponential(min(elements_ring * math.log(growth), 45.0))
    if first_height is not None:
        rings, layer = wall_layer(ring_radius - radius, first_height, growth)
    for elements, path in (
        (elements_quarter, ("c1", "c2", "c3", "c4", "c1")),
        (rings, ("c1", "r1")),
        (elements_square, ("r1", "p2_2")),
        (elements_upstream, ("p0_1", "p1_1")),
        (elements_downstream, ("p2_1", "p3_1")),
        (elements_side, ("p1_0", "p1_1")),
        (elements_side, ("p1_2", "p1_3")),
    ):
        draft.count(elements, *path)
    draft.grade(layer, *((f"c{k}", f"r{k}") for k in range(1, 5)))
    outwards = Exponential(stretch)
    draft.grade(outwards, *((f"r{k + 1}", corner) for k, corner in enumerate(_CORNERS)))
    for k in range(4):
        draft.grade(outwards, (f"p1_{k}", f"p0_{k}"), (f"p2_{k}", f"p3_{k}"))
        draft.grade(outwards, (f"p{k}_1", f"p{k}_0"), (f"p{k}_2", f"p{k}_3"))
    return draft.structure()


def _check_order(radius: float, ring_radius: float, square: float, first_height: float | None) -> None:
    if ring_radius <= radius:
        raise TemplateError(f"got {ring_radius:g}; expected more than radius = {radius:g}.", "ring_radius")
    if square <= 2.0 * ring_radius:
        raise TemplateError(f"got {square:g}; expected more than 2 ring_radius = {2.0 * ring_radius:g}.", "square")
    if first_height is not None and first_height >= ring_radius - radius:
        raise TemplateError(
            f"got {first_height:g}; expected less than ring_radius - radius = {ring_radius - radius:g}.", "first_height"
        )


def _name_edges(draft: Draft) -> None:
    draft.call("inflow", "p0_0", "p0_1", "p0_2", "p0_3")
    draft.call("outflow", "p3_0", "p3_1", "p3_2", "p3_3")
    draft.call("bottom", "p0_0", "p1_0", "p2_0", "p3_0")
    draft.call("top", "p0_3", "p1_3", "p2_3", "p3_3")
    draft.call("cylinder", "c1", "c2", "c3", "c4", "c1")
