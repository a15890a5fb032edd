"""A domain in the shape of an L."""

from __future__ import annotations

from hoblock.blocks import BlockStructure
from hoblock.errors import TemplateError
from hoblock.grading import Exponential
from hoblock.templates.draft import Draft
from hoblock.templates.parameters import Count, Length, Stretch
from hoblock.templates.template import template

__all__ = ["l_shape"]


@template
def l_shape(
    *,
    width: Length = 2.0,
    height: Length = 2.0,
    notch_width: Length = 1.0,
    notch_height: Length = 1.0,
    elements_left: Count = 4,
    elements_right: Count = 4,
    elements_bottom: Count = 4,
    elements_top: Count = 4,
    stretch: Stretch = 1.0,
) -> BlockStructure:
    """Rectangle without its lower right corner, graded towards the re-entrant corner at (0, 0).

    Vertices ``p0_0`` to ``p2_2`` of a 3 by 3 grid without ``p2_0``; blocks ``domain``; edges ``left``, ``right``,
    ``bottom``, ``top`` and ``notch``: the two that meet in the re-entrant corner.

    Parameters
    ----------
    width : float
        Of the whole rectangle, from left to right.
    height : float
        Of the whole rectangle, from bottom to top.
    notch_width : float
        Of the part that is missing, from left to right.
    notch_height : float
        Of the part that is missing, from bottom to top.
    elements_left : int
        Elements to the left of the line x = 0.
    elements_right : int
        Elements to the right of the line x = 0.
    elements_bottom : int
        Elements below the line y = 0.
    elements_top : int
        Elements above the line y = 0.
    stretch : float
        Exponential grading away from the re-entrant corner, dense there for positive values.

    Raises
    ------
    TemplateError
        If a parameter has the wrong type or is out of range, or the notch is as large as the rectangle.
    """
    for name, notch, side in (("notch_width", notch_width, width), ("notch_height", notch_height, height)):
        if notch >= side:
            raise TemplateError(f"got {notch:g}; expected less than {name.removeprefix('notch_')} = {side:g}.", name)
    draft = Draft()
    x = (notch_width - width, 0.0, notch_width)
    y = (-notch_height, 0.0, height - notch_height)
    draft.grid("domain", x, y, keep=lambda i, j: (i, j) != (1, 0))
    draft.call("left", "p0_0", "p0_1", "p0_2")
    draft.call("right", "p2_1", "p2_2")
    draft.call("bottom", "p0_0", "p1_0")
    draft.call("top", "p0_2", "p1_2", "p2_2")
    draft.call("notch", "p1_0", "p1_1", "p2_1")
    draft.count(elements_left, "p0_1", "p1_1")
    draft.count(elements_right, "p1_1", "p2_1")
    draft.count(elements_bottom, "p1_0", "p1_1")
    draft.count(elements_top, "p1_1", "p1_2")
    draft.grade(Exponential(stretch), *((f"p1_{j}", f"p0_{j}") for j in range(3)))
    draft.grade(Exponential(stretch), ("p1_1", "p2_1"), ("p1_2", "p2_2"))
    draft.grade(Exponential(stretch), ("p0_1", "p0_0"), ("p1_1", "p1_0"))
    draft.grade(Exponential(stretch), *((f"p{i}_1", f"p{i}_2") for i in range(3)))
    return draft.structure()
