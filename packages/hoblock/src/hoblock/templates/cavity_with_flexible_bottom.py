"""A driven cavity on a flexible bottom."""

from __future__ import annotations

from typing import Annotated

from hoblock.blocks import BlockStructure
from hoblock.errors import TemplateError
from hoblock.grading import Cubic, Exponential
from hoblock.templates.draft import Draft, grid_name
from hoblock.templates.parameters import Bounds, Count, Length, Stretch
from hoblock.templates.template import template

__all__ = ["cavity_with_flexible_bottom"]


@template
def cavity_with_flexible_bottom(
    *,
    width: Length = 1.0,
    height: Length = 1.0,
    thickness: Length = 0.002,
    opening: Annotated[float, Bounds("length", minimum=0.0)] = 0.125,
    blocks_x: Annotated[int, Bounds("blocks", minimum=1, maximum=1000)] = 4,
    blocks_y: Annotated[int, Bounds("blocks", minimum=1, maximum=1000)] = 3,
    elements_x: Count = 3,
    elements_y: Count = 3,
    elements_opening: Count = 2,
    elements_thickness: Count = 1,
    stretch: Stretch = 1.0,
) -> BlockStructure:
    """Lid-driven cavity on a flexible bottom, with openings beside the lid.

    Vertices ``p0_0`` (underside of the bottom, at the left), column first; blocks ``fluid`` and ``solid``; edges
    ``lid``, ``inlet`` and ``outlet`` (left and right of the lid), ``left`` and ``right`` (walls), ``interface`` (of
    fluid and solid), ``underside`` and ``clamp`` (both ends of the bottom). The fluid fills (0, width) x (0, height).

    Parameters
    ----------
    width : float
        Of the cavity, from left to right.
    height : float
        Of the cavity, from bottom to top.
    thickness : float
        Of the flexible bottom.
    opening : float
        Height of inlet and outlet, both right under the lid; 0: none.
    blocks_x : int
        Blocks across the cavity. Vertices between them move with the bottom.
    blocks_y : int
        Blocks upwards below the openings. Vertices between them move with the bottom.
    elements_x : int
        Elements across each of the blocks across the cavity.
    elements_y : int
        Elements across each of the blocks upwards.
    elements_opening : int
        Elements across an opening.
    elements_thickness : int
        Elements across the bottom.
    stretch : float
        Exponential grading of the blocks on the bottom, dense at it for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or the openings are higher than the cavity.

    References
    ----------
    W. A. Wall, Fluid-Struktur-Interaktion mit stabilisierten Finiten Elementen, dissertation, Universität Stuttgart
    (1999); D. P. Mok, Partitionierte Lösungsansätze in der Strukturdynamik und der Fluid-Struktur-Interaktion,
    dissertation, Universität Stuttgart (2001).
    """
    if opening >= height:
        raise TemplateError(f"got {opening:g}; expected less than height = {height:g}.", "opening")
    draft = Draft()
    wall = height - opening
    x = [width * i / blocks_x for i in range(blocks_x + 1)]
    y = [-thickness, *(wall * j / blocks_y for j in range(blocks_y + 1)), *([height] if opening else [])]
    top = len(y) - 1
    draft.grid("fluid", x, y, keep=lambda i, j: j > 0)
    draft.grid("solid", x, y, keep=lambda i, j: j == 0)
    across = [[grid_name(i, j) for i in range(blocks_x + 1)] for j in range(len(y))]
    sides = [[grid_name(i, j) for j in range(len(y))] for i in (0, blocks_x)]
    draft.call("lid", *across[top])
    draft.call("interface", *across[1])
    draft.call("underside", *across[0])
    for name, hole, side in zip(("left", "right"), ("inlet", "outlet"), sides, strict=True):
        draft.call(name, *side[1 : blocks_y + 2])
        draft.call("clamp", *side[:2])
        if opening:
            draft.call(hole, *side[blocks_y + 1 :])
    draft.count(elements_x, *across[0])
    draft.count(elements_thickness, *sides[0][:2])
    draft.count(elements_y, *sides[0][1 : blocks_y + 2])
    if opening:
        draft.count(elements_opening, *sides[0][blocks_y + 1 :])
        draft.grade(Cubic(0.3), *((grid_name(i, top - 1), grid_name(i, top)) for i in range(blocks_x + 1)))
    draft.grade(Exponential(stretch), *((grid_name(i, 1), grid_name(i, 2)) for i in range(blocks_x + 1)))
    return draft.structure()
