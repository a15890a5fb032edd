"""A rectangle of blocks."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from hoblock.blocks import BlockStructure
from hoblock.grading import Exponential
from hoblock.templates.draft import Draft, grid_name
from hoblock.templates.parameters import Bounds, Count, Length, Point, Stretch
from hoblock.templates.spacing import graded_lines
from hoblock.templates.template import template

Blocks = Annotated[int, Bounds("blocks", minimum=1, maximum=1000)]

__all__ = ["rectangle"]


@template
def rectangle(
    *,
    width: Length = 1.0,
    height: Length = 1.0,
    corner: Point = (0.0, 0.0),
    blocks_x: Blocks = 1,
    blocks_y: Blocks = 1,
    elements_x: Count = 4,
    elements_y: Count = 4,
    stretch_x: Stretch = 0.0,
    stretch_y: Stretch = 0.0,
) -> BlockStructure:
    """Rectangle of nx by ny blocks, graded over its whole sides.

    Vertices ``p0_0`` to ``pI_J``, column first; blocks ``domain``; edges ``left``, ``right``, ``bottom``, ``top``.

    Parameters
    ----------
    width, height : float
        Lengths of the sides.
    corner : (float, float)
        The lower left corner.
    blocks_x, blocks_y : int
        Blocks along each side.
    elements_x, elements_y : int
        Elements across each block.
    stretch_x, stretch_y : float
        Exponential grading over the whole side, dense at the left or bottom for positive values, at the
        other end for negative ones; the elements do not depend on how many blocks share them.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range.
    """
    x = graded_lines(corner[0], corner[0] + width, blocks_x, stretch_x)
    y = graded_lines(corner[1], corner[1] + height, blocks_y, stretch_y)
    draft = Draft()
    draft.grid("domain", x, y)
    columns, rows = range(blocks_x + 1), range(blocks_y + 1)
    across = [[grid_name(i, j) for i in columns] for j in rows]
    upwards = [[grid_name(i, j) for j in rows] for i in columns]
    for name, path in zip(
        ("left", "right", "bottom", "top"), (upwards[0], upwards[-1], across[0], across[-1]), strict=True
    ):
        draft.call(name, *path)
    draft.count(elements_x, *across[0])
    draft.count(elements_y, *upwards[0])
    for paths, grading in ((across, Exponential(stretch_x / blocks_x)), (upwards, Exponential(stretch_y / blocks_y))):
        for path in paths:
            draft.grade(grading, *pairwise(path))
    return draft.structure()
