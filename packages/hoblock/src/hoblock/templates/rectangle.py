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
    width : float
        Length of the lower and the upper side.
    height : float
        Length of the left and the right side.
    corner : (float, float)
        The lower left corner.
    blocks_x : int
        Blocks from left to right.
    blocks_y : int
        Blocks from bottom to top.
    elements_x : int
        Elements across each block from left to right.
    elements_y : int
        Elements across each block from bottom to top.
    stretch_x : float
        Exponential grading over the whole width, dense at the left for positive values, at the right for
        negative ones; the elements do not depend on how many blocks share them.
    stretch_y : float
        Exponential grading over the whole height, dense at the bottom for positive values, at the top for
        negative ones; the elements do not depend on how many blocks share them.

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
